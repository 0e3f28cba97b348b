// ./dev stability: runs voxcast stability and writes docs/stability.md of its results.json.
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const ROOT = dirname(dirname(dirname(fileURLToPath(import.meta.url))));

const USAGE = `usage: ./dev stability [OPTIONS]

Runs every case of the stability suite and writes docs/stability.md. Exit status 1 if a case fails.

  --out DIR    where pictures and results.json go (default build/stability/all)
  --docs DIR   where the page is written (default docs)
  --page-only  run nothing; write the page of the results that are there
`;

const fail = (message, status = 1) => {
  process.stderr.write(`stability: ${message}\n`);
  process.exit(status);
};

function readOptions() {
  try {
    return parseArgs({
      options: {
        out: { type: 'string', default: join(ROOT, 'build/stability/all') },
        docs: { type: 'string', default: join(ROOT, 'docs') },
        'page-only': { type: 'boolean', default: false },
        help: { type: 'boolean', default: false },
      },
    }).values;
  } catch (error) {
    return fail(`${/** @type {Error} */ (error).message}; see ./dev stability --help`, 2);
  }
}

const figure = (/** @type {number | null} */ value) =>
  value === null ? '∞' : value === 0 ? '0' : Number(value.toPrecision(3)).toString();

const STATES = /** @type {Record<string, string>} */ ({
  holds: '',
  known: '**known**',
  fails: '**fails**',
});

/** One row for each case and method. */
function rowsOf(/** @type {any[]} */ runs) {
  return runs.map((run, i) => {
    const first = i === 0 || runs[i - 1].name !== run.name;
    const held = run.state === 'known' ? ` (held to ${figure(run.known)})` : '';
    return `| ${[
      first ? `\`${run.name}\`` : '',
      first ? run.invariant : '',
      run.method,
      `${figure(run.bound)}${held}`,
      figure(run.measured),
      run.unit,
      STATES[run.state],
    ].join(' | ')} |`;
  });
}

function pageOf(/** @type {any} */ results) {
  const runs = results.cases;
  const count = (/** @type {string} */ state) =>
    runs.filter((/** @type {any} */ run) => run.state === state).length;
  const families = [...new Set(runs.map((/** @type {any} */ run) => run.family))];
  const tables = families.map((family) => {
    const own = runs.filter((/** @type {any} */ run) => run.family === family);
    return [
      `## ${own[0].title}`,
      '',
      '| case | invariant | method | bound | measured | unit | |',
      '|---|---|---|--:|--:|---|---|',
      ...rowsOf(own),
      '',
    ].join('\n');
  });
  return `# Stability

Small scenes, made in code, that try to break the numbers. Each case states an invariant and a
bound; \`./dev stability\` runs them all and writes this page, \`voxcast stability\` runs them or
one of them and keeps the images, and ctest runs a family at a time. After every frame a compute
shader looks for infinities and NaN in all floating-point resources: depth, G-buffer, radiance,
accumulation, voxel radiance, the irradiance cache, shadow views, lights, instances, materials,
vertices, the environment's harmonics and levels. One of them fails the case, whatever was
measured.

Measured by ${results.gl_renderer.replace(/ \(.*/, '')}: ${runs.length} runs, ${count('holds')}
within their bound, ${count('known')} known to miss it (and held to what stands beside it),
${count('fails')} beyond.

A value of 0 is exact: the same bits. "Of the brightest" is the greatest difference of any channel
of any pixel over the brightest channel of the expected image. \`reference\` is the path tracer with
equal random numbers in both images.

${tables.join('\n')}`;
}

const options = readOptions();
if (options.help) {
  process.stdout.write(USAGE);
  process.exit(0);
}
let status = 0;
if (!options['page-only']) {
  const run = spawnSync(
    join(ROOT, 'build/release/bin/voxcast'),
    ['stability', '--out', options.out],
    { stdio: 'inherit' },
  );
  status = run.status ?? 1;
}
let results;
try {
  results = JSON.parse(readFileSync(join(options.out, 'results.json'), 'utf8'));
} catch (error) {
  fail(`no results: ${/** @type {Error} */ (error).message}`);
}
writeFileSync(join(options.docs, 'stability.md'), pageOf(results));
process.exit(status);
