/** Times of a frame that people aim at. `ms` is infinite where only the error counts. */
export const BUDGETS = [
  { name: '16 ms', ms: 16 },
  { name: '33 ms', ms: 33 },
  { name: '100 ms', ms: 100 },
  { name: 'still', ms: Infinity },
];

const errorOf = (/** @type {any} */ configuration) => configuration.converged?.metrics?.ldr_flip;
const msOf = (/** @type {any} */ configuration) => configuration.frame_ms?.median;

/**
 * The most accurate of the measured settings (least LDR-FLIP of the final image) whose median frame
 * keeps a budget; of equals the faster.
 * @param {any[]} configurations entries of results.json @param {number} budgetMs
 * @returns {{best: any | null, fastest: any | null}} best: null if none keeps it
 */
export function pickConfiguration(configurations, budgetMs) {
  const known = configurations.filter(
    (configuration) =>
      Number.isFinite(errorOf(configuration)) && Number.isFinite(msOf(configuration)),
  );
  const first = (/** @type {any[]} */ list, /** @type {(a: any, b: any) => number} */ order) =>
    [...list].sort(order)[0] ?? null;
  return {
    best: first(
      known.filter((configuration) => msOf(configuration) <= budgetMs),
      (a, b) => errorOf(a) - errorOf(b) || msOf(a) - msOf(b),
    ),
    fastest: first(known, (a, b) => msOf(a) - msOf(b)),
  };
}
