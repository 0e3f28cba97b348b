// How a voxcast is run: what differs between revisions stands here, and nowhere else.
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';

import { buildPreload } from './checkouts.mjs';

/** @typedef {import('./pairs.mjs').Statistics & { gl_renderer: string }} Statistics */
/**
 * What both programs draw.
 * @typedef {object} Job
 * @property {string} source
 * @property {string} gi
 * @property {string} quality
 * @property {string} size
 * @property {string | null} move  metres a frame, "X,Y,Z"; null: at rest
 * @property {number} frames  of a moving camera
 * @property {string} gpu
 */

/** Today's names of passes by those of older revisions. */
export const RENAMED_PASSES = /** @type {Record<string, string>} */ ({});

export const CPUS = ['native', 'avx2'];
export const CLOCKS = ['wall', 'cpu'];

/**
 * `render`, as `bench` has neither sizes nor methods, and writes no image. Every revision since
 * 6e08ccd has these options. Light converges before a moving camera is measured: until then the
 * temporal budget, which depends on the machine's speed, decides what a frame does. `interactive`
 * gathers from the cache while the camera moves, so that what only rests need not be awaited.
 * @param {Job} job
 */
export function argumentsOf(job) {
  const { source, gi, quality, size, move, frames, gpu } = job;
  const moving = ['--frames', String(frames), '--move-eye', move ?? '', '--converge-first'];
  return [
    ...['render', source, '--gi', gi, '--preset', quality, '--size', size, '--gpu', gpu],
    ...(move ? moving : []),
    ...(move && quality === 'interactive' ? ['--set', 'gather_mode=cache'] : []),
  ];
}

/**
 * Mesa's name for what is left without AVX-512 is "avx": AVX2, FMA and gathers stay. Its shader
 * cache tells both apart.
 * @param {string} cpu
 * @returns {NodeJS.ProcessEnv}
 */
export const environmentOf = (cpu) => ({
  ...process.env,
  ...(cpu === 'avx2' ? { GALLIUM_OVERRIDE_CPU_CAPS: 'avx', LP_NATIVE_VECTOR_WIDTH: '256' } : {}),
});

/**
 * @param {string} cpu
 * @returns {(clock: string) => NodeJS.ProcessEnv}
 */
export function environmentsOf(cpu) {
  const env = environmentOf(cpu);
  const preload = [env.LD_PRELOAD, buildPreload('cpu_clock')].filter(Boolean).join(' ');
  return (clock) => (clock === 'cpu' ? { ...env, LD_PRELOAD: preload } : env);
}

/**
 * @param {string} program
 * @param {Job} job
 * @param {string} image  where it is written; the extension decides what the last pass does
 * @param {NodeJS.ProcessEnv} env
 * @returns {Promise<Statistics>}
 */
export function runProgram(program, job, image, env) {
  const stats = `${image}.json`;
  const child = spawn(program, [...argumentsOf(job), '--out', image, '--stats', stats], {
    env,
    stdio: ['ignore', 'ignore', 'pipe'],
  });
  const end = () => child.kill();
  process.on('exit', end);
  let errors = '';
  child.stderr.on('data', (data) => (errors += data));
  return new Promise((resolve, reject) => {
    child.on('error', reject);
    child.on('close', (status, signal) => {
      process.off('exit', end);
      if (status === 0) resolve(JSON.parse(readFileSync(stats, 'utf8')));
      else reject(new Error(`${program} ended with ${status ?? signal}: ${errors.trim()}`));
    });
  });
}
