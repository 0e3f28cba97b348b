// Proves that ./dev gpu-check pack makes a folder that runs elsewhere: a scene is measured, a
// golden image compared and a test run, and the results say so; and that what is wrong on its
// command line is refused.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';

const PACK = fileURLToPath(new URL('../gpu_check/pack.sh', import.meta.url));
const MAX_PACKED_BYTES = 64 << 20;

describe('gpu-check', () => {
  let folder, check;

  function run(args) {
    return spawnSync(join(check, 'run'), args, { encoding: 'utf8', cwd: folder });
  }

  before(() => {
    folder = mkdtempSync(join(tmpdir(), 'voxcast-gpu-check-'));
    check = join(folder, 'elsewhere');
    const packed = spawnSync(PACK, [check], { encoding: 'utf8' });
    assert.equal(packed.status, 0, packed.stderr);
    assert.ok(statSync(`${check}.tar.xz`).size <= MAX_PACKED_BYTES);
  });
  after(() => rmSync(folder, { recursive: true, force: true }));

  test('measures, compares and tests', () => {
    const out = join(folder, 'out');
    const chosen = ['--scenes', 'furnace', '--tests', 'test_display', '--goldens', 'view-ids'];
    const { status, stderr } = run([out, '--size', '32x18', '--frames', '2', ...chosen]);
    assert.equal(status, 0, stderr);
    const results = JSON.parse(readFileSync(join(out, 'results.json'), 'utf8'));
    const table = readFileSync(join(out, 'results.txt'), 'utf8');
    assert.equal(results.size, '32x18');
    assert.equal(results.goldens, 'passed');
    assert.match(readFileSync(join(out, 'golden.log'), 'utf8'), /^view-ids +ok/);
    assert.deepEqual(
      results.tests.map(({ name, status: result }) => [name, result]),
      [['test_display', 'passed']],
    );
    const [{ scene, statistics, goal_met: met }] = results.bench;
    assert.equal(scene, 'furnace');
    assert.equal(met, statistics.frame_ms.median <= results.goal_ms);
    for (const { name, ran, ms } of statistics.passes)
      if (ran) assert.match(table, new RegExp(`^  ${name} +${ms.median.toFixed(3)} `, 'm'));
    assert.match(table, /1 passed, 0 failed, 0 skipped/);
  });

  test('a scene that cannot be drawn is told, and misses the goal', () => {
    const out = join(folder, 'missing');
    run([out, '--scenes', 'nowhere', '--tests', 'none', '--goldens', 'none']);
    const results = JSON.parse(readFileSync(join(out, 'results.json'), 'utf8'));
    assert.equal(results.goal_met, false);
    assert.match(results.bench[0].failed, /nowhere/);
    assert.equal(results.goldens, 'not_run');
  });

  test('what cannot be meant is refused', () => {
    for (const [args, message] of [
      [['--size', 'large'], /--size is "large"; want WxH/],
      [['--frames', '0'], /--frames is "0"; 1 to/],
      [['--unknown'], /no option --unknown/],
      [['--size'], /--size needs a value/],
    ]) {
      const { status, stderr } = run(args);
      assert.equal(status, 2);
      assert.match(stderr, message);
      assert.ok(!existsSync(join(folder, 'results')));
    }
  });
});
