// Between the world and the image. Positions in the image are 0 to 1, from the top left corner.
import { add, cross, dot, normalize, scale, subtract } from './vector.js';

/** @typedef {import('./vector.js').Vector} Vector */
/** @typedef {{eye: Vector, target: Vector, up: Vector, fov_y_rad: number}} CameraPose */
/** @typedef {{origin: Vector, direction: Vector}} Ray */

/** The camera's axes in the world, of unit length. @param {CameraPose} camera */
export function cameraAxes(camera) {
  const forward = normalize(subtract(camera.target, camera.eye));
  const right = normalize(cross(forward, camera.up), [1, 0, 0]);
  return { right, up: cross(right, forward), forward };
}

/**
 * Where a world point is in the image, and its depth along the view axis in metres; null behind
 * the eye.
 * @param {CameraPose} camera @param {number} aspect width over height @param {Vector} point
 * @returns {{x: number, y: number, depth: number} | null}
 */
export function projectPoint(camera, aspect, point) {
  const { right, up, forward } = cameraAxes(camera);
  const offset = subtract(point, camera.eye);
  const depth = dot(offset, forward);
  if (depth <= 1e-6) return null;
  const half = Math.tan(camera.fov_y_rad / 2) * depth;
  return {
    x: 0.5 + dot(offset, right) / (2 * half * aspect),
    y: 0.5 - dot(offset, up) / (2 * half),
    depth,
  };
}

/**
 * The ray from the eye through a position of the image.
 * @param {CameraPose} camera @param {number} aspect @param {number} x @param {number} y
 * @returns {Ray}
 */
export function rayThrough(camera, aspect, x, y) {
  const { right, up, forward } = cameraAxes(camera);
  const half = Math.tan(camera.fov_y_rad / 2);
  const across = scale(right, (2 * x - 1) * half * aspect);
  return {
    origin: camera.eye,
    direction: normalize(add(add(forward, across), scale(up, (1 - 2 * y) * half))),
  };
}

/**
 * How far along an axis (in units of `axis`) the ray comes closest to it; null if they are
 * parallel.
 * @param {Ray} ray @param {Vector} origin @param {Vector} axis of unit length
 */
export function closestOnAxis(ray, origin, axis) {
  const along = dot(ray.direction, axis);
  const slant = 1 - along * along;
  if (slant < 1e-4) return null;
  const offset = subtract(ray.origin, origin);
  return (dot(offset, axis) - along * dot(offset, ray.direction)) / slant;
}

/**
 * Where the ray meets a plane; null if it does not, or behind its origin.
 * @param {Ray} ray @param {Vector} point of the plane @param {Vector} normal
 * @returns {Vector | null}
 */
export function meetPlane(ray, point, normal) {
  const slope = dot(ray.direction, normal);
  if (Math.abs(slope) < 1e-6) return null;
  const distance = dot(subtract(point, ray.origin), normal) / slope;
  return distance > 0 ? add(ray.origin, scale(ray.direction, distance)) : null;
}
