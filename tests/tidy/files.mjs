// Our source files: what git tracks or would add, so neither packages nor build outputs.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

/** @typedef {{ path: string, language: string, text: string }} SourceFile  `path` from the root */

export const ROOT = fileURLToPath(new URL('../..', import.meta.url));

const LANGUAGES = [
  ['C', /\.c$/],
  ['C++', /\.(cpp|hpp)$/],
  ['GLSL', /\.(vert|frag|comp|glsl)$|^shaders\/shared\/.*\.h$/],
  ['C', /\.(h|def)$/],
  ['JS', /\.m?js$/],
  ['CSS', /\.css$/],
  ['shell', /\.sh$|^dev$|^\.ci\/run$/],
];

/**
 * @param {string} path from the root
 * @returns {string | undefined}  undefined: no language that these tests know
 */
export function languageOf(path) {
  return LANGUAGES.find(([, pattern]) => pattern.test(path))?.[0];
}

/** @returns {SourceFile[]}  every source file of ours, in order of paths */
export function readSources() {
  const listed = execFileSync('git', ['-C', ROOT, 'ls-files', '-z', '-co', '--exclude-standard'], {
    encoding: 'utf8',
  });
  return listed
    .split('\0')
    .filter((path) => languageOf(path) && existsSync(join(ROOT, path)))
    .sort()
    .map((path) => ({
      path,
      language: languageOf(path),
      text: readFileSync(join(ROOT, path), 'utf8'),
    }));
}

/** @param {SourceFile} file */
export const isProduct = ({ path }) => /^(server|renderer|protocol|shaders)\//.test(path);

/** @param {SourceFile} file */
export const isCode = ({ language }) => ['C', 'C++', 'GLSL'].includes(language);
