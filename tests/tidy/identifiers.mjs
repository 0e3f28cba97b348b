// Identifiers of C, C++, GLSL and JS that use a banned word.
import { tokensOf } from './c_tokens.mjs';
import { isCode } from './files.mjs';
import { readJsWords } from './js_words.mjs';

/** @typedef {import('./files.mjs').SourceFile} SourceFile */
/** @typedef {import('./words.mjs').BannedWord} BannedWord */
/** @typedef {{ path: string, line: number, name: string }} Identifier  where it stands first */

/**
 * @param {string} name  in snake_case, camelCase or a mixture
 * @returns {string[]}  in lower case
 */
export function wordsOf(name) {
  const words = name.match(/[A-Z]+(?![a-z])|[A-Z]?[a-z]+/g) ?? [];
  return words.map((word) => word.toLowerCase());
}

function wordsIn(file) {
  if (!isCode(file)) return readJsWords(file.text);
  const flat = tokensOf(file).flatMap((token) => token.inner ?? token);
  return flat.filter(({ kind }) => kind === 'word');
}

/**
 * @param {SourceFile[]} files
 * @param {BannedWord[]} banned
 * @returns {Map<string, Identifier[]>}  distinct identifiers by banned word
 */
export function findBanned(files, banned) {
  const found = new Map(banned.map(({ word }) => [word, []]));
  const ruleOf = new Map(
    banned.flatMap((rule) => [rule.word, `${rule.word}s`].map((form) => [form, rule])),
  );
  const seen = new Set();
  for (const file of files)
    for (const { text: name, line } of wordsIn(file)) {
      if (seen.has(name)) continue;
      seen.add(name);
      for (const rule of new Set(wordsOf(name).map((word) => ruleOf.get(word))))
        if (rule && !rule.except?.test(name))
          found.get(rule.word).push({ path: file.path, line, name });
    }
  return found;
}

/**
 * @param {Map<string, Identifier[]>} found
 * @param {BannedWord[]} banned
 * @param {Record<string, number>} allowed  how many identifiers may still use a word
 * @returns {string[]} what is wrong
 */
export function judgeBanned(found, banned, allowed) {
  const unknown = Object.keys(allowed).filter((word) => !found.has(word));
  return [
    ...unknown.map((word) => `words_allowed.json: ${word} is no banned word: take it off the list`),
    ...banned.flatMap(({ word, instead }) => {
      const identifiers = found.get(word);
      const kept = allowed[word] ?? 0;
      const figures = `${identifiers.length} identifiers say "${word}"; ${kept} at most`;
      if (identifiers.length > kept)
        return identifiers.map(
          ({ path, line, name }) => `${path}:${line}: ${name}: say ${instead} (${figures})`,
        );
      return identifiers.length < kept ? [`words_allowed.json: lower the figure: ${figures}`] : [];
    }),
  ];
}
