// Lengths of files, lines and functions. lengths_allowed.json lists what is too long today with its
// figure, which may only fall.
import { readStructure } from './c_structure.mjs';
import { tokensOf } from './c_tokens.mjs';
import { isCode } from './files.mjs';

/** @typedef {import('./files.mjs').SourceFile} SourceFile */

/**
 * What is too long: a file by its lines, a function by its lines, a file's lines by how many are
 * too long.
 * @typedef {object} Excess
 * @property {'files' | 'lines' | 'functions'} kind
 * @property {string} key  path, and of functions " name"
 * @property {number} figure
 * @property {string[]} messages
 */

export const MAX_FILE_LINES = 600;
export const MAX_FUNCTION_LINES = 70;
export const MAX_COLUMNS = 100;
const LANGUAGES_OF_COLUMNS = ['C', 'C++', 'GLSL', 'JS'];

/**
 * @param {SourceFile[]} files
 * @returns {Excess[]}
 */
export function findExcesses(files) {
  return files.flatMap((file) => [...longFile(file), ...longLines(file), ...longFunctions(file)]);
}

function longFile({ path, text }) {
  const figure = text.split('\n').length - 1;
  if (figure <= MAX_FILE_LINES) return [];
  return [
    {
      kind: 'files',
      key: path,
      figure,
      messages: [`${path}:1: ${figure} lines; ${MAX_FILE_LINES} at most`],
    },
  ];
}

function longLines({ path, text, language }) {
  if (!LANGUAGES_OF_COLUMNS.includes(language)) return [];
  const messages = text.split('\n').flatMap((line, index) => {
    const columns = [...line].length;
    return columns > MAX_COLUMNS
      ? [`${path}:${index + 1}: ${columns} columns; ${MAX_COLUMNS} at most in ${language}`]
      : [];
  });
  return messages.length > 0
    ? [{ kind: 'lines', key: path, figure: messages.length, messages }]
    : [];
}

function longFunctions(file) {
  if (!isCode(file)) return [];
  const { functions } = readStructure(tokensOf(file), file.language);
  return functions.flatMap(({ name, line, lastLine }) => {
    const figure = lastLine - line + 1;
    if (figure <= MAX_FUNCTION_LINES) return [];
    const where = `${file.path}:${line}: function ${name}`;
    const message = `${where} has ${figure} lines; ${MAX_FUNCTION_LINES} at most`;
    return [{ kind: 'functions', key: `${file.path} ${name}`, figure, messages: [message] }];
  });
}

/**
 * @param {Excess[]} excesses
 * @param {Record<string, Record<string, number>>} allowed  figures by kind and key
 * @returns {string[]} what is wrong
 */
export function judgeExcesses(excesses, allowed) {
  const longer = excesses.flatMap(({ kind, key, figure, messages }) => {
    const kept = allowed[kind]?.[key] ?? 0;
    return figure > kept
      ? messages.map((message) => (kept ? `${message} (${kept} allowed until now)` : message))
      : [];
  });
  const shorter = Object.entries(allowed).flatMap(([kind, figures]) =>
    Object.entries(figures).flatMap(([key, kept]) => {
      const figure =
        excesses.find((excess) => excess.kind === kind && excess.key === key)?.figure ?? 0;
      const what = figure ? `lower its figure to ${figure}` : 'take it off the list';
      return figure < kept
        ? [`lengths_allowed.json: ${kind}: ${key} is down from ${kept}: ${what}`]
        : [];
    }),
  );
  return [...longer, ...shorter];
}
