// The structure of a C, C++ or GLSL file, as far as these tests need it: its functions with the
// words that their bodies use, and the words of initializers and macros.

/** @typedef {import('./c_tokens.mjs').Token} Token */

/**
 * @typedef {object} FunctionBody
 * @property {string} name
 * @property {boolean} special a constructor, destructor or operator, which is called by other names
 * @property {number} line  where its signature begins
 * @property {number} lastLine
 * @property {Set<string>} uses  words of its body
 */

/**
 * @typedef {{ functions: FunctionBody[], uses: Set<string> }} Structure uses: words outside of
 *   functions
 */

/** What a brace opens: `values` are initialisers, or members of a GLSL block. */
/** @typedef {{ kind: 'scope' | 'class' | 'type' | 'values' | 'function' | 'inner', name?: string,
 *              function?: FunctionBody, tokens?: Token[] }} Brace */

const TYPES = ['struct', 'class', 'union', 'enum'];
const NOT_NAMES = ['__attribute__', 'layout', 'alignas', 'decltype', 'noexcept'];
const AFTER_PARAMETERS = ['const', 'noexcept', 'override', 'final'];

const isMark = (token, text) => token?.kind === 'mark' && token.text === text;
const isWord = (token, words) => token?.kind === 'word' && words.includes(token.text);

/** The indices of tokens that are in no parentheses; of parentheses, only the opening one. */
function outerIndices(head) {
  let depth = 0;
  const outer = [];
  head.forEach((token, index) => {
    if (isMark(token, ')')) depth--;
    else if (depth === 0) outer.push(index);
    if (isMark(token, '(')) depth++;
  });
  return outer;
}

/** The index of the colon at which a constructor's initializers begin; -1 if there are none. */
const initializerIndex = (head, outer) =>
  outer.find((index) => isMark(head[index], ':') && isMark(head[index - 1], ')')) ?? -1;

/**
 * The index of a function's name in the tokens before its body; -1 if they do not begin a function.
 */
function nameIndex(head) {
  const outer = outerIndices(head);
  const operator = head.findIndex((token) => isWord(token, ['operator']));
  const colon = initializerIndex(head, outer);
  if (colon < 0 && !isMark(head.at(-1), ')') && !isWord(head.at(-1), AFTER_PARAMETERS)) return -1;
  if (operator >= 0) return operator;
  if (outer.some((index) => isMark(head[index], '='))) return -1;
  const names = outer
    .filter((index) => isMark(head[index], '(') && (colon < 0 || index < colon))
    .map((index) => index - 1)
    .filter((index) => head[index]?.kind === 'word' && !NOT_NAMES.includes(head[index].text));
  return names.at(-1) ?? -1;
}

/**
 * @param {Token[]} head  the tokens before a brace that stands in no function
 * @param {string} language
 * @returns {Brace}
 */
function braceAfter(head, language) {
  const linkage = head.length === 2 && isWord(head[0], ['extern']) && head[1].kind === 'string';
  if (linkage || head.some((token) => isWord(token, ['namespace']))) return { kind: 'scope' };
  const at = nameIndex(head);
  if (at >= 0) {
    const { text: name } = head[at];
    const special = name === 'operator' || isMark(head[at - 1], '~') || isOwner(head, at, name);
    const colon = initializerIndex(head, outerIndices(head));
    const tokens = colon < 0 ? [] : head.slice(colon + 1);
    return {
      kind: 'function',
      name,
      tokens,
      function: { name, special, line: head[0].line, uses: new Set() },
    };
  }
  const type = outerIndices(head).findIndex((index) => isWord(head[index], TYPES));
  if (type < 0 || head.some((token) => isMark(token, '='))) return { kind: 'values' };
  if (language !== 'C++' || isWord(head[type], ['enum'])) return { kind: 'type' };
  return { kind: 'class', name: head[type + 1]?.text };
}

/** Whether `name` at `at` is qualified by itself, as constructors are. */
const isOwner = (head, at, name) => isMark(head[at - 1], ':') && isWord(head[at - 3], [name]);

/**
 * Words that may call or read. In C and GLSL a member does not count as a use of a function of its
 * name.
 */
function addUses(uses, tokens, language) {
  tokens.forEach((token, index) => {
    if (token.kind !== 'word') return;
    const arrow = isMark(tokens[index - 1], '>') && isMark(tokens[index - 2], '-');
    if (language === 'C++' || !(arrow || isMark(tokens[index - 1], '.'))) uses.add(token.text);
  });
}

class StructureReader {
  functions = [];
  uses = new Set();
  #language;
  /** @type {Brace[]} around the token */
  #open = [];
  /** @type {Token[]} since the last declaration ended */
  #head = [];
  #branches = [];

  constructor(language) {
    this.#language = language;
  }

  /** @param {Token} token */
  add(token) {
    if (token.kind === 'directive') return this.#addDirective(token);
    const body = this.#body();
    (body?.tokens ?? this.#head).push(token);
    if (isMark(token, '{')) this.#begin(body);
    else if (isMark(token, '}')) this.#end(token);
    else if (isMark(token, ';') && this.#isOutside()) this.#endDeclaration();
  }

  #body() {
    return this.#open.find(({ kind }) => kind === 'function');
  }

  #isOutside() {
    return this.#open.every(({ kind }) => kind === 'scope' || kind === 'class');
  }

  #begin(body) {
    if (body || !this.#isOutside()) {
      this.#open.push({ kind: 'inner' });
      return;
    }
    const brace = braceAfter(this.#head.slice(0, -1), this.#language);
    if (brace.kind === 'function') {
      brace.function.special ||= this.#open.at(-1)?.name === brace.name;
      this.functions.push(brace.function);
    }
    this.#open.push(brace);
    if (brace.kind !== 'values') this.#head = [];
  }

  #end(token) {
    const brace = this.#open.pop();
    if (brace?.kind === 'function') {
      brace.function.lastLine = token.line;
      addUses(brace.function.uses, brace.tokens, this.#language);
    }
    if (brace?.kind !== 'values' && brace?.kind !== 'inner') this.#head = [];
  }

  #endDeclaration() {
    const values = this.#head.some((token) => isMark(token, '=') || isMark(token, '{'));
    if (values) addUses(this.uses, this.#head, this.#language);
    this.#head = [];
  }

  /**
   * Every branch of an #if begins with the braces that were open before it, so that braces stay in
   * pairs.
   */
  #addDirective({ text, inner }) {
    if (text.startsWith('if'))
      this.#branches.push({ open: [...this.#open], head: [...this.#head] });
    else if (text === 'endif') this.#branches.pop();
    else if (text.startsWith('el') && this.#branches.length > 0) {
      this.#open = [...this.#branches.at(-1).open];
      this.#head = [...this.#branches.at(-1).head];
    }
    if (text !== 'include')
      addUses(this.uses, text === 'define' ? inner.slice(1) : inner, this.#language);
  }
}

/**
 * @param {Token[]} tokens
 * @param {string} language
 * @returns {Structure}
 */
export function readStructure(tokens, language) {
  const reader = new StructureReader(language);
  for (const token of tokens) reader.add(token);
  const functions = reader.functions.map((entry) => ({ lastLine: entry.line, ...entry }));
  return { functions, uses: reader.uses };
}
