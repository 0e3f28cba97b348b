// Proves the page that ./dev accuracy writes, from made-up results with known figures: tables, the
// front, figures that noise makes unsure, what steps of settings buy, the windows with the largest
// errors, the image files, and the recorded figures.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import {
  existsSync,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  rmSync,
  statSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { buysTable, stepsOf } from '../../docs/generate/accuracy_buys.mjs';
import { worstWindows } from '../../docs/generate/accuracy_errors.mjs';
import {
  cropped,
  makePicture,
  readPng,
  resized,
  tiled,
  writePng,
} from '../../docs/generate/png.mjs';
import { heatMapColor } from '../../web_client/accuracy/heat_map.js';

const PROGRAM = fileURLToPath(new URL('../../docs/generate/accuracy.mjs', import.meta.url));
const [WIDTH, HEIGHT] = [48, 30];

const figures = (flip) => ({
  ldr_flip: flip,
  ssim: 1 - flip,
  rel_mse: flip / 10,
  energy_red: 1.1,
  energy_green: 1,
  energy_blue: 0.9,
});

function configuration(name, method, ms, flip, set = {}, scale = 1) {
  return {
    name,
    method,
    settings: { preset: 'high', scale, set },
    frame_ms: { median: ms },
    memory_bytes: ms * 1048576,
    cold: { ms, metrics: figures(flip) },
    converged: { ms: 10 * ms, settled: true, metrics: figures(flip), indirect: figures(2 * flip) },
    pictures: { converged: 'picture.png', error: 'error.png', strip: 'picture.png' },
  };
}

const CONFIGURATIONS = [
  configuration('none', 'none', 5, 0.4, { gi_method: 'none' }),
  configuration('high', 'clipmap', 40, 0.1),
  configuration('final', 'clipmap', 400, 0.05),
  configuration('clipmap-bounces-4', 'clipmap', 50, 0.2, { gi_method: 'clipmap', bounces: '4' }),
  configuration('clipmap-scale-0.5', 'clipmap', 20, 0.2, { gi_method: 'clipmap' }, 0.5),
  configuration('grid-64-cache', 'grid', 20, 0.16, {
    gi_method: 'grid',
    voxel_resolution: '64',
    gather_mode: 'cache',
  }),
  configuration('grid-128-cache', 'grid', 60, 0.08, {
    gi_method: 'grid',
    voxel_resolution: '128',
    gather_mode: 'cache',
  }),
  configuration('grid-64-half', 'grid', 30, 0.12, {
    gi_method: 'grid',
    voxel_resolution: '64',
    gather_mode: 'half',
  }),
  configuration('grid-128-half', 'grid', 60, 0.09, {
    gi_method: 'grid',
    voxel_resolution: '128',
    gather_mode: 'half',
  }),
];
CONFIGURATIONS[2].settings.preset = 'final';

const noise = (reference, smallest) => ({
  reference,
  smallest,
  enough: reference <= 0.1 * smallest,
});
const QUALITY = {
  high: { gather_mode: 'cache', cone_step: 0.5 },
  final: { gather_mode: 'rays', cone_step: 0.25 },
};
const RESULTS = {
  setup: {
    scene: { source: 'builtin:cornell', width: WIDTH, height: HEIGHT },
    gl_renderer: 'a renderer',
    quality: QUALITY,
    reference: { noise: 0.004, direct: true },
  },
  metrics: ['ldr_flip', 'ssim', 'rel_mse', 'energy_red'].map((name) => ({
    name,
    title: name.toUpperCase(),
    unit: '',
  })),
  rungs: CONFIGURATIONS,
  noise: {
    metrics: {
      ldr_flip: noise(0.004, 0.05),
      ssim: noise(0.01, 0.05),
      energy_red: noise(0.001, 0.1),
    },
    indirect: { energy_red: noise(0.02, 0.1) },
  },
};

let folder;
before(() => (folder = mkdtempSync(join(tmpdir(), 'voxcast-page-'))));
after(() => rmSync(folder, { recursive: true, force: true }));

