/** @typedef {import('../net/frame_header.js').FrameHeader} FrameHeader */
/** @typedef {{header: FrameHeader, bytes: ArrayBuffer}} Frame */

const MAX_DECODES = 2;

/**
 * Shows frames on a canvas. Decodes in a worker, at most two at a time; of the frames that wait,
 * only the newest is kept.
 *
 * Events: `presented` (detail: the header and, as `decodeMs`, the time from arrival to canvas) and
 * `skipped` (detail: the header of a frame that is broken or came late).
 */
export class Picture extends EventTarget {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    super();
    this.canvas = canvas;
    this.context = /** @type {ImageBitmapRenderingContext} */ (canvas.getContext('bitmaprenderer'));
    this.worker = new Worker(new URL('./decode_worker.js', import.meta.url), { type: 'module' });
    this.worker.onmessage = (event) => this.#decoded(event.data);
    /** @type {Map<number, {header: FrameHeader, arrivedAt: number}>} */
    this.decodes = new Map();
    /** @type {Frame | null} */
    this.waiting = null;
    this.newestShown = 0;
    this.nextDecode = 1;
    /** Names of the enum `view.codec`. @type {string[]} */
    this.codecs = [];
  }

  /** @param {Frame} frame */
  show(frame) {
    if (this.decodes.size >= MAX_DECODES) {
      this.waiting = frame;
      return;
    }
    const id = this.nextDecode++;
    this.decodes.set(id, { header: frame.header, arrivedAt: performance.now() });
    const type = `image/${this.codecs[frame.header.codec]}`;
    this.worker.postMessage({ id, bytes: frame.bytes, type }, [frame.bytes]);
  }

  /** Frame numbers start over with each connection. @param {string[]} codecs of its server */
  reset(codecs) {
    this.codecs = codecs;
    this.decodes.clear();
    this.waiting = null;
    this.newestShown = 0;
  }

  #decoded(/** @type {{id: number, bitmap: ImageBitmap | null}} */ { id, bitmap }) {
    const decode = this.decodes.get(id);
    this.decodes.delete(id);
    if (decode && bitmap && decode.header.frameId > this.newestShown) this.#present(decode, bitmap);
    else {
      bitmap?.close();
      if (decode) this.dispatchEvent(new CustomEvent('skipped', { detail: decode }));
    }
    if (!this.waiting) return;
    const next = this.waiting;
    this.waiting = null;
    this.show(next);
  }

  #present(
    /** @type {{header: FrameHeader, arrivedAt: number}} */ { header, arrivedAt },
    /** @type {ImageBitmap} */ bitmap,
  ) {
    this.newestShown = header.frameId;
    if (this.canvas.width !== header.width || this.canvas.height !== header.height) {
      this.canvas.width = header.width;
      this.canvas.height = header.height;
    }
    this.context.transferFromImageBitmap(bitmap); // takes the bitmap and frees it
    const decodeMs = performance.now() - arrivedAt;
    this.dispatchEvent(new CustomEvent('presented', { detail: { header, decodeMs } }));
  }
}
