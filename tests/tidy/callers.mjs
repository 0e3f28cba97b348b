// Functions and macros of the product that nothing in the product names: code without a caller is
// deleted.
import { readStructure } from './c_structure.mjs';
import { tokensOf } from './c_tokens.mjs';

/** @typedef {import('./files.mjs').SourceFile} SourceFile */
/** @typedef {{ path: string, line: number, name: string, what: 'function' | 'macro' }} Unused */

/** Macros that libraries read, whose headers we include: prefixes of their names. */
const FOR_LIBRARIES = [
  'STB_',
  'STBI_',
  'STBIR_',
  'TINYGLTF_',
  'TINYOBJLOADER_',
  'CGLM_',
  '_GNU_SOURCE',
];

const HEADER_GUARD = /_(H|HPP)$/;

/**
 * GLSL and C are told apart, as neither calls the other's functions.
 * @param {SourceFile[]} files  of the product, in C, C++ or GLSL
 * @returns {Unused[]}
 */
export function findUnused(files) {
  const shaders = files.filter(({ language }) => language === 'GLSL');
  const host = files.filter(({ language }) => language !== 'GLSL');
  return [...unusedFunctions(host), ...unusedFunctions(shaders), ...unusedMacros(files)];
}

function unusedFunctions(files) {
  const defined = [];
  const used = new Set(['main']);
  for (const file of files) {
    if (file.path.endsWith('.def')) {
      // Rows of a table: macros make functions of them.
      tokensOf(file).forEach((token) => token.kind === 'word' && used.add(token.text));
      continue;
    }
    const { functions, uses } = readStructure(tokensOf(file), file.language);
    uses.forEach((word) => used.add(word));
    for (const { name, special, line, uses: inBody } of functions) {
      if (!special) defined.push({ path: file.path, line, name, what: 'function' });
      inBody.forEach((word) => word !== name && used.add(word));
    }
  }
  return defined.filter(({ name }) => !used.has(name));
}

function unusedMacros(files) {
  const defined = [];
  const used = new Set();
  for (const file of files) {
    const tokens = tokensOf(file);
    tokens.forEach((token, index) => {
      if (token.kind === 'word') used.add(token.text);
      if (token.kind === 'string') definesIn(token.text).forEach((name) => used.add(name));
      if (token.kind !== 'directive' || token.inner.length === 0) return;
      const [first, ...others] = token.inner;
      others.forEach(({ text }) => used.add(text));
      if (token.text === 'define')
        defined.push({ path: file.path, line: token.line, name: first.text, what: 'macro' });
      else if (token.text !== 'undef' && !isDefault(token, tokens[index + 1])) used.add(first.text);
    });
  }
  const pasted = pastedParts(files);
  const isOurs = ({ name }) =>
    !HEADER_GUARD.test(name) && !FOR_LIBRARIES.some((prefix) => name.startsWith(prefix));
  return defined.filter(
    (macro) => isOurs(macro) && !used.has(macro.name) && !pasted.some((part) => part(macro.name)),
  );
}

/** Defines for shaders stand in strings: "STAGE LISTS_RESET\\n". */
const definesIn = (string) => string.replaceAll('\\n', ' ').match(/\b[A-Z][A-Z0-9_]+\b/g) ?? [];

/**
 * Names that macros build: for PREFIX_##x all names with that prefix, for x##_SUFFIX all names with
 * that suffix.
 */
function pastedParts(files) {
  const parts = [];
  for (const file of files)
    for (const { kind, inner } of tokensOf(file)) {
      if (kind !== 'directive') continue;
      const texts = inner.map(({ text }) => text);
      texts.forEach((text, i) => {
        if (text !== '#' || texts[i + 1] !== '#') return;
        const [before, after] = [texts[i - 1], texts[i + 2]];
        if (/^[A-Z]\w*_$/.test(before)) parts.push((name) => name.startsWith(before));
        if (/^_[A-Z]\w*$/.test(after)) parts.push((name) => name.endsWith(after));
      });
    }
  return parts;
}

/** "#ifndef X" before "#define X" does not use X. */
const isDefault = (token, next) =>
  token.text === 'ifndef' && next?.text === 'define' && next.inner[0]?.text === token.inner[0].text;

/**
 * @param {SourceFile[]} files
 * @returns {Set<string>}  every word of theirs
 */
export function wordsOfAll(files) {
  const tokens = files.flatMap(tokensOf);
  return new Set(tokens.flatMap((token) => token.inner ?? token).map(({ text }) => text));
}

/**
 * @param {Unused[]} unused
 * @param {Record<string, string>} allowed  reasons by name of a function
 * @param {Set<string>} named  words of tests, which call what is allowed
 * @returns {string[]} what is wrong
 */
export function judgeUnused(unused, allowed, named) {
  const names = new Set(unused.map(({ name }) => name));
  const nobodys = unused
    .filter(({ name }) => !(name in allowed))
    .map(
      ({ path, line, name, what }) =>
        `${path}:${line}: the product never names the ${what} ${name}: delete it`,
    );
  const list = 'callers_allowed.mjs';
  const needless = Object.keys(allowed).flatMap((name) => {
    if (!names.has(name)) return [`${list}: ${name} is gone or has callers: take it off the list`];
    return named.has(name) ? [] : [`${list}: no test names ${name}: delete the function`];
  });
  return [...nobodys, ...needless];
}