function gradient() {
  const picture = makePicture(WIDTH, HEIGHT);
  for (let i = 0; i < picture.rgb.length; i++)
    picture.rgb[i] = (i * 7 + (i % 5) * ((i * i) % 97)) & 255;
  return picture;
}

/** Errors of 0.1, but for one bright window of 0.8. */
function errorMap({ x, y }) {
  const map = makePicture(WIDTH, HEIGHT);
  for (let i = 0; i < WIDTH * HEIGHT; i++) {
    const isBad = Math.abs((i % WIDTH) - x) < 4 && Math.abs(Math.floor(i / WIDTH) - y) < 3;
    map.rgb.set(heatMapColor(isBad ? 0.8 : 0.1), 3 * i);
  }
  return map;
}

test('PNG files hold what was written', () => {
  const path = join(folder, 'gradient.png');
  const picture = gradient();
  writePng(path, picture);
  assert.deepEqual(readPng(path), picture);
  writeFileSync(path, 'no image at all');
  assert.throws(() => readPng(path), /is no PNG file/);
});

test('images are cut, made smaller by means, larger by repetition, and set side by side', () => {
  const picture = makePicture(4, 2);
  picture.rgb.set([0, 10, 20, 30, 40, 50, 60, 70].flatMap((value) => [value, value, value]));
  const reds = ({ rgb }) => [...rgb].filter((_, i) => i % 3 === 0);
  assert.deepEqual(reds(cropped(picture, { x: 1, y: 0, width: 2, height: 2 })), [10, 20, 50, 60]);
  assert.deepEqual(reds(resized(picture, 2)), [25, 45]);
  assert.deepEqual(reds(resized(picture, 8)).slice(0, 8), [0, 0, 10, 10, 20, 20, 30, 30]);
  const both = tiled([[picture, picture]], 2);
  assert.equal(both.width, 10);
  assert.deepEqual(reds(both).slice(0, 10), [0, 10, 20, 30, 128, 128, 0, 10, 20, 30]);
});

test('the window that errs most is found', () => {
  const windows = worstWindows(errorMap({ x: 36, y: 8 }));
  assert.equal(windows.length, 3);
  const [worst, next] = windows;
  assert.ok(
    worst.x <= 36 && 36 < worst.x + worst.width && worst.y <= 8 && 8 < worst.y + worst.height,
    JSON.stringify(worst),
  );
  assert.ok(worst.error > 0.5 && next.error < worst.error);
});

test('steps pair configurations that differ in one setting alone', () => {
  const steps = stepsOf(CONFIGURATIONS).map(({ key, from, to }) => `${key} ${from} ${to}`).sort();
  assert.deepEqual(steps, [
    'bounces 4 unlimited',
    'gather_mode cache half',
    'gather_mode cache half',
    'scale 0.5 1',
    'voxel_resolution 64 128',
    'voxel_resolution 64 128',
  ]);
  const table = buysTable([CONFIGURATIONS]);
  assert.match(
    table,
    new RegExp(
      String.raw`voxels along an edge: 64 → 128 \| 2 \| −25 % \(−50 % to −25 %\) \|.*` +
        String.raw`\| \+200 % \(\+100 % to \+200 %\) \|`,
    ),
  );
  assert.match(
    table,
    /bounces: 4 → unlimited \| 1 \| −50 % \| −50 % \| −20 % \| −20 % \| −20 % \|/,
  );
  assert.equal(buysTable([[CONFIGURATIONS[0]]]), '');
});

const run = (...options) =>
  spawnSync(process.execPath, [PROGRAM, ...options], { encoding: 'utf8' });

function writeResults(out, results) {
  mkdirSync(join(out, 'cornell'), { recursive: true });
  writeFileSync(join(out, 'cornell', 'results.json'), JSON.stringify(results));
  writePng(join(out, 'cornell', 'reference.png'), gradient());
  writePng(join(out, 'cornell', 'picture.png'), gradient());
  writePng(join(out, 'cornell', 'error.png'), errorMap({ x: 10, y: 20 }));
}

