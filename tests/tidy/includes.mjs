// Includes and calls of GL, judged by the table of layers.
import { tokensOf } from './c_tokens.mjs';

/** @typedef {import('./files.mjs').SourceFile} SourceFile */
/** @typedef {import('./layers.mjs').Layer} Layer */
/** @typedef {import('./layers.mjs').Arrow} Arrow */
/**
 * @typedef {{ path: string, line: number, header: string }} Include `header` as a path from the
 *   root
 */

const GPU_FOLDER = 'renderer/gpu/';

/**
 * Every #include "...". Shaders are included from shaders/, by C as well.
 * @param {SourceFile[]} files
 * @returns {Include[]}
 */
export function findIncludes(files) {
  const paths = new Set(files.map(({ path }) => path));
  return files.flatMap((file) =>
    tokensOf(file)
      .filter((token) => token.text === 'include' && token.inner?.[0]?.kind === 'string')
      .map(({ line, inner }) => {
        const name = inner[0].text.slice(1, -1);
        return {
          path: file.path,
          line,
          header: paths.has(`shaders/${name}`) ? `shaders/${name}` : name,
        };
      }),
  );
}

/** The row of the innermost folder that holds a file. */
function layerOf(path, layers) {
  return layers
    .filter(({ folder }) => path.startsWith(`${folder}/`))
    .sort((a, b) => b.folder.length - a.folder.length)[0];
}

/**
 * @param {Include[]} includes
 * @param {Layer[]} layers
 * @param {Arrow[]} upward  allowed against the table
 * @returns {string[]} what is wrong
 */
export function judgeIncludes(includes, layers, upward) {
  const against = includes.filter(({ path, header }) => {
    const layer = layerOf(path, layers);
    const target = layerOf(header, layers);
    return (
      !layer ||
      !(layer === target || layer.may.includes(target?.folder) || layer.may.includes(header))
    );
  });
  const isArrow = ({ path, header }, { from, to }) => path === from && header === to;
  const wrong = against
    .filter((include) => !upward.some((arrow) => isArrow(include, arrow)))
    .map(({ path, line, header }) => `${path}:${line}: ${refusal(layerOf(path, layers), header)}`);
  const needless = upward
    .filter((arrow) => !against.some((include) => isArrow(include, arrow)))
    .map(({ from, to }) => `layers.mjs: ${from} no longer includes ${to}: take it off the list`);
  return [...wrong, ...needless];
}

function refusal(layer, header) {
  if (!layer) return 'the table of layers.mjs has no row for this folder';
  const may = layer.may.length > 0 ? layer.may.join(', ') : 'nothing else';
  return `includes ${header}, but ${layer.folder} (${layer.why}) may include itself and ${may}`;
}

/**
 * Folders of the table that include each other, if only by way of others; single headers do not
 * count.
 * @param {Layer[]} layers
 * @returns {string[]} what is wrong
 */
export function judgeLayers(layers) {
  const below = (folder, seen = new Set()) => {
    for (const next of layers.find((layer) => layer.folder === folder)?.may ?? [])
      if (!seen.has(next)) below(next, seen.add(next));
    return seen;
  };
  return layers
    .filter(({ folder }) => below(folder).has(folder))
    .map(({ folder }) => `layers.mjs: ${folder} stands below itself`);
}

/**
 * Calls of GL and EGL outside of the one folder that may.
 * @param {SourceFile[]} files  of the product
 * @returns {string[]} what is wrong
 */
export function findForeignGlCalls(files) {
  return files
    .filter(({ path, language }) => language !== 'GLSL' && !path.startsWith(GPU_FOLDER))
    .flatMap((file) => {
      const tokens = tokensOf(file);
      const calls = tokens.filter(
        (token, index) =>
          /^(gl|egl)[A-Z][A-Za-z0-9]+$/.test(token.text) && tokens[index + 1]?.text === '(',
      );
      return calls.map(
        ({ line, text: name }) =>
          `${file.path}:${line}: calls ${name}, which ${GPU_FOLDER} alone may`,
      );
    });
}
