// The identifiers of a JS file: without comments, strings and regular expressions, but with the
// code inside `${}`.

/** @typedef {{ text: string, line: number }} Word */

const PART = new RegExp(
  [
    String.raw`(?<space>\s+)`,
    String.raw`(?<comment>\/\/[^\n]*|\/\*[\s\S]*?(?:\*\/|$)|^#![^\n]*)`,
    String.raw`(?<word>[A-Za-z_$][\w$]*)`,
    String.raw`(?<number>\.?\d[\w.]*)`,
    String.raw`(?<string>"(?:\\[\s\S]|[^"\\\n])*"|'(?:\\[\s\S]|[^'\\\n])*')`,
    String.raw`(?<mark>[\s\S])`,
  ].join('|'),
  'y',
);
const REGULAR_EXPRESSION = /\/(?:\\.|\[(?:\\.|[^\]\\\n])*\]|[^/\\\n[])+\/[a-z]*/y;
/** The text of a template up to its end or to the next `${`. */
const TEMPLATE = /(?:\\[\s\S]|\$(?!\{)|[^`\\$])*(?<end>`|\$\{|$)/y;

/** After these a slash begins a regular expression; after a value it divides. */
const KEYWORDS = 'await|case|delete|do|else|in|new|of|return|throw|typeof|void|yield';
const BEFORE_VALUES = new RegExp(String.raw`^(?:[(,=:[!&|?{};+\-*%<>~^]|${KEYWORDS})$`);

/**
 * @param {string} text
 * @returns {Word[]}
 */
export function readJsWords(text) {
  const words = [];
  const braces = []; // whether each open one belongs to a template
  let last = ';';
  let line = 1;
  let at = 0;
  const match = (pattern) => {
    pattern.lastIndex = at;
    return pattern.exec(text);
  };
  const advance = (matched) => {
    line += matched.split('\n').length - 1;
    at += matched.length;
  };
  const skipTemplate = () => {
    const { 0: matched, groups } = match(TEMPLATE);
    advance(matched);
    if (groups.end === '${') braces.push(true);
    last = groups.end === '${' ? '{' : '`';
  };
  while (at < text.length) {
    const { 0: matched, groups } = match(PART);
    const expression =
      matched === '/' && BEFORE_VALUES.test(last) ? match(REGULAR_EXPRESSION) : null;
    if (groups.word) words.push({ text: matched, line });
    advance(expression?.[0] ?? matched);
    if (groups.space || groups.comment) continue;
    last = expression ? '/x/' : matched;
    if (matched === '{') braces.push(false);
    if (matched === '`' || (matched === '}' && braces.pop())) skipTemplate();
  }
  return words;
}
