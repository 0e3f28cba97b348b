// Proves that the presets are chosen from measured data: by the figures that ./dev accuracy has
// recorded, no preset errs by more than a tenth above the Pareto front of any built-in scene, and
// the figures are those of the present quality table. Nothing is measured here.
//
// Run: VOXCAST=build/release/bin/voxcast node --test tests/web/accuracy_presets.test.mjs
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import {
  PRESETS,
  faultsOf,
  hasVariations,
  tableChanges,
} from '../../docs/generate/accuracy_presets.mjs';
import { SCENES } from '../../docs/generate/accuracy_scenes.mjs';

const FIGURES = fileURLToPath(new URL('../../docs/accuracy/figures.json', import.meta.url));
const PROGRAM =
  process.env.VOXCAST ?? fileURLToPath(new URL('../../build/release/bin/voxcast', import.meta.url));
const MEASURE = 'run ./dev accuracy and commit docs/accuracy/figures.json';

const BUILT_IN = SCENES.filter(({ source }) => source?.startsWith('builtin:')).map(
  ({ name }) => name,
);

/** Fails rather than skips if there are no figures: then nothing would check the presets. */
function readFigures() {
  try {
    return JSON.parse(readFileSync(FIGURES, 'utf8'));
  } catch (error) {
    throw new Error(`no figures of accuracy (${error.message}); ${MEASURE}`);
  }
}

function presentTable() {
  const { status, stdout, stderr, error } = spawnSync(PROGRAM, ['info', '--quality'], {
    encoding: 'utf8',
  });
  assert.equal(status, 0, `${PROGRAM} info --quality: ${error?.message ?? stderr}`);
  return JSON.parse(stdout);
}

describe('presets by recorded figures', () => {
  test('the quality table is the one that was measured', () => {
    const [figures, table] = [readFigures(), presentTable()];
    assert.deepEqual(Object.keys(table), PRESETS);
    const changes = tableChanges(figures.quality, table);
    assert.equal(
      changes.length,
      0,
      `the quality table has changed since it was measured (${changes.join('; ')}); ${MEASURE}`,
    );
  });

  test('every built-in scene was measured, with more than the presets', () => {
    const measured = readFigures().scenes.filter(hasVariations).map(({ name }) => name);
    const missing = BUILT_IN.filter((name) => !measured.includes(name));
    assert.equal(
      missing.length,
      0,
      `there are no figures of the full sweep for ${missing.join(', ')}; ${MEASURE}`,
    );
  });

  for (const name of BUILT_IN)
    test(`presets are near the front in ${name}`, () => {
      const scene = readFigures().scenes.find((one) => one.name === name);
      assert.ok(scene, `${name} was not measured; ${MEASURE}`);
      const faults = faultsOf(scene);
      assert.equal(faults.length, 0, `\n${faults.join('\n')}`);
    });
});
