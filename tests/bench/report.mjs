// ./dev bench --report: measures moving frames of scenes by CPU time, and writes
// docs/performance.md of what it has found.
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { availableParallelism, tmpdir } from 'node:os';
import { join } from 'node:path';
import { parseArgs } from 'node:util';

import { writePerformancePage } from '../../docs/generate/performance_page.mjs';
import { describeCheckout, runTool } from './checkouts.mjs';
import { measureBandwidth } from './memory.mjs';
import { readOptions } from './options.mjs';
import { runOf, spreadOf } from './pairs.mjs';
import { CPUS, environmentsOf, runProgram } from './programs.mjs';

const USAGE = `usage: ./dev bench --report [OPTIONS]

Measures frames of a moving camera (640x360, interactive), by CPU time of all threads, in the
scenes of ./dev bench --against, and writes docs/performance.md with a chart a scene: the time of
each pass, the bytes that it must move, and what that takes at the speed at which this machine
copies memory.

  --runs N         runs of each scene, 1 to 100 (default 3)
  --frames N       frames a run, 1 to 1000 (default 20)
  --cpu LIST       native, avx2 or both (default native,avx2)
  --page-only      measure nothing; write the page of the figures that are there
`;

const tell = (/** @type {string} */ what) => process.stderr.write(`bench: ${what}\n`);

/** @param {string} name @param {string} text @param {number} maximum */
function countOf(name, text, maximum) {
  const value = Number(text);
  if (Number.isInteger(value) && value >= 1 && value <= maximum) return value;
  throw Object.assign(new Error(`--${name} is "${text}"; 1 to ${maximum}`), { usage: true });
}

/** @param {string[]} args */
function readReportOptions(args) {
  const text = /** @type {const} */ ({ type: 'string' });
  const flag = /** @type {const} */ ({ type: 'boolean', default: false });
  let values;
  try {
    ({ values } = parseArgs({
      args,
      options: {
        report: flag,
        runs: { ...text, default: '3' },
        frames: { ...text, default: '20' },
        cpu: { ...text, default: CPUS.join(',') },
        'page-only': flag,
        help: flag,
      },
    }));
  } catch (error) {
    throw Object.assign(error, { usage: true });
  }
  const wanted = values.cpu.split(',');
  if (wanted.some((cpu) => !CPUS.includes(cpu)))
    throw Object.assign(new Error(`--cpu is "${values.cpu}"; of ${CPUS.join(', ')}`), {
      usage: true,
    });
  return {
    help: values.help,
    pageOnly: values['page-only'],
    runs: countOf('runs', values.runs, 100),
    frames: countOf('frames', values.frames, 1000),
    wanted,
  };
}

/** Milliseconds of CPU time a frame and pass. */
async function measureScene(program, job, env, runs, path) {
  await runProgram(program, { ...job, frames: 1 }, path, env); // compiles shaders
  const all = [];
  for (let i = 0; i < runs; i++) all.push(await runProgram(program, job, path, env));
  const times = all.map((statistics) => runOf(statistics, true, {}));
  const newest = all.at(-1);
  const median = (values) => Number(spreadOf(values).median.toFixed(2));
  const passes = newest.passes
    .filter(({ ran }) => ran)
    .map(({ name, frames, view_bytes: bytes }) => ({
      name,
      ms: median(times.map((run) => run.passes.get(name)?.ms ?? 0)),
      bytes: Math.round((bytes * frames) / newest.frames),
    }));
  return { renderer: newest.gl_renderer, frame_ms: median(times.map((run) => run.frame)), passes };
}

const machineOf = async () => ({
  processors: availableParallelism(),
  clock_ghz: Number(runTool('clock')),
  copy_gb_per_s: Number(((await measureBandwidth()) / 1e9).toFixed(2)),
});

/** @param {string} root @param {string} program @param {string[]} args */
export async function benchReport(root, program, args) {
  const options = readReportOptions(args);
  if (options.help) {
    process.stdout.write(USAGE);
    return;
  }
  const folder = join(root, 'docs/performance');
  const figures = join(folder, 'figures.json');
  if (!options.pageOnly) {
    tell('copying memory');
    const report = { revision: describeCheckout(root), machine: await machineOf(), scenes: [] };
    const temporary = mkdtempSync(join(tmpdir(), 'voxcast-report-'));
    process.on('exit', () => rmSync(temporary, { recursive: true, force: true }));
    const { scenes } = readOptions(['--against', 'HEAD', '--frames', String(options.frames)]);
    for (const { name, job } of scenes) {
      const cpuFigures = {};
      for (const cpu of options.wanted) {
        tell(`${name}, ${cpu}`);
        const env = environmentsOf(cpu)('cpu');
        const path = join(temporary, 'measured.png');
        cpuFigures[cpu] = await measureScene(program, job, env, options.runs, path);
      }
      report.scenes.push({ name, gi: job.gi, size: job.size, cpus: cpuFigures });
    }
    mkdirSync(folder, { recursive: true });
    writeFileSync(figures, `${JSON.stringify(report, null, 2)}\n`);
  }
  writePerformancePage(join(root, 'docs'), JSON.parse(readFileSync(figures, 'utf8')));
  tell('docs/performance.md is written');
}
