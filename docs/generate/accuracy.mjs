// ./dev accuracy: measures scenes by voxcast accuracy, each in a folder of its own, where a run
// that was stopped goes on, and writes docs/accuracy.md and docs/accuracy/figures.json of what is
// there.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { availableParallelism, cpus } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { figuresOf, figuresText } from './accuracy_figures.mjs';
import { writePage } from './accuracy_page.mjs';
import { SCENES } from './accuracy_scenes.mjs';

const ROOT = dirname(dirname(dirname(fileURLToPath(import.meta.url))));

// As the tests have it.
const SCENES_FOLDER = process.env.VOXCAST_SCENES || join(ROOT, '../shared/scenes');

const USAGE = `usage: ./dev accuracy [OPTIONS]

Measures every scene by voxcast accuracy and writes docs/accuracy.md, and for the test that judges
the presets docs/accuracy/figures.json. The machine should have nothing else to do.
What has been measured by the same program is kept; a run that was stopped goes on.

  --scenes A,B     only these: ${SCENES.map(({ name }) => name).join(', ')}
  --size WxH       of the images (default 640x360)
  --noise X        of the reference image: standard error of pixels over the mean (default 0.005)
  --samples N      a pixel of the reference image, in scenes with caustics, whose noise falls too
                   slowly (default 16384)
  --ladder NAME    quick, full or a file (default full)
  --frames N       of a moving camera for each setting (default 12)
  --out DIR        where measurements are kept (default build/accuracy)
  --docs DIR       where page and figures are written (default docs)
  --page-only      measure nothing; write page and figures of what is there
Scenes that are not shipped are read from the folder VOXCAST_SCENES, or else ../shared/scenes; what
is not there is left out.
`;

const fail = (message, status = 1) => {
  process.stderr.write(`accuracy: ${message}\n`);
  process.exit(status);
};

function readOptions() {
  const text = (fallback) => ({ type: 'string', default: fallback });
  try {
    return parseArgs({
      options: {
        scenes: text(SCENES.map(({ name }) => name).join()),
        size: text('640x360'),
        noise: text('0.005'),
        samples: text('16384'),
        ladder: text('full'),
        frames: text('12'),
        out: text(join(ROOT, 'build/accuracy')),
        docs: text(join(ROOT, 'docs')),
        'page-only': { type: 'boolean', default: false },
        help: { type: 'boolean', default: false },
      },
    }).values;
  } catch (error) {
    return fail(`${error.message}\n\n${USAGE}`, 2);
  }
}

function chooseScenes(names) {
  return names.split(',').map((name) => {
    const scene = SCENES.find((one) => one.name === name);
    return (
      scene ??
      fail(
        `--scenes: there is no scene "${name}"; there are ` +
          `${SCENES.map((one) => one.name).join(', ')}`,
        2,
      )
    );
  });
}

/** What voxcast is to load; null if it is not there. */
function sourceOf(scene) {
  if (scene.source) return scene.source;
  const path = join(SCENES_FOLDER, scene.path);
  return existsSync(path) ? path : null;
}

/** False if it failed: voxcast has said why. */
function measure(scene, source, options, folder) {
  mkdirSync(folder, { recursive: true });
  process.stderr.write(`accuracy: ${scene.name}\n`);
  const { size, noise, samples, ladder, frames } = options;
  const reference = scene.hasCaustics ? ['--reference-spp', samples] : ['--until-noise', noise];
  const chosen = ['--size', size, ...reference, '--ladder', ladder, '--frames', frames];
  const program = process.env.VOXCAST ?? join(ROOT, 'build/release/bin/voxcast');
  const { status, error } = spawnSync(program, ['accuracy', source, '--out', folder, ...chosen], {
    stdio: 'inherit',
  });
  if (error) fail(`cannot run ${program}: ${error.message}`);
  return status === 0;
}

function loadRun(scene, folder) {
  const path = join(folder, 'results.json');
  if (!existsSync(path)) return null;
  const results = JSON.parse(readFileSync(path, 'utf8'));
  return results.rungs.length > 0 ? { scene, folder, results } : null;
}

const machineOf = (runs) => ({
  processor: cpus()[0]?.model ?? 'unknown',
  cores: availableParallelism?.() ?? cpus().length,
  gl_renderer: [...new Set(runs.map(({ results }) => results.setup.gl_renderer))].join('; '),
});

function describe({ processor, cores, gl_renderer }) {
  const git = spawnSync('git', ['-C', ROOT, 'rev-parse', '--short', 'HEAD'], { encoding: 'utf8' });
  const commit = git.status === 0 ? git.stdout.trim() : 'unknown';
  return [
    '| measured on | |',
    '|---|---|',
    `| processor | ${processor}, ${cores} cores |`,
    `| GL renderer | ${gl_renderer} |`,
    `| commit | ${commit} |`,
  ].join('\n');
}

function writeFigures(runs, machine, path) {
  try {
    writeFileSync(path, figuresText(figuresOf(runs, machine)));
    process.stderr.write(`accuracy: wrote ${path}\n`);
  } catch (error) {
    fail(`cannot write ${path}: ${error.message}`);
  }
}

const options = readOptions();
if (options.help) {
  process.stdout.write(USAGE);
  process.exit(0);
}
const scenes = chooseScenes(options.scenes);
const failed = [];
for (const scene of options['page-only'] ? [] : scenes) {
  const source = sourceOf(scene);
  if (!source)
    process.stderr.write(
      `accuracy: ${scene.name} is left out: ${SCENES_FOLDER} has no ${scene.path}\n`,
    );
  else if (!measure(scene, source, options, join(options.out, scene.name))) failed.push(scene.name);
}
const found = scenes.map((scene) => ({
  scene,
  run: loadRun(scene, join(options.out, scene.name)),
}));
const runs = found.flatMap(({ run }) => run ?? []);
if (runs.length === 0) fail(`nothing has been measured in ${options.out}`);
mkdirSync(join(options.docs, 'accuracy'), { recursive: true });
const machine = machineOf(runs);
const causes = join(ROOT, 'docs/accuracy/causes.md');
writePage({
  runs,
  missing: found.filter(({ run }) => !run).map(({ scene }) => scene),
  machine: describe(machine),
  causes: readFileSync(causes, 'utf8'),
  folder: options.docs,
});
process.stderr.write(`accuracy: wrote ${join(options.docs, 'accuracy.md')}\n`);
writeFigures(runs, machine, join(options.docs, 'accuracy/figures.json'));
if (failed.length > 0) fail(`failed: ${failed.join(', ')}`);
