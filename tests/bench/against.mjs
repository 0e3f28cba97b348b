// This tree's program and another revision's by turns, compared run by neighbouring run.
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { buildCommit, describeCheckout, resolveCommit } from './checkouts.mjs';
import { compareImages, describeDifference, readPfm } from './images.mjs';
import { USAGE, readOptions } from './options.mjs';
import { orderOfPairs, rowsOf, runOf, unequalWork } from './pairs.mjs';
import { RENAMED_PASSES, environmentsOf, runProgram } from './programs.mjs';
import { formatTable } from './table.mjs';

/** @typedef {import('./programs.mjs').Job} Job */
/** @typedef {{ this: string, that: string }} Programs */

const SIDES = /** @type {const} */ (['this', 'that']);

const tell = (/** @type {string} */ what) => process.stderr.write(`bench: ${what}\n`);

/** Set by the options and before the first scene. */
const bench = {
  programs: /** @type {Programs} */ ({ this: '', that: '' }),
  environment: /** @type {(clock: string) => NodeJS.ProcessEnv} */ (() => ({})),
  folder: '',
};

/**
 * Draws what both programs are about to be measured by, which compiles the shaders, too. @param
 * {Job} job
 */
async function compareOnce(job) {
  const images = [];
  let renderer = '';
  for (const side of SIDES) {
    const path = join(bench.folder, `${side}.pfm`);
    renderer = (await runProgram(bench.programs[side], job, path, bench.environment('wall')))
      .gl_renderer;
    images.push(readPfm(readFileSync(path)));
  }
  return { renderer, difference: compareImages(images[0], images[1]), image: images[0] };
}

/**
 * Whether this program draws the same again; if not, the difference says little. @param {Job} job
 */
async function repeatsItself(job, image) {
  const path = join(bench.folder, 'again.pfm');
  await runProgram(bench.programs.this, job, path, bench.environment('wall'));
  return compareImages(image, readPfm(readFileSync(path))).equal;
}

/**
 * @param {Job} job
 * @param {import('./options.mjs').Options} options
 * @param {boolean} software
 */
async function measure(job, { clocks, runs }, software) {
  const pairs = Object.fromEntries(clocks.map((clock) => [clock, []]));
  const path = join(bench.folder, 'measured.png');
  const order = orderOfPairs(clocks, runs);
  for (const [done, { clock, first }] of order.entries()) {
    tell(`${job.source}: pair ${done + 1} of ${order.length}, ${clock} time`);
    const pair = /** @type {Record<string, import('./pairs.mjs').Run>} */ ({});
    for (const side of first === 'this' ? SIDES : [...SIDES].reverse()) {
      const statistics = await runProgram(
        bench.programs[side],
        job,
        path,
        bench.environment(clock),
      );
      pair[side] = runOf(statistics, job.move !== null, RENAMED_PASSES);
    }
    pairs[clock].push(pair);
  }
  // A GPU's timers know nothing of CPU time.
  const rows = clocks.map((clock) => [
    clock,
    rowsOf(pairs[clock]).filter(({ name }) => clock === 'wall' || software || name === 'frame'),
  ]);
  return {
    clocks: Object.fromEntries(rows),
    unequal: unequalWork(clocks.flatMap((clock) => pairs[clock])),
  };
}

/** @param {{ name: string, job: Job }} scene @param {import('./options.mjs').Options} options */
async function benchScene({ name, job }, options) {
  const movement = job.move ? `moving ${job.move}` : 'at rest';
  const title = `${name}: gi ${job.gi}, ${job.quality}, ${movement}, ${job.size}`;
  tell(title);
  const { renderer, difference, image } = await compareOnce(job);
  const result = { name, ...job, gl_renderer: renderer, image: difference };
  const words = [describeDifference(difference)];
  if (!difference.equal && !(await repeatsItself(job, image)))
    words.push('this program does not repeat its own image');
  const head = `\n${title}\n${words.join('; ')}\n`;
  if (!difference.equal && !options.allowDifferences)
    return { result, text: `${head}not measured; see --allow-differences\n`, done: false };
  const { clocks, unequal } = await measure(job, options, /llvmpipe|softpipe/.test(renderer));
  const unit = job.move ? 'ms a frame' : 'ms in all';
  const notes = unequal.map(
    (pass) => `${pass.name} ran in ${pass.this} frames of this, ${pass.that} of that\n`,
  );
  return {
    result: { ...result, clocks, unequal },
    text: `${head}${formatTable(clocks, unit)}\n${notes.join('')}`,
    done: true,
  };
}

/**
 * Prints tables or JSON. The exit status will be 1 if a scene was not measured.
 * @param {string} root  of this tree
 * @param {string} program  its voxcast
 * @param {string[]} args
 */
export async function benchAgainst(root, program, args) {
  const options = readOptions(args);
  if (options.help) return void process.stdout.write(USAGE);
  for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, () => process.exit(130));
  const commit = resolveCommit(root, options.against);
  bench.programs = { this: program, that: buildCommit(root, commit, tell) };
  bench.environment = environmentsOf(options.cpu);
  bench.folder = mkdtempSync(join(tmpdir(), 'voxcast-bench-'));
  process.on('exit', () => rmSync(bench.folder, { recursive: true, force: true }));
  const about = {
    this: describeCheckout(root),
    that: commit.slice(0, 7),
    cpu: options.cpu,
    runs: options.runs,
  };
  const cpu = options.cpu === 'native' ? '' : `; code for ${options.cpu} alone`;
  const out = options.json ? process.stderr : process.stdout;
  out.write(
    `this ${about.this}, that ${about.that}; ` +
      `ratio: this / that, by ${about.runs} neighbouring runs${cpu}\n`,
  );
  const scenes = [];
  for (const scene of options.scenes) {
    const { result, text, done } = await benchScene(scene, options);
    scenes.push(result);
    out.write(text);
    if (!done) process.exitCode = 1;
  }
  if (options.json) process.stdout.write(`${JSON.stringify({ ...about, scenes }, null, 2)}\n`);
}
