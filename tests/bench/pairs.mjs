// Statistics of two programs that ran by turns: only neighbouring runs are compared, so that what
// slows the machine for longer than two runs cancels.

/**
 * @typedef {{ median: number, lower: number, upper: number, values: number[] }} Spread  `lower`,
 * `upper`: quartiles
 */
/** @typedef {{ frames: number, frame_ms: { median: number },
 *    passes: { name: string, ran: boolean, frames: number, ms: { median: number } }[] }} Statistics
 *     of voxcast */
/** @typedef {{ frame: number, passes: Map<string, { ms: number, frames: number }> }} Run */
/**
 * @typedef {{ name: string, this_ms: number | null, that_ms: number | null, ratio: Spread | null }}
 * Row
 */

/**
 * Linear between neighbours, as R's and NumPy's default.
 * @param {number[]} values  one at least
 * @param {number} fraction
 */
export function quantile(values, fraction) {
  const sorted = [...values].sort((a, b) => a - b);
  const at = (sorted.length - 1) * fraction;
  const below = sorted[Math.floor(at)];
  return below + (sorted[Math.ceil(at)] - below) * (at % 1);
}

/** @param {number[]} values @returns {Spread} */
export const spreadOf = (values) => ({
  median: quantile(values, 0.5),
  lower: quantile(values, 0.25),
  upper: quantile(values, 0.75),
  values,
});

/**
 * Which program and clock each run of a scene has. Programs go this, that, that, this, so that
 * neither is favoured by a load that grows or falls.
 * @param {string[]} clocks
 * @param {number} pairs  of each clock
 * @returns {{ clock: string, first: 'this' | 'that' }[]}  one a pair
 */
export function orderOfPairs(clocks, pairs) {
  const order = /** @type {{ clock: string, first: 'this' | 'that' }[]} */ ([]);
  for (let pair = 0; pair < pairs; pair++)
    clocks.forEach((clock, i) =>
      order.push({ clock, first: (pair + i) % 2 === 0 ? 'this' : 'that' }),
    );
  return order;
}

/**
 * Milliseconds a frame of what voxcast's statistics say. Of a camera at rest: of all frames until
 * the image has converged, which differ too much for one median.
 * @param {Statistics} statistics
 * @param {boolean} moving
 * @param {Record<string, string>} renamed  today's names of passes by their former ones
 * @returns {Run}
 */
export function runOf({ frames, frame_ms, passes }, moving, renamed) {
  const divisor = moving ? frames : 1;
  const ran = passes.filter((pass) => pass.ran);
  const times = new Map(
    ran.map((pass) => [
      renamed[pass.name] ?? pass.name,
      { ms: (pass.ms.median * pass.frames) / divisor, frames: pass.frames },
    ]),
  );
  const sum = [...times.values()].reduce((total, { ms }) => total + ms, 0);
  return { frame: moving ? frame_ms.median : sum, passes: times };
}

/**
 * One row for the frame, then one for each pass that ran in either program. What only one of them
 * has gets no ratio.
 * @param {{ this: Run, that: Run }[]} pairs
 * @returns {Row[]}
 */
export function rowsOf(pairs) {
  const runs = pairs.flatMap((pair) => [pair.this, pair.that]);
  const names = [...new Set(runs.flatMap((run) => [...run.passes.keys()]))];
  const row = (name, get) => {
    const own = pairs.map((pair) => ({ this: get(pair.this), that: get(pair.that) }));
    const median = (side) => {
      const values = own.map((pair) => pair[side]).filter((value) => value !== undefined);
      return values.length > 0 ? quantile(values, 0.5) : null;
    };
    const ratios = own
      .filter((pair) => pair.this !== undefined && pair.that > 0)
      .map((pair) => pair.this / pair.that);
    return {
      name,
      this_ms: median('this'),
      that_ms: median('that'),
      ratio: ratios.length > 0 ? spreadOf(ratios) : null,
    };
  };
  return [
    row('frame', (run) => run.frame),
    ...names.map((name) => row(name, (run) => run.passes.get(name)?.ms)),
  ];
}

/**
 * Passes that did not run in equally many frames: there the programs did not do equal work.
 * @param {{ this: Run, that: Run }[]} pairs
 * @returns {{ name: string, this: number[], that: number[] }[]}  frames in which it ran, of each
 * run
 */
export function unequalWork(pairs) {
  const runs = pairs.flatMap((pair) => [pair.this, pair.that]);
  const names = [...new Set(runs.flatMap((run) => [...run.passes.keys()]))];
  const framesOf = (side, name) => pairs.map((pair) => pair[side].passes.get(name)?.frames ?? 0);
  return names
    .map((name) => ({ name, this: framesOf('this', name), that: framesOf('that', name) }))
    .filter((pass) => new Set([...pass.this, ...pass.that]).size > 1);
}
