// Options of ./dev bench --against, and the scenes that it measures without any.
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { CLOCKS, CPUS } from './programs.mjs';

/**
 * @typedef {{ help: boolean, against: string, allowDifferences: boolean, clocks: string[], cpu:
 *    string, json: boolean, runs: number, scenes: { name: string, job: import('./programs.mjs').Job
 *    }[] }} Options */

const SCENES =
  process.env.VOXCAST_SCENES || fileURLToPath(new URL('../../../shared/scenes', import.meta.url));
const SPONZA = join(SCENES, 'sponza/sponza.glb');

/**
 * Small steps: the published box is half a metre wide, and where a clip level moves, the temporal
 * budget decides what frames do until its light has converged again.
 */
const MOVE = '0.005,0,0';
const MAX_RUNS = 1000;

const DEFAULT_SCENES = [
  { name: 'cornell', source: 'builtin:cornell', gi: 'none' },
  { name: 'cornell-objects', source: 'builtin:cornell-objects' },
  { name: 'atrium', source: 'builtin:atrium', move: '0.002,0,0' },
  { name: 'sponza', source: SPONZA, move: '0.002,0,0' },
];

export const USAGE = `usage: ./dev bench --against REVISION [SCENE|builtin:NAME]... [OPTIONS]

Builds REVISION in a tree of its own, runs both programs by turns (this, that, that, this) and
prints for each scene the median of the ratios of neighbouring runs, for the frame and each pass, by
wall time and by CPU time of all threads, with quartiles. Times are medians over frames, times the
part of the frames in which a pass ran. Light converges before a moving camera is measured. A scene
whose images differ is not measured; exit status 1.

SCENE: default cornell with direct light alone, cornell-objects, atrium, and Sponza if
VOXCAST_SCENES has it.

  --runs N             pairs of runs for each clock, 1 to ${MAX_RUNS} (default 4)
  --frames N           frames of a moving camera in each run (default 20)
  --size WxH           default 640x360
  --gi METHOD          none, clipmap or grid (default clipmap)
  --quality NAME       draft, interactive, high or final (default interactive)
  --moving             a camera that moves (default)
  --at-rest            a camera at rest: times are sums until the image has converged
  --move-eye X,Y,Z     metres a frame (default ${MOVE}; 0.002,0,0 in atrium and Sponza)
  --clock wall|cpu     by this clock alone, in half the runs; on a busy machine cpu is worth more
                       (default both)
  --cpu native|avx2    avx2: the driver generates no AVX-512, as where there is none (default
                       native)
  --gpu WHICH          auto, software or a device index (default auto)
  --allow-differences  measures in spite of images that differ
  --json               JSON on stdout; tables go to stderr
`;

const TEXT = /** @type {const} */ ({ type: 'string' });
const FLAG = /** @type {const} */ ({ type: 'boolean', default: false });
const DECLARED = {
  against: TEXT,
  runs: { ...TEXT, default: '4' },
  frames: { ...TEXT, default: '20' },
  size: { ...TEXT, default: '640x360' },
  gi: TEXT,
  quality: { ...TEXT, default: 'interactive' },
  moving: FLAG,
  'at-rest': FLAG,
  'move-eye': TEXT,
  clock: TEXT,
  cpu: { ...TEXT, default: 'native' },
  gpu: { ...TEXT, default: 'auto' },
  'allow-differences': FLAG,
  json: FLAG,
  help: FLAG,
};

/** Ends the tool with status 2. @param {string} message @returns {never} */
function refuse(message) {
  throw Object.assign(new Error(`${message}; see ./dev bench --against REVISION --help`), {
    usage: true,
  });
}

function parse(/** @type {string[]} */ args) {
  try {
    return parseArgs({ args, options: DECLARED, allowPositionals: true });
  } catch (error) {
    return refuse(/** @type {Error} */ (error).message);
  }
}

/** @param {Record<string, any>} values @param {string} name @param {number} maximum */
function countOf(values, name, maximum) {
  const value = Number(values[name]);
  if (!Number.isInteger(value) || value < 1 || value > maximum)
    refuse(`--${name} is "${values[name]}"; 1 to ${maximum}`);
  return value;
}

/** @param {string[]} args @returns {Options} */
export function readOptions(args) {
  const { values, positionals } = parse(args);
  if (!values.help && !values.against) refuse('--against needs a revision');
  if (!CPUS.includes(values.cpu)) refuse(`--cpu is "${values.cpu}"; one of ${CPUS.join(', ')}`);
  if (values.clock !== undefined && !CLOCKS.includes(values.clock))
    refuse(`--clock is "${values.clock}"; one of ${CLOCKS.join(', ')}`);
  if (!/^\d+x\d+$/.test(values.size)) refuse(`--size is "${values.size}"; want WxH`);
  if (values.moving && values['at-rest']) refuse('--moving and --at-rest exclude each other');
  const chosen = positionals.map((source) => ({ name: source, source }));
  const known = DEFAULT_SCENES.filter(
    ({ source }) => source.startsWith('builtin:') || existsSync(source),
  );
  const frames = countOf(values, 'frames', 10000);
  const scenes = (chosen.length > 0 ? chosen : known).map(({ name, source, gi, move }) => ({
    name,
    job: {
      source,
      gi: values.gi ?? gi ?? 'clipmap',
      quality: values.quality,
      size: values.size,
      move: values['at-rest'] ? null : (values['move-eye'] ?? move ?? MOVE),
      frames,
      gpu: values.gpu,
    },
  }));
  return {
    help: values.help,
    against: values.against ?? '',
    allowDifferences: values['allow-differences'],
    clocks: values.clock ? [values.clock] : CLOCKS,
    cpu: values.cpu,
    json: values.json,
    runs: countOf(values, 'runs', MAX_RUNS),
    scenes,
  };
}
