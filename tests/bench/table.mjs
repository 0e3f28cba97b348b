// What people read: one table a scene, with the columns of each clock.

/** @typedef {import('./pairs.mjs').Row} Row */

const NAME_COLUMNS = 18;
const CLOCK_HEAD = '      this      that   ratio      quartiles';

const ms = (/** @type {number | null} */ value) =>
  (value === null ? '-' : value.toFixed(value < 100 ? 2 : 1)).padStart(10);

/** @param {Row} row */
function cellsOf({ this_ms: own, that_ms: other, ratio }) {
  const spread = ratio ? `${ratio.lower.toFixed(3)}..${ratio.upper.toFixed(3)}` : '';
  const median = ratio?.median.toFixed(3) ?? '-';
  return `${ms(own)}${ms(other)}${median.padStart(8)}${spread.padStart(15)}`;
}

/**
 * @param {Record<string, Row[]>} clocks  rows by clock
 * @param {string} unit
 * @returns {string}
 */
export function formatTable(clocks, unit) {
  const names = [...new Set(Object.values(clocks).flatMap((rows) => rows.map((row) => row.name)))];
  const line = (name, cells) => `${name.padEnd(NAME_COLUMNS)}${cells.join('   ')}`.trimEnd();
  const titles = Object.keys(clocks).map((clock) =>
    `${clock}, ${unit}`.padStart(20).padEnd(CLOCK_HEAD.length),
  );
  const body = names.map((name) =>
    line(
      name,
      Object.values(clocks).map((rows) => {
        const row = rows.find((candidate) => candidate.name === name);
        return row ? cellsOf(row) : ' '.repeat(CLOCK_HEAD.length);
      }),
    ),
  );
  return [
    line('', titles),
    line(
      '',
      titles.map(() => CLOCK_HEAD),
    ),
    ...body,
  ].join('\n');
}
