// Proves, on made-up figures, how presets are judged by the Pareto front, and what is recorded of
// accuracy runs.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { figuresOf, figuresText } from '../../docs/generate/accuracy_figures.mjs';
import {
  PRESETS,
  faultsOf,
  frontAt,
  hasVariations,
  judgePresets,
  presetTable,
  tableChanges,
} from '../../docs/generate/accuracy_presets.mjs';

const figures = (
  name,
  frame_ms,
  flip,
  {
    preset = 'high',
    set = { cone_set: '16' },
    scale = 1,
    settle_ms = 10 * frame_ms,
    settled = true,
  } = {},
) => ({
  name,
  settings: { preset, scale, set },
  frame_ms,
  settle_ms,
  settled,
  metrics: { ldr_flip: flip },
});
const presetConfiguration = (preset, frame_ms, flip, rest = {}) =>
  figures(preset, frame_ms, flip, { preset, set: {}, ...rest });

/** A scene whose presets form the whole front, except for what is added. */
const sceneWith = (...others) => ({
  name: 'box',
  rungs: [
    ...others,
    presetConfiguration('draft', 10, 0.4),
    presetConfiguration('interactive', 20, 0.3),
    presetConfiguration('high', 40, 0.2),
    presetConfiguration('final', 400, 0.1),
  ],
});

const judged = (scene, preset) => judgePresets(scene).find((one) => one.preset === preset);

test('a preset that no configuration beats is on the front', () => {
  const scene = sceneWith(
    figures('slower', 41, 0.15),
    figures('worse', 30, 0.25),
    figures('worse-and-slower', 50, 0.5),
  );
  assert.deepEqual(
    faultsOf(sceneWith(figures('slower', 41, 0.15), figures('worse', 39, 0.21))),
    [],
  );
  assert.equal(judged(scene, 'high').excess, 1);
  assert.equal(frontAt(scene.rungs, 'high').name, 'high');
});

test('a preset may err up to 10 % more than the front', () => {
  const near = sceneWith(figures('better', 40, 0.2 / 1.09));
  assert.ok(Math.abs(judged(near, 'high').excess - 1.09) < 1e-9);
  assert.equal(judged(near, 'high').front.name, 'better');
  assert.deepEqual(faultsOf(near), []);
  const far = sceneWith(figures('better', 40, 0.2 / 1.11), figures('good', 30, 0.2 / 1.05));
  assert.equal(judged(far, 'high').isNear, false);
  assert.deepEqual(
    judgePresets(far)
      .filter(({ isNear }) => !isNear)
      .map(({ preset }) => preset),
    ['high'],
  );
});

test('a fault names scene, preset, the better configuration and both figures', () => {
  const faults = faultsOf(sceneWith(figures('better', 18, 0.25)));
  assert.deepEqual(faults, [
    'box: preset interactive (LDR-FLIP 0.3, 20 ms a frame, 200 ms to settle) errs 20.0 % ' +
      'more than configuration better (LDR-FLIP 0.25, 18 ms a frame, 180 ms to settle), which ' +
      'is at most as slow; up to 10.0 % is allowed',
  ]);
});

test('presets are compared with what settles as soon, too', () => {
  assert.deepEqual(
    faultsOf(sceneWith(figures('settles-late', 300, 0.05, { settle_ms: 4001 }))),
    [],
  );
  assert.deepEqual(
    faultsOf(sceneWith(figures('never-settles', 300, 0.05, { settle_ms: 3000, settled: false }))),
    [],
  );
  const [fault] = faultsOf(sceneWith(figures('settles-soon', 300, 0.05, { settle_ms: 4000 })));
  assert.match(
    fault,
    new RegExp(
      String.raw`^box: preset final \(LDR-FLIP 0\.1, 400 ms a frame, 4000 ms to settle\) ` +
        String.raw`errs 100\.0 % more than configuration settles-soon`,
    ),
  );
});

test('what has no figures beats nothing, and is no preset near the front', () => {
  assert.deepEqual(
    faultsOf(sceneWith(figures('unknown', 10, null), figures('timeless', null, 0.01))),
    [],
  );
  const scene = sceneWith();
  const without = { ...scene, rungs: scene.rungs.filter(({ name }) => name !== 'draft') };
  assert.deepEqual(faultsOf(without), ['box: preset draft was not measured']);
  without.rungs.push(presetConfiguration('draft', 10, null));
  assert.deepEqual(faultsOf(without), ['box: preset draft has no figures of error and time']);
  // A preset with other settings is not the preset.
  const varied = {
    ...scene,
    rungs: scene.rungs.map((configuration) =>
      configuration.name === 'final'
        ? figures('final', 400, 0.1, { preset: 'final' })
        : configuration,
    ),
  };
  assert.deepEqual(faultsOf(varied), ['box: preset final was not measured']);
});

