import { add, length, normalize, scale, subtract } from '../math/vector.js';
import { cameraAxes } from '../math/projection.js';

/** @typedef {import('../math/vector.js').Vector} Vector */

const STEEPEST_RAD = (89.5 / 180) * Math.PI;
const WORLD_UP = /** @type {Vector} */ ([0, 1, 0]);

/**
 * The client's camera: its pose, and how input moves it. Rotating it levels it: up becomes +Y.
 * Event: `changed`.
 */
export class Camera extends EventTarget {
  constructor() {
    super();
    /** @type {import('../math/projection.js').CameraPose} */
    this.pose = { eye: [0, 0, 5], target: [0, 0, 0], up: [0, 1, 0], fov_y_rad: Math.PI / 4 };
  }

  /** @param {Partial<import('../math/projection.js').CameraPose>} pose */
  set(pose) {
    this.pose = { ...this.pose, ...pose };
    this.dispatchEvent(new Event('changed'));
  }

  get distance() {
    return length(subtract(this.pose.target, this.pose.eye));
  }

  /** Rotates about the target. @param {number} yawRad @param {number} pitchRad */
  orbit(yawRad, pitchRad) {
    const direction = this.#turned(yawRad, pitchRad);
    const eye = subtract(this.pose.target, scale(direction, this.distance));
    this.set({ eye, up: WORLD_UP });
  }

  /** Rotates about the eye. @param {number} yawRad @param {number} pitchRad */
  look(yawRad, pitchRad) {
    const direction = this.#turned(yawRad, pitchRad);
    const target = add(this.pose.eye, scale(direction, this.distance));
    this.set({ target, up: WORLD_UP });
  }

  /**
   * Moves across the image so that the target's plane follows the hand.
   * @param {number} x of the image's height, right @param {number} y down
   */
  pan(x, y) {
    const { right, up } = cameraAxes(this.pose);
    const height = 2 * Math.tan(this.pose.fov_y_rad / 2) * this.distance;
    this.#shift(add(scale(right, -x * height), scale(up, y * height)));
  }

  /** Moves nearer (factor below 1) or away from the target. @param {number} factor */
  dolly(factor) {
    const offset = subtract(this.pose.eye, this.pose.target);
    const distance = Math.min(Math.max(this.distance * factor, 1e-3), 1e6);
    this.set({ eye: add(this.pose.target, scale(normalize(offset), distance)) });
  }

  /** Walks: metres to the right, up in the world and ahead. @param {Vector} step */
  move([x, y, z]) {
    const { right, forward } = cameraAxes(this.pose);
    this.#shift(add(add(scale(right, x), scale(WORLD_UP, y)), scale(forward, z)));
  }

  /** Looks at a sphere from the same side, so that it fills the image. */
  frame(/** @type {Vector} */ center, /** @type {number} */ radius, /** @type {number} */ aspect) {
    const halfY = this.pose.fov_y_rad / 2;
    const half = Math.min(halfY, Math.atan(Math.tan(halfY) * aspect));
    const { forward } = cameraAxes(this.pose);
    const distance = radius / Math.sin(half);
    this.set({ eye: subtract(center, scale(forward, distance)), target: center });
  }

  #shift(/** @type {Vector} */ step) {
    this.set({ eye: add(this.pose.eye, step), target: add(this.pose.target, step) });
  }

  #turned(/** @type {number} */ yawRad, /** @type {number} */ pitchRad) {
    const { forward } = cameraAxes(this.pose);
    const yaw = Math.atan2(forward[0], -forward[2]) + yawRad;
    const wanted = Math.asin(Math.max(-1, Math.min(1, forward[1]))) + pitchRad;
    const pitch = Math.max(-STEEPEST_RAD, Math.min(STEEPEST_RAD, wanted));
    return /** @type {Vector} */ ([
      Math.sin(yaw) * Math.cos(pitch),
      Math.sin(pitch),
      -Math.cos(yaw) * Math.cos(pitch),
    ]);
  }
}
