import { cameraAxes } from '../math/projection.js';
import { dot, length, subtract } from '../math/vector.js';

/** @typedef {import('../math/projection.js').CameraPose} CameraPose */

// The measured pose went through single precision. A larger difference would move a pixel of 640.
const MAX_SHIFT = 1e-4; // of the distance to the target
const MAX_TURN_RAD = 2e-4;
const MAX_ASPECT = 0.02; // sizes are rounded to whole pixels

/** The cosine of the largest rotation differs from 1 by its square. */
const isSameDirection = (/** @type {any} */ a, /** @type {any} */ b) =>
  1 - dot(a, b) <= MAX_TURN_RAD ** 2 / 2 + 1e-12;

/** Whether two cameras see the same. @param {CameraPose} a @param {CameraPose} b */
export function isSamePose(a, b) {
  const [axesA, axesB] = [cameraAxes(a), cameraAxes(b)];
  return (
    length(subtract(a.eye, b.eye)) <= MAX_SHIFT * length(subtract(b.target, b.eye)) &&
    isSameDirection(axesA.forward, axesB.forward) &&
    isSameDirection(axesA.up, axesB.up) &&
    Math.abs(a.fov_y_rad - b.fov_y_rad) <= MAX_TURN_RAD
  );
}

/**
 * Whether images of two sizes show the same part of the world.
 * @param {number} a width over height
 * @param {number} b
 */
export const isSameAspect = (a, b) => Math.abs(a / b - 1) <= MAX_ASPECT;