test('a sweep of presets alone proves nothing', () => {
  assert.equal(hasVariations(sceneWith()), false);
  assert.equal(
    hasVariations(sceneWith(figures('none', 5, 0.5, { set: { gi_method: 'none' } }))),
    false,
  );
  assert.equal(
    hasVariations(sceneWith(figures('grid', 5, 0.5, { set: { gi_method: 'grid' } }))),
    true,
  );
});

test('tables are compared field by field', () => {
  const table = { draft: { shadow_taps: 1, gather_mode: 'cache' }, high: { shadow_taps: 16 } };
  assert.deepEqual(tableChanges(table, structuredClone(table)), []);
  assert.deepEqual(
    tableChanges(table, { draft: { shadow_taps: 2, gather_mode: 'cache', new_field: 0.5 } }),
    [
      'draft.shadow_taps: 1 when it was measured, 2 now',
      'draft.new_field: nothing when it was measured, 0.5 now',
      'high.shadow_taps: 16 when it was measured, nothing now',
    ],
  );
});

test('the page tells how far from the front each preset is', () => {
  const scene = {
    title: 'Box',
    ...sceneWith(figures('better', 40, 0.2 / 1.05), figures('much-better', 400, 0.05)),
  };
  assert.match(
    presetTable([scene]),
    /\| Box \| on it \| on it \| \+5\.0 % \(`better`\) \| \*\*\+100\.0 % \(`much-better`\)\*\* \|/,
  );
  assert.match(presetTable([{ title: 'Nothing', rungs: [] }]), /\| Nothing \| – \| – \| – \| – \|/);
});

const QUALITY = Object.fromEntries(
  PRESETS.map((preset, i) => [preset, { shadow_taps: i, gather_mode: 'cache' }]),
);
const MACHINE = { processor: 'a processor', cores: 2, gl_renderer: 'a renderer' };

const entry = (name, ms) => ({
  name,
  settings: { preset: 'high', scale: 1, set: { gi_method: 'grid' } },
  frame_ms: { median: ms, p95: 99 },
  memory_bytes: 1,
  converged: {
    ms: 1234.5678,
    settled: true,
    metrics: {
      rmse: 7,
      ldr_flip: 0.1234567,
      rel_mse: 1e-7,
      ssim: 0.98765,
      energy_red: 1.00004,
      energy_green: null,
    },
  },
});

function runOf(name, path, quality = QUALITY) {
  const setup = {
    scene: { source: `/home/somebody/scenes/${path}`, width: 640, height: 360 },
    quality,
    reference: { noise: 0.0049876 },
  };
  return {
    scene: path ? { name, title: name, path } : { name, title: name, source: `builtin:${name}` },
    folder: '/somewhere',
    results: {
      setup,
      rungs: [entry('b', 12.34567), entry('a', 1e3 / 3)],
      noise: { metrics: { ldr_flip: { reference: 0.00213333 } } },
    },
  };
}

test('figures are few, rounded, in the order of names, and a line each', () => {
  const text = figuresText(
    figuresOf([runOf('cornell'), runOf('sponza', 'sponza/sponza.glb')], MACHINE),
  );
  const { machine, quality, scenes } = JSON.parse(text);
  assert.deepEqual(machine, MACHINE);
  assert.deepEqual(quality, QUALITY);
  assert.deepEqual(
    scenes.map(({ name, source }) => [name, source]),
    [
      ['cornell', 'builtin:cornell'],
      ['sponza', 'sponza/sponza.glb'],
    ],
  );
  const [{ rungs: configurations, ...facts }] = scenes;
  assert.deepEqual(facts, {
    name: 'cornell',
    source: 'builtin:cornell',
    width: 640,
    height: 360,
    truth: { noise: 0.004988, ldr_flip: 0.002133 },
  });
  assert.deepEqual(
    configurations.map(({ name, frame_ms }) => [name, frame_ms]),
    [
      ['a', 333.3],
      ['b', 12.35],
    ],
  );
  assert.deepEqual(configurations[1], {
    name: 'b',
    settings: { preset: 'high', scale: 1, set: { gi_method: 'grid' } },
    frame_ms: 12.35,
    settle_ms: 1235,
    settled: true,
    metrics: {
      ldr_flip: 0.1235,
      rel_mse: 1e-7,
      ssim: 0.9877,
      energy_red: 1,
      energy_green: null,
      energy_blue: null,
    },
  });
  assert.equal(text.match(/^ {6}\{"name":.*\},?$/gm).length, 4);
  assert.equal(text.match(/^ {4}"(draft|interactive|high|final)": \{.*\},?$/gm).length, 4);
  assert.doesNotMatch(text, /somebody/);
});

test('runs of different quality tables are not put together', () => {
  const changed = { ...QUALITY, draft: { ...QUALITY.draft, shadow_taps: 9 } };
  assert.throws(
    () => figuresOf([runOf('cornell'), runOf('atrium', null, changed)], MACHINE),
    /cornell and atrium were measured with different quality tables/,
  );
  assert.throws(
    () => figuresOf([runOf('cornell'), runOf('atrium', null, null)], MACHINE),
    /results of atrium do not tell the quality table/,
  );
});
