const CLICK_PX = 4;
const TURN_RAD = Math.PI; // across the height of the image
const KEY_TURN_RAD_PER_S = 1.2;
const WHEEL_FACTOR = 1.0015;
const FAST = 4;

/** Which way a key walks: right, up, ahead. @type {Record<string, [number, number, number]>} */
const WALK_KEYS = {
  KeyW: [0, 0, 1],
  KeyS: [0, 0, -1],
  KeyA: [-1, 0, 0],
  KeyD: [1, 0, 0],
  KeyE: [0, 1, 0],
  KeyQ: [0, -1, 0],
};

/** Which way a key turns: yaw, pitch. @type {Record<string, [number, number]>} */
const TURN_KEYS = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/**
 * Moves the camera by mouse, touch and keys over the image. In orbit mode a drag turns about the
 * target, in fly mode about the eye. Keys work while the image has the focus.
 */
export class CameraInput {
  /**
   * @param {HTMLElement} stage
   * @param {import('./camera.js').Camera} camera
   * @param {{getMode: () => 'orbit' | 'fly', getSpeed: () => number, onClick: (x: number, y:
   *   number) => void}} options speed in metres a second; a click's position is in pixels of the
   *   stage
   */
  constructor(stage, camera, options) {
    this.stage = stage;
    this.camera = camera;
    this.options = options;
    /** @type {Map<number, {x: number, y: number}>} */
    this.pointers = new Map();
    /** @type {Set<string>} */
    this.keys = new Set();
    this.isFast = false;
    this.isClick = false;
    this.lastTick = 0;
    stage.addEventListener('pointerdown', (event) => this.#down(event));
    stage.addEventListener('pointermove', (event) => this.#move(event));
    stage.addEventListener('pointerup', (event) => this.#up(event));
    stage.addEventListener('pointercancel', (event) => this.pointers.delete(event.pointerId));
    stage.addEventListener('contextmenu', (event) => event.preventDefault());
    stage.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    stage.addEventListener('keydown', (event) => this.#keyDown(event));
    stage.addEventListener('keyup', (event) => this.keys.delete(event.code));
    stage.addEventListener('blur', () => this.keys.clear());
    window.addEventListener('blur', () => this.keys.clear());
  }

  #down(/** @type {PointerEvent} */ event) {
    this.stage.focus({ preventScroll: true });
    this.stage.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.isClick = this.pointers.size === 1 && event.button === 0;
    this.start = { x: event.clientX, y: event.clientY };
    event.preventDefault();
  }

  #move(/** @type {PointerEvent} */ event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    const now = { x: event.clientX, y: event.clientY };
    const start = this.start ?? now;
    if (this.isClick && Math.hypot(now.x - start.x, now.y - start.y) < CLICK_PX) return;
    this.isClick = false;
    const height = this.stage.clientHeight;
    const dx = (now.x - last.x) / height;
    const dy = (now.y - last.y) / height;
    if (this.pointers.size >= 2) this.#pinch(event.pointerId, last, now);
    else if (event.buttons & 6 || event.shiftKey) this.camera.pan(dx, dy);
    else if (this.options.getMode() === 'fly') this.camera.look(dx * TURN_RAD, -dy * TURN_RAD);
    else this.camera.orbit(dx * TURN_RAD, -dy * TURN_RAD);
    this.pointers.set(event.pointerId, now);
  }

  #pinch(
    /** @type {number} */ pointerId,
    /** @type {{x: number, y: number}} */ last,
    /** @type {{x: number, y: number}} */ now,
  ) {
    const other = [...this.pointers].find(([id]) => id !== pointerId)?.[1];
    if (!other) return;
    const before = Math.hypot(last.x - other.x, last.y - other.y);
    const after = Math.hypot(now.x - other.x, now.y - other.y);
    if (before > 1 && after > 1) this.camera.dolly(before / after);
    // Each of two fingers moves the midpoint by half.
    const height = 2 * this.stage.clientHeight;
    this.camera.pan((now.x - last.x) / height, (now.y - last.y) / height);
  }

  #up(/** @type {PointerEvent} */ event) {
    if (!this.pointers.delete(event.pointerId) || !this.isClick) return;
    this.isClick = false;
    const box = this.stage.getBoundingClientRect();
    this.options.onClick(event.clientX - box.left, event.clientY - box.top);
  }

  #wheel(/** @type {WheelEvent} */ event) {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    this.camera.dolly(WHEEL_FACTOR ** (event.deltaY * lines));
  }

  #keyDown(/** @type {KeyboardEvent} */ event) {
    this.isFast = event.shiftKey;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === '+' || event.key === '-') {
      this.camera.dolly(event.key === '+' ? 0.9 : 1 / 0.9);
      event.preventDefault();
    }
    if (!WALK_KEYS[event.code] && !TURN_KEYS[event.code]) return;
    event.preventDefault();
    const isIdle = this.keys.size === 0;
    this.keys.add(event.code);
    if (!isIdle) return;
    this.lastTick = performance.now();
    requestAnimationFrame(() => this.#tick());
  }

  #tick() {
    if (this.keys.size === 0) return;
    const now = performance.now();
    const seconds = Math.min((now - this.lastTick) / 1000, 0.1);
    this.lastTick = now;
    const step = this.options.getSpeed() * seconds * (this.isFast ? FAST : 1);
    const turn = KEY_TURN_RAD_PER_S * seconds * (this.isFast ? FAST : 1);
    for (const code of this.keys) {
      const walk = WALK_KEYS[code];
      const turning = TURN_KEYS[code];
      if (walk) this.camera.move([walk[0] * step, walk[1] * step, walk[2] * step]);
      else if (this.options.getMode() === 'fly')
        this.camera.look(turning[0] * turn, turning[1] * turn);
      else this.camera.orbit(turning[0] * turn, turning[1] * turn);
    }
    requestAnimationFrame(() => this.#tick());
  }
}
