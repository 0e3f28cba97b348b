// Proves by tables what ./dev bench --against computes: quantiles, the order of runs, rows of
// ratios, and by how much and where images differ.
import assert from 'node:assert/strict';
import { describe, test } from 'node:test';

import { compareImages, describeDifference, readPfm } from '../bench/images.mjs';
import { orderOfPairs, quantile, rowsOf, runOf, unequalWork } from '../bench/pairs.mjs';

const statistics = (frames, median, passes) => ({
  frames,
  frame_ms: { median },
  passes: passes.map(([name, ran, ms]) => ({
    name,
    ran: ran > 0,
    frames: ran,
    ms: { median: ms },
  })),
});
const run = (frame, passes) => ({
  frame,
  passes: new Map(Object.entries(passes).map(([name, ms]) => [name, { ms, frames: 10 }])),
});

describe('pairs', () => {
  for (const [values, fraction, expected] of [
    [[3], 0.25, 3],
    [[2, 1], 0.5, 1.5],
    [[4, 1, 3, 2], 0.25, 1.75],
    [[10, 1, 2], 0.5, 2],
    [[1, 2, 3, 4, 5], 0.75, 4],
  ])
    test(`quantile ${fraction} of ${values}`, () =>
      assert.equal(quantile(values, fraction), expected));

  test('programs take turns: this that, that this', () => {
    assert.deepEqual(
      orderOfPairs(['wall', 'cpu'], 2).map(({ clock, first }) => `${clock} ${first}`),
      ['wall this', 'cpu that', 'wall that', 'cpu this'],
    );
  });

  test('a run counts a pass by the part of the frames in which it ran', () => {
    const { frame, passes } = runOf(
      statistics(10, 40, [
        ['old', 10, 8],
        ['rare', 1, 20],
        ['never', 0, 0],
      ]),
      true,
      {
        old: 'new',
      },
    );
    assert.equal(frame, 40);
    assert.deepEqual(
      [...passes].map(([name, { ms }]) => [name, ms]),
      [
        ['new', 8],
        ['rare', 2],
      ],
    );
  });

  test('a run at rest is the sum of its passes until the end', () => {
    assert.equal(
      runOf(
        statistics(10, 40, [
          ['often', 10, 8],
          ['rare', 1, 20],
        ]),
        false,
        {},
      ).frame,
      100,
    );
  });

  test('ratios are of neighbours: what slows a pair does not count', () => {
    const rows = rowsOf([
      { this: run(10, { a: 1 }), that: run(20, { a: 2, gone: 1 }) },
      { this: run(100, { a: 9 }), that: run(200, { a: 10, gone: 1 }) },
      { this: run(11, { a: 1 }), that: run(20, { a: 4, gone: 1 }) },
    ]);
    const [frame, a, gone] = rows;
    assert.deepEqual(frame.ratio, {
      median: 0.5,
      lower: 0.5,
      upper: 0.525,
      values: [0.5, 0.5, 0.55],
    });
    assert.deepEqual([frame.this_ms, frame.that_ms], [11, 20]);
    assert.deepEqual([a.name, a.ratio.median], ['a', 0.5]);
    assert.deepEqual(gone, { name: 'gone', this_ms: null, that_ms: 1, ratio: null });
  });

  test('tells passes that ran in unequally many frames', () => {
    const one = runOf(
      statistics(10, 1, [
        ['a', 10, 1],
        ['b', 2, 1],
      ]),
      true,
      {},
    );
    const other = runOf(
      statistics(10, 1, [
        ['a', 10, 1],
        ['b', 3, 1],
      ]),
      true,
      {},
    );
    assert.deepEqual(unequalWork([{ this: one, that: other }]), [
      { name: 'b', this: [2], that: [3] },
    ]);
  });
});

describe('images', () => {
  const pfm = (width, height, values) =>
    Buffer.concat([
      Buffer.from(`PF\n${width} ${height}\n-1.0\n`),
      Buffer.from(Float32Array.from(values).buffer),
    ]);

  test('tells by how much and where', () => {
    const a = readPfm(pfm(2, 2, [1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4]));
    const b = readPfm(pfm(2, 2, [1, 1, 1, 2, 2, 5, 3, 3, 3, 4, 5, 4]));
    const difference = compareImages(a, b);
    const { equal, differing, largest, at, from, to } = difference;
    assert.deepEqual({ equal, differing, largest }, { equal: false, differing: 2, largest: 3 });
    assert.deepEqual(
      [at, from, to],
      [
        { x: 1, y: 1 },
        { x: 1, y: 0 },
        { x: 1, y: 1 },
      ],
    );
    assert.match(
      describeDifference(difference),
      /2 pixels \(50\.00 %\) within 1,0 to 1,1: RMSE 0\.913 .* at 1,1/,
    );
    assert.ok(compareImages(a, a).equal);
  });

  test('equal values that are not finite are equal', () => {
    const a = readPfm(pfm(1, 1, [NaN, Infinity, 0]));
    assert.ok(compareImages(a, a).equal);
    assert.equal(compareImages(a, readPfm(pfm(1, 1, [0, Infinity, 0]))).largest, Infinity);
  });

  test('refuses what is cut off', () =>
    assert.throws(() => readPfm(pfm(2, 2, [1, 2, 3])), /too early/));
});
