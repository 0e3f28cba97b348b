// llvmpipe runs a loop that tests at its start once more than needed: leaving takes lanes out of
// the mask, and the rest of the body follows for no lane. A loop over one light thus costs two. So
// loops of shaders test at their end, but for those of constant length, which compilers unroll, and
// those listed here.

/** @typedef {import('./files.mjs').SourceFile} SourceFile */

/**
 * How many loops of a file test at their start, and why they may.
 * @type {Record<string, { loops: number, reason: string }>}
 */
export const LOOPS_TESTED_FIRST = {
  'shaders/debug/debug_view.comp': { loops: 1, reason: 'debug views need not be fast' },
  'shaders/debug/finite_check.comp': { loops: 1, reason: 'runs when somebody asks for the check' },
  'shaders/debug/voxel_view.comp': { loops: 2, reason: 'debug views need not be fast' },
  'shaders/gi/cache_select.comp': { loops: 1, reason: 'a single invocation, a few additions' },
  'shaders/gi/ray_shadows.comp': { loops: 1, reason: 'three steps at most, an addition each' },
  'shaders/light/light_tiles.comp': { loops: 1, reason: 'mostly one step for each of many lanes' },
  'shaders/voxel/voxel_lists.comp': { loops: 1, reason: 'a single invocation' },
  'shaders/voxel/voxelize.comp': { loops: 1, reason: 'where there is no room for tiles' },
};

const LOOP = /(\} )?\b(for|while)\s*\(/g;
const CONSTANT = /^\s*\w+\s*<=?\s*[A-Z0-9_*u\s]+$/;

/**
 * The text in the parentheses that open before `from`. @param {string} text @param {number} from
 */
function insideParentheses(text, from) {
  let depth = 1;
  let at = from;
  for (; depth > 0 && at < text.length; at++)
    depth += text[at] === '(' ? 1 : text[at] === ')' ? -1 : 0;
  return text.slice(from, at - 1);
}

/** @param {string} header  of a for loop */
function testsFirst(header) {
  const condition = header.split(';')[1].replace(/\bu?int\(([^()]*)\)/g, '$1');
  return condition.trim() !== '' && !CONSTANT.test(condition);
}

/**
 * @param {SourceFile[]} shaders
 * @returns {Map<string, number>} loops of each file that test at their start
 */
export function findLoopsTestedFirst(shaders) {
  const found = new Map();
  for (const { path, text } of shaders) {
    const code = text.replace(/\/\/.*/g, '');
    const loops = [...code.matchAll(LOOP)].filter(({ 0: all, 1: closed, 2: kind, index }) =>
      kind === 'for' ? testsFirst(insideParentheses(code, index + all.length)) : !closed,
    );
    if (loops.length > 0) found.set(path, loops.length);
  }
  return found;
}

/**
 * @param {Map<string, number>} found
 * @param {Record<string, { loops: number, reason: string }>} listed
 * @returns {string[]} what is wrong
 */
export function judgeLoops(found, listed) {
  const more = [...found]
    .filter(([path, loops]) => loops > (listed[path]?.loops ?? 0))
    .map(([path, loops]) => `${path}: ${loops} loops test at their start: use do ... while`);
  const stale = Object.entries(listed)
    .filter(([path, { loops }]) => (found.get(path) ?? 0) < loops)
    .map(([path]) => `${path}: fewer loops test at their start: correct the list`);
  return [...more, ...stale];
}
