import {
  closestOnAxis,
  cameraAxes,
  meetPlane,
  projectPoint,
  rayThrough,
} from '../math/projection.js';
import { add, scale, subtract } from '../math/vector.js';

/** @typedef {import('../math/vector.js').Vector} Vector */
/** @typedef {import('../math/projection.js').CameraPose} CameraPose */

const SVG = 'http://www.w3.org/2000/svg';
const HANDLE_PX = 84;
const MIDDLE_PX = 17;
const AXES = /** @type {{name: string, direction: Vector}[]} */ ([
  { name: 'x', direction: [1, 0, 0] },
  { name: 'y', direction: [0, 1, 0] },
  { name: 'z', direction: [0, 0, 1] },
]);

/** Makes an SVG element. @param {string} tag @param {Record<string, string | number>} attributes */
function element(tag, attributes) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  return made;
}

/**
 * Draws over the image: an icon for each light and, at the selected thing, a handle with three axes
 * and a square that moves in the plane of the screen. Everything follows the camera of the shown
 * image.
 *
 * Events: `light` (detail: id of a clicked light), `drag` (detail: the handle's new world position,
 * and `isLast`).
 */
export class Overlay extends EventTarget {
  /** @param {SVGSVGElement} svg */
  constructor(svg) {
    super();
    this.svg = svg;
    this.lightLayer = svg.appendChild(element('g', {}));
    this.handleLayer = svg.appendChild(element('g', {}));
    /** @type {CameraPose | null} */
    this.pose = null;
    /** Aspect of the shown image, which is stretched slightly to fill the stage. */
    this.aspect = 16 / 9;
    /**
     * @type {{id: number, name: string, type: string, enabled: boolean, color: number[], position:
     *   Vector}[]}
     */
    this.lights = [];
    /** @type {number | null} */
    this.chosenLight = null;
    /** @type {Vector | null} */
    this.handle = null;
    /** @type {{axis: Vector | null, from: Vector, grabbed: Vector | number} | null} */
    this.dragging = null;
    /** @type {Map<number, SVGElement>} */
    this.lightIcons = new Map();
    this.handleParts = this.#makeHandle();
  }

  /** Positions everything anew. Cheap: a few attributes for each light. */
  draw() {
    if (!this.pose) return;
    this.#drawLights();
    this.#drawHandle();
  }

