import { srgbFromLinear } from '../math/color.js';

// As in renderer/metrics/heat_map.c: lightness grows evenly, hue goes from violet through red to
// yellow.
const HIGHEST_LIGHTNESS = 0.97;
const LARGEST_CHROMA = 0.22;
const FIRST_HUE_RAD = (290 * Math.PI) / 180;
const LAST_HUE_RAD = (470 * Math.PI) / 180;
const BISECTION_STEPS = 16;

/** Linear sRGB of an OKLab colour (Ottosson 2020). @returns {number[]} may be outside of 0 to 1 */
function linearFromOklab(
  /** @type {number} */ lightness,
  /** @type {number} */ a,
  /** @type {number} */ b,
) {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s,
  ];
}

const isShown = (/** @type {number[]} */ rgb) => rgb.every((value) => value >= 0 && value <= 1);

/** The colour of an error of 0 to 1 on heat maps: sRGB, 0 to 255. @param {number} error */
export function heatMapColor(error) {
  const lightness = HIGHEST_LIGHTNESS * error;
  const hue = FIRST_HUE_RAD + (LAST_HUE_RAD - FIRST_HUE_RAD) * error;
  const largest = LARGEST_CHROMA * Math.sin(Math.PI * error);
  const colorOf = (/** @type {number} */ chroma) =>
    linearFromOklab(lightness, chroma * Math.cos(hue), chroma * Math.sin(hue));
  let [inside, outside] = isShown(colorOf(largest)) ? [largest, largest] : [0, largest];
  for (let i = 0; i < BISECTION_STEPS; i++) {
    const middle = (inside + outside) / 2;
    if (isShown(colorOf(middle))) inside = middle;
    else outside = middle;
  }
  return colorOf(inside).map((value) =>
    Math.round(255 * srgbFromLinear(Math.min(Math.max(value, 0), 1))),
  );
}

/** The whole scale as a CSS gradient, from 0 to 1. @param {string} [direction] */
export function heatMapGradient(direction = 'to right') {
  const stops = Array.from({ length: 17 }, (_, i) => `rgb(${heatMapColor(i / 16).join(' ')})`);
  return `linear-gradient(${direction}, ${stops.join(', ')})`;
}
