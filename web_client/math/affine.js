// Placements of nodes: three columns and an offset, [x axis, y axis, z axis, origin].
import { add, cross, dot, scale } from './vector.js';
import { rotate } from './quaternion.js';

/** @typedef {import('./vector.js').Vector} Vector */
/** @typedef {[Vector, Vector, Vector, Vector]} Affine */

/** @type {Affine} */
export const IDENTITY = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]];

/** @param {{translation: Vector, rotation: number[], scale: Vector}} node @returns {Affine} */
export const parentFromNode = (node) => [
  rotate(node.rotation, [node.scale[0], 0, 0]),
  rotate(node.rotation, [0, node.scale[1], 0]),
  rotate(node.rotation, [0, 0, node.scale[2]]),
  node.translation,
];

/** Rotates and scales a direction. @param {Affine} m @param {Vector} v @returns {Vector} */
export const mapDirection = (m, v) =>
  add(add(scale(m[0], v[0]), scale(m[1], v[1])), scale(m[2], v[2]));

/** @param {Affine} m @param {Vector} point @returns {Vector} */
export const mapPoint = (m, point) => add(mapDirection(m, point), m[3]);

/** `b` first, then `a`. @param {Affine} a @param {Affine} b @returns {Affine} */
export const multiply = (a, b) => [
  mapDirection(a, b[0]),
  mapDirection(a, b[1]),
  mapDirection(a, b[2]),
  mapPoint(a, b[3]),
];

/** The inverse of mapDirection; null for a singular map. @param {Affine} m @param {Vector} v */
export function unmapDirection(m, v) {
  const [x, y, z] = m;
  const volume = dot(x, cross(y, z));
  if (Math.abs(volume) < 1e-15) return null;
  return /** @type {Vector} */ ([
    dot(v, cross(y, z)) / volume,
    dot(v, cross(z, x)) / volume,
    dot(v, cross(x, y)) / volume,
  ]);
}