  #project(/** @type {Vector} */ point) {
    const position = this.pose && projectPoint(this.pose, this.aspect, point);
    if (!position) return null;
    return {
      x: position.x * this.svg.clientWidth,
      y: position.y * this.svg.clientHeight,
      depth: position.depth,
    };
  }

  #drawLights() {
    const ids = new Set(this.lights.map((light) => light.id));
    for (const [id, icon] of this.lightIcons) {
      if (ids.has(id)) continue;
      icon.remove();
      this.lightIcons.delete(id);
    }
    for (const light of this.lights) {
      let icon = this.lightIcons.get(light.id);
      if (!icon) {
        icon = this.#makeLight(light.id);
        this.lightIcons.set(light.id, icon);
      }
      const position = this.#project(light.position);
      icon.style.display = position ? '' : 'none';
      if (position) icon.setAttribute('transform', `translate(${position.x} ${position.y})`);
      icon.classList.toggle('chosen', light.id === this.chosenLight);
      icon.classList.toggle('off', !light.enabled);
      icon.setAttribute('aria-label', `Select light ${light.name || light.id}`);
    }
  }

  #makeLight(/** @type {number} */ id) {
    const icon = /** @type {SVGElement} */ (
      element('g', { class: 'light-icon', role: 'button', tabindex: 0 })
    );
    icon.append(
      element('circle', { class: 'hit', r: 16 }),
      element('circle', { class: 'disc', r: 10 }),
      element('circle', { class: 'bulb', r: 3.5 }),
      element('path', {
        class: 'rays',
        d:
          'M0-8v2M0 6v2M-8 0h2M6 0h2M-5.6-5.6l1.4 1.4M4.2 4.2l1.4 1.4' +
          'M-5.6 5.6l1.4-1.4M4.2-4.2l1.4-1.4',
      }),
    );
    const choose = () => this.dispatchEvent(new CustomEvent('light', { detail: id }));
    icon.addEventListener('pointerdown', (event) => {
      choose();
      const light = this.lights.find((other) => other.id === id);
      if (light) this.#startDrag(event, null, light.position);
    });
    icon.addEventListener('keydown', (event) => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      choose();
    });
    this.lightLayer.append(icon);
    return icon;
  }

  #makeHandle() {
    const axes = AXES.map(({ name, direction }) => {
      const group = element('g', { class: `axis axis-${name}` });
      const hit = element('line', { class: 'hit' });
      const line = element('line', { class: 'line' });
      const tip = element('circle', { class: 'tip', r: 6 });
      group.append(hit, line, tip);
      group.addEventListener('pointerdown', (event) => {
        if (this.handle)
          this.#startDrag(/** @type {PointerEvent} */ (event), direction, this.handle);
      });
      this.handleLayer.append(group);
      return { direction, group, hit, line, tip };
    });
    const plane = element('rect', { class: 'plane', x: -8, y: -8, width: 16, height: 16, rx: 3 });
    plane.addEventListener('pointerdown', (event) => {
      if (this.handle) this.#startDrag(/** @type {PointerEvent} */ (event), null, this.handle);
    });
    this.handleLayer.append(plane);
    return { axes, plane };
  }

  #drawHandle() {
    const origin = this.handle && this.#project(this.handle);
    this.handleLayer.style.display = origin ? '' : 'none';
    // At a light, its icon is the centre of the handle.
    this.handleLayer.classList.toggle('at-light', this.chosenLight !== null);
    if (!origin || !this.pose || !this.handle) return;
    // Metres at that depth that make HANDLE_PX on the screen.
    const metres =
      (2 * Math.tan(this.pose.fov_y_rad / 2) * origin.depth * HANDLE_PX) / this.svg.clientHeight;
    for (const { direction, group, hit, line, tip } of this.handleParts.axes) {
      const end = this.#project(add(this.handle, scale(direction, metres)));
      // An axis that points at the eye cannot be dragged.
      const long = end ? Math.hypot(end.x - origin.x, end.y - origin.y) : 0;
      const isShort = long < 2 * MIDDLE_PX;
      /** @type {SVGElement} */ (group).style.display = isShort ? 'none' : '';
      if (!end || isShort) continue;
      // The centre belongs to the square, or to the light's icon.
      const begin = MIDDLE_PX / long;
      for (const part of [hit, line]) {
        part.setAttribute('x1', String(origin.x + (end.x - origin.x) * begin));
        part.setAttribute('y1', String(origin.y + (end.y - origin.y) * begin));
        part.setAttribute('x2', String(end.x));
        part.setAttribute('y2', String(end.y));
      }
      tip.setAttribute('cx', String(end.x));
      tip.setAttribute('cy', String(end.y));
    }
    this.handleParts.plane.setAttribute('transform', `translate(${origin.x} ${origin.y})`);
  }

  #rayOf(/** @type {PointerEvent} */ event) {
    const box = this.svg.getBoundingClientRect();
    const x = (event.clientX - box.left) / box.width;
    const y = (event.clientY - box.top) / box.height;
    return rayThrough(/** @type {CameraPose} */ (this.pose), this.aspect, x, y);
  }

  /** The dragged position: along the axis, or in the plane that faces the eye. */
  #grab(
    /** @type {PointerEvent} */ event,
    /** @type {Vector | null} */ axis,
    /** @type {Vector} */ from,
  ) {
    const ray = this.#rayOf(event);
    if (axis) return closestOnAxis(ray, from, axis);
    return meetPlane(ray, from, cameraAxes(/** @type {CameraPose} */ (this.pose)).forward);
  }

  #startDrag(
    /** @type {PointerEvent} */ event,
    /** @type {Vector | null} */ axis,
    /** @type {Vector} */ from,
  ) {
    if (event.button !== 0 || !this.pose) return;
    event.stopPropagation();
    event.preventDefault();
    const grabbed = this.#grab(event, axis, from);
    if (grabbed === null) return;
    this.dragging = { axis, from, grabbed };
    this.hasMoved = false;
    const target = /** @type {SVGElement} */ (event.currentTarget);
    target.setPointerCapture(event.pointerId);
    const move = (/** @type {Event} */ moved) =>
      this.#drag(/** @type {PointerEvent} */ (moved), false);
    const end = (/** @type {Event} */ ended) => {
      target.removeEventListener('pointermove', move);
      if (this.hasMoved) this.#drag(/** @type {PointerEvent} */ (ended), true);
      this.dragging = null;
    };
    target.addEventListener('pointermove', move);
    target.addEventListener('lostpointercapture', end, { once: true });
  }

  #drag(/** @type {PointerEvent} */ event, /** @type {boolean} */ isLast) {
    if (!this.dragging) return;
    const { axis, from, grabbed } = this.dragging;
    const now = this.#grab(event, axis, from);
    if (now === null) return;
    this.hasMoved = true;
    const shift = axis
      ? scale(axis, /** @type {number} */ (now) - /** @type {number} */ (grabbed))
      : subtract(/** @type {Vector} */ (now), /** @type {Vector} */ (grabbed));
    const position = add(from, shift);
    this.dispatchEvent(new CustomEvent('drag', { detail: { position, isLast } }));
  }
}
