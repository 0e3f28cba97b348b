// The chart of error against time as an SVG file, readable on light and dark pages.
import '../../web_client/report/error_chart.js';

const { shapesOf } = globalThis.errorChart;
const SIZE = { width: 900, height: 480 };

const STYLE = `
svg { --ink: #1b1e24; --dim: #5b6270; --faint: #d9dce2; --back: #fff }
@media (prefers-color-scheme: dark) {
  svg { --ink: #e4e6ea; --dim: #a2a9b6; --faint: #353a44; --back: #16181c }
}
text { fill: var(--dim); font: 12px system-ui, sans-serif }
.name { fill: var(--ink); font-size: 11px }
.name { paint-order: stroke; stroke: var(--back); stroke-width: 3px }
.back { fill: var(--back) } .grid { stroke: var(--faint) } .point { stroke: var(--back) }
.native { fill: #2b7fd9 } .avx2 { fill: #d9622b } .limit { fill: var(--ink) }
.noise { stroke: var(--dim); stroke-dasharray: 1 3 }
.front { fill: none; stroke: var(--dim); stroke-dasharray: 4 3 }
`;

const escaped = (text) =>
  String(text).replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/"/g, '&quot;');
const rounded = (value) =>
  typeof value === 'number'
    ? Number(value.toFixed(1))
    : String(value).replace(/\d+\.\d+/g, (n) => Number(n).toFixed(1));

/** @param {any} results of an accuracy run @param {any} choice what the chart draws */
export const chartSvg = (results, choice) => svgOf(shapesOf({ results, choice, ...SIZE }), SIZE);

/**
 * @typedef {{ tag: string, attributes: Record<string, string | number>, text?: string, point?:
 *   any }} Shape
 */

/**
 * @param {Shape[]} drawn
 * @param {{ width: number, height: number }} size
 */
export function svgOf(drawn, { width, height }) {
  const shapes = drawn.map(({ tag, attributes, text, point }) => {
    const shown = Object.entries(attributes).filter(
      ([name]) => !name.startsWith('aria-') && !name.startsWith('data-'),
    );
    const written = shown.map(([name, value]) => ` ${name}="${escaped(rounded(value))}"`).join('');
    const inner = point
      ? `<title>${escaped(attributes['aria-label'])}</title>`
      : text === undefined
        ? ''
        : escaped(text);
    return `<${tag}${written}>${inner}</${tag}>`;
  });
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" ` +
      `width="${width}" height="${height}">`,
    `<style>${STYLE}</style>`,
    `<rect class="back" width="100%" height="100%"/>`,
    ...shapes,
    '</svg>',
    '',
  ].join('\n');
}
