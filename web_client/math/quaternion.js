// Unit quaternions as [x, y, z, w]. Small functions of one type: they share a file.

const DEGREES = 180 / Math.PI;

/**
 * Rotates a vector.
 * @param {number[]} q @param {import('./vector.js').Vector} v
 * @returns {import('./vector.js').Vector}
 */
export function rotate(q, v) {
  const [x, y, z, w] = q;
  const tx = 2 * (y * v[2] - z * v[1]);
  const ty = 2 * (z * v[0] - x * v[2]);
  const tz = 2 * (x * v[1] - y * v[0]);
  return [
    v[0] + w * tx + y * tz - z * ty,
    v[1] + w * ty + z * tx - x * tz,
    v[2] + w * tz + x * ty - y * tx,
  ];
}

/**
 * Rotates about X, then Y, then Z (fixed axes), as people type them.
 * @param {number[]} degrees
 * @returns {number[]}
 */
export function fromEulerDegrees([dx, dy, dz]) {
  const [cx, cy, cz] = [dx, dy, dz].map((d) => Math.cos(d / DEGREES / 2));
  const [sx, sy, sz] = [dx, dy, dz].map((d) => Math.sin(d / DEGREES / 2));
  return [
    sx * cy * cz - cx * sy * sz,
    cx * sy * cz + sx * cy * sz,
    cx * cy * sz - sx * sy * cz,
    cx * cy * cz + sx * sy * sz,
  ];
}

/**
 * The inverse of fromEulerDegrees: of the two solutions, the smaller angles.
 * @param {number[]} q
 * @returns {number[]}
 */
export function toEulerDegrees([x, y, z, w]) {
  const sine = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  // Straight along Y, X and Z rotate about one axis: X takes all of the angle.
  if (Math.abs(sine) > 0.99999)
    return [2 * Math.atan2(x, w) * DEGREES, Math.sign(sine) * 90, 0];
  const ex = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) * DEGREES;
  const ey = Math.asin(sine) * DEGREES;
  const ez = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) * DEGREES;
  const away = (/** @type {number} */ angle) => (angle < 0 ? -180 : 180);
  const other = [ex - away(ex), away(ey) - ey, ez - away(ez)];
  const size = (/** @type {number[]} */ angles) => angles.reduce((sum, a) => sum + Math.abs(a), 0);
  return size(other) + 1e-6 < size([ex, ey, ez]) ? other : [ex, ey, ez];
}
