// C, C++ and GLSL as tokens. Comments are dropped, a string is one token, and a preprocessor line
// is one token with inner tokens.

/**
 * @typedef {object} Token
 * @property {'word' | 'number' | 'string' | 'mark' | 'directive'} kind
 * @property {string} text
 * @property {number} line  from 1
 * @property {Token[]} [inner]  of a directive: what follows its name
 */

// Raw strings come before words, as their prefix is a word; numbers may hold C++'s digit
// separators.
const TOKEN = new RegExp(
  [
    String.raw`(?<space>[ \t\r\f]+|\\\r?\n)`,
    String.raw`(?<newline>\n)`,
    String.raw`(?<comment>\/\/(?:\\\r?\n|[^\n])*|\/\*[\s\S]*?(?:\*\/|$))`,
    String.raw`(?<raw>R"(?<delimiter>[^(\s]*)\([\s\S]*?\)\k<delimiter>")`,
    String.raw`(?<word>[A-Za-z_]\w*)`,
    String.raw`(?<number>\.?\d(?:'?[\w.])*)`,
    String.raw`(?<string>"(?:\\[\s\S]|[^"\\\n])*"|'(?:\\[\s\S]|[^'\\\n])*')`,
    String.raw`(?<mark>[\s\S])`,
  ].join('|'),
  'y',
);

const countNewlines = (text) => text.split('\n').length - 1;

/**
 * The end of the preprocessor line that begins at `start`: its newline, unless continued or in a
 * comment.
 */
function directiveEnd(text, start) {
  const part =
    /\\\r?\n|\/\*[\s\S]*?(?:\*\/|$)|\/\/(?:\\\r?\n|[^\n])*|"(?:\\[\s\S]|[^"\\\n])*"|[^\n]/y;
  part.lastIndex = start;
  let end = start;
  while (part.test(text)) end = part.lastIndex;
  return end;
}

/**
 * @param {string} text
 * @param {number} [firstLine]
 * @returns {Token[]}
 */
export function tokenize(text, firstLine = 1) {
  const tokens = [];
  let line = firstLine;
  let lineIsEmpty = true;
  let end;
  for (let at = 0; at < text.length; at = end) {
    TOKEN.lastIndex = at;
    const { groups } = TOKEN.exec(text);
    end = TOKEN.lastIndex;
    if (groups.newline) {
      lineIsEmpty = true;
    } else if (groups.mark === '#' && lineIsEmpty) {
      end = directiveEnd(text, at);
      tokens.push(directive(text.slice(at + 1, end), line));
    } else if (!groups.space && !groups.comment) {
      const kind = groups.raw
        ? 'string'
        : ['word', 'number', 'string', 'mark'].find((name) => groups[name]);
      tokens.push({ kind, text: text.slice(at, end), line });
      lineIsEmpty = false;
    }
    line += countNewlines(text.slice(at, end));
  }
  return tokens;
}

function directive(text, line) {
  const [name, ...inner] = tokenize(text, line);
  return { kind: 'directive', text: name?.text ?? '', line, inner };
}

const known = new WeakMap();

/**
 * The tokens of a file, which several rules ask for.
 * @param {import('./files.mjs').SourceFile} file
 * @returns {Token[]}
 */
export function tokensOf(file) {
  if (!known.has(file)) known.set(file, tokenize(file.text));
  return known.get(file);
}