test('the page has curve, tables, marks of noise, images and the reasons', () => {
  const [out, docs] = ['out', 'docs'].map((name) => join(folder, name));
  writeResults(out, RESULTS);
  const { status, stderr } = run(
    '--page-only',
    '--out',
    out,
    '--docs',
    docs,
    '--scenes',
    'cornell,atrium',
  );
  assert.equal(status, 0, stderr);
  const page = readFileSync(join(docs, 'accuracy.md'), 'utf8');
  assert.match(page, /\| Cornell box \| 0\.4 \| – \| – \| 0\.1 \| 0\.05 \| ~0\.95 \|/);
  assert.match(page, /Not measured: Atrium\./);
  assert.match(
    page,
    new RegExp(
      String.raw`Noise of the reference: 0\.4 %.*errs by 0\.004 itself, and the smallest error ` +
        String.raw`shown is 0\.05.*these measures: SSIM of all light; ` +
        String.raw`ENERGY_RED of indirect light\.`,
    ),
  );
  // ms a frame, ms to settle, MiB, errors, energies; on the front.
  assert.match(
    page,
    new RegExp(
      String.raw`\| \*\*final\*\* \| 400 \| 4000 \| 400 \| 0\.05 \| ~0\.95 \| ~0\.005 ` +
        String.raw`\| 1\.1 ~1 ~0\.9 \| ~1\.1 ~1 ~0\.9 \| yes \|`,
    ),
  );
  assert.match(page, /\| clipmap-bounces-4 \| 50 .*\| {2}\|/);
  assert.match(
    page,
    /- `grid-64-half`: preset high, gi_method grid, voxel_resolution 64, gather_mode half/,
  );
  assert.match(page, /LDR-FLIP 0\.\d+ around \(\d+, \d+\)/);
  assert.match(page, /## Presets and the front[^#]*\| Cornell box \| – \| – \| on it \| on it \|/);
  assert.match(page, /## What each setting buys[^#]*bounces: 4 → unlimited/);
  assert.match(page, /## Where it is wrong and why\n\n\*\*/);
  assert.doesNotMatch(page, /undefined|NaN|\[object/);
  const svg = readFileSync(join(docs, 'accuracy', 'cornell.svg'), 'utf8');
  assert.equal(svg.match(/class="point"/g).length, CONFIGURATIONS.length);
  for (const name of ['cornell.png', 'cornell-errors.png'])
    assert.ok(statSync(join(docs, 'accuracy', name)).size > 100);
});

test('figures stand beside the page, unless results do not tell the quality table', () => {
  const [out, docs] = ['figures-out', 'figures-docs'].map((name) => join(folder, name));
  const path = join(docs, 'accuracy', 'figures.json');
  const options = ['--page-only', '--out', out, '--docs', docs, '--scenes', 'cornell'];
  writeResults(out, { ...RESULTS, setup: { ...RESULTS.setup, quality: undefined } });
  const refused = run(...options);
  assert.equal(refused.status, 1);
  assert.match(
    refused.stderr,
    new RegExp(
      String.raw`cannot write .*figures\.json: the results of cornell do not tell the quality ` +
        'table; it must be measured anew',
    ),
  );
  assert.equal(existsSync(path), false);
  writeResults(out, RESULTS);
  assert.equal(run(...options).status, 0);
  const { machine, quality, scenes } = JSON.parse(readFileSync(path, 'utf8'));
  assert.equal(machine.gl_renderer, 'a renderer');
  assert.ok(machine.processor && machine.cores >= 1);
  assert.deepEqual(quality, QUALITY);
  assert.deepEqual(
    scenes.map(({ name, rungs }) => [name, rungs.length]),
    [['cornell', CONFIGURATIONS.length]],
  );
});

test('refuses what it does not know', () => {
  assert.match(run('--scenes', 'nonesuch').stderr, /no scene "nonesuch"; there are cornell, /);
  assert.equal(run('--scenes', 'nonesuch').status, 2);
  assert.match(run('--nonesuch').stderr, /usage: /);
  assert.match(
    run('--page-only', '--out', join(folder, 'empty')).stderr,
    /nothing has been measured/,
  );
});
