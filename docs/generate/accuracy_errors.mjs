// Where an image errs most: windows of the error map with the largest mean.
import { heatMapColor } from '../../web_client/accuracy/heat_map.js';

const WINDOWS = 3;
const WINDOWS_ACROSS = 6; // a window is this part of the image's width and height
const MAX_STEP = 4; // pixels from a window to the next

const stepOf = (size) => Math.max(1, Math.min(MAX_STEP, size >> 2));

/**
 * Errors of 0 to 1 by the colours that heat maps paint them with.
 * @param {import('./png.mjs').Picture} map
 */
export function errorsOf({ rgb, width, height }) {
  const colors = Array.from({ length: 256 }, (_, i) => heatMapColor(i / 255));
  const known = new Map();
  const nearest = (r, g, b) => {
    let best = 0;
    let minDistance = Infinity;
    colors.forEach(([x, y, z], i) => {
      const distance = (x - r) ** 2 + (y - g) ** 2 + (z - b) ** 2;
      if (distance < minDistance) [best, minDistance] = [i, distance];
    });
    return best / 255;
  };
  return Float64Array.from({ length: width * height }, (_, i) => {
    const [r, g, b] = rgb.subarray(3 * i, 3 * i + 3);
    const key = (r << 16) | (g << 8) | b;
    if (!known.has(key)) known.set(key, nearest(r, g, b));
    return known.get(key);
  });
}

/** Sums over all rectangles from the top left corner, one wider and higher than the image. */
function sumTable(errors, width, height) {
  const sums = new Float64Array((width + 1) * (height + 1));
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++)
      sums[(y + 1) * (width + 1) + x + 1] =
        errors[y * width + x] +
        sums[y * (width + 1) + x + 1] +
        sums[(y + 1) * (width + 1) + x] -
        sums[y * (width + 1) + x];
  return sums;
}

/**
 * The windows that err most and do not overlap, worst first.
 * @param {import('./png.mjs').Picture} map
 * @returns {{ x: number, y: number, width: number, height: number, error: number }[]}
 */
export function worstWindows(map) {
  const size = {
    width: Math.max(1, Math.floor(map.width / WINDOWS_ACROSS)),
    height: Math.max(1, Math.floor(map.height / WINDOWS_ACROSS)),
  };
  const sums = sumTable(errorsOf(map), map.width, map.height);
  const at = (x, y) => sums[y * (map.width + 1) + x];
  const all = [];
  for (let y = 0; y + size.height <= map.height; y += stepOf(size.height))
    for (let x = 0; x + size.width <= map.width; x += stepOf(size.width)) {
      const sum =
        at(x + size.width, y + size.height) -
        at(x, y + size.height) -
        at(x + size.width, y) +
        at(x, y);
      all.push({ x, y, ...size, error: sum / (size.width * size.height) });
    }
  const chosen = [];
  for (const window of all.sort((a, b) => b.error - a.error)) {
    const overlaps = chosen.some(
      ({ x, y }) => Math.abs(x - window.x) < size.width && Math.abs(y - window.y) < size.height,
    );
    if (!overlaps) chosen.push(window);
    if (chosen.length === WINDOWS) break;
  }
  return chosen;
}
