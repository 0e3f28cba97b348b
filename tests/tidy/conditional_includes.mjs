// Shaders include each file once, wherever that is. So what a file under a condition includes must
// be included before, or it is missing where the condition does not hold.
import { findIncludes } from './includes.mjs';
import { tokensOf } from './c_tokens.mjs';

/** @typedef {import('./files.mjs').SourceFile} SourceFile */

/** Lines of a file at which a preprocessor condition begins or ends. */
function conditionalLines(file) {
  const lines = new Set();
  let depth = 0;
  let from = 0;
  for (const { kind, text, line } of tokensOf(file)) {
    if (kind !== 'directive') continue;
    if (/^if/.test(text) && depth++ === 0) from = line;
    if (text === 'endif' && --depth === 0) for (let at = from; at < line; at++) lines.add(at);
  }
  return lines;
}

/**
 * @param {SourceFile[]} shaders
 * @returns {string[]} what is wrong
 */
export function judgeConditionalIncludes(shaders) {
  const conditional = new Map(shaders.map((file) => [file.path, conditionalLines(file)]));
  // Header guards do not count as conditions.
  const includes = findIncludes(shaders).map((include) => ({
    ...include,
    conditional: !include.path.endsWith('.h') && conditional.get(include.path).has(include.line),
  }));
  const of = (path) => includes.filter((include) => include.path === path);
  const closure = (path, seen = new Set()) => {
    for (const { header } of of(path)) if (!seen.has(header)) closure(header, seen.add(header));
    return seen;
  };
  return includes
    .filter((include) => include.conditional)
    .flatMap(({ path, line, header }) => {
      const before = of(path).filter((other) => other.line < line && !other.conditional);
      const there = new Set(before.flatMap((other) => [other.header, ...closure(other.header)]));
      return [...closure(header)]
        .filter((needed) => !there.has(needed))
        .map(
          (needed) =>
            `${path}:${line}: includes ${header} under a condition: include ${needed} before`,
        );
    });
}
