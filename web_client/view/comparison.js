import { heatMapGradient } from '../accuracy/heat_map.js';
import { element } from '../ui/element.js';

const STEP = 0.02;
const LARGE_STEP = 0.1;

const OBSTACLES = {
  camera: 'The camera is not where the image was measured.',
  shape: 'The image has another shape than the measured one. Measure again to compare.',
};

/**
 * @typedef {object} ComparisonState
 * @property {'none' | 'split' | 'error'} mode
 * @property {string} referenceUrl
 * @property {string} errorUrl
 * @property {string} errorName whose errors they are
 * @property {'' | 'camera' | 'shape'} obstacle why measured images do not fit over the shown one
 */

/**
 * Lies over the image: the reference image to the right of a movable line, or an error map with its
 * scale. Where they do not fit it says so. Event: `return`, to go back to the measured view.
 */
export class Comparison extends EventTarget {
  /**
   * @param {HTMLElement} pictures below the handles of the scene
   * @param {HTMLElement} controls above them
   */
  constructor(pictures, controls) {
    super();
    this.pictures = pictures;
    this.controls = controls;
    /** Fraction of the image that is live, from the left. */
    this.fraction = 0.5;
    this.reference = element('img', { alt: 'The reference image', draggable: 'false' });
    this.error = element('img', { alt: '', draggable: 'false' });
    pictures.append(this.reference, this.error);
    this.divider = this.#makeDivider();
    this.legend = makeLegend();
    this.hint = element('span', {});
    this.goBack = element(
      'button',
      { type: 'button', onclick: () => this.dispatchEvent(new Event('return')) },
      'Back to the measured view',
    );
    this.obstacle = element('div', { class: 'stage-hint', role: 'status' }, this.hint, this.goBack);
    controls.append(this.divider, this.legend, this.obstacle);
    this.#move(this.fraction);
  }

  /** @param {ComparisonState} state */
  show({ mode, referenceUrl, errorUrl, errorName, obstacle }) {
    const fits = obstacle === '';
    this.controls.hidden = this.pictures.hidden = mode === 'none';
    this.reference.hidden = this.divider.hidden = !(mode === 'split' && fits);
    this.error.hidden = this.legend.hidden = !(mode === 'error' && fits);
    this.obstacle.hidden = fits;
    this.goBack.hidden = obstacle !== 'camera';
    this.hint.textContent = obstacle ? OBSTACLES[obstacle] : '';
    // Images are loaded when they are first shown.
    if (mode === 'split') setSource(this.reference, referenceUrl);
    if (mode === 'error') {
      setSource(this.error, errorUrl);
      this.error.alt = `Where ${errorName} errs`;
    }
  }

  #makeDivider() {
    const divider = element(
      'div',
      {
        class: 'divider',
        role: 'slider',
        tabindex: 0,
        'aria-label': 'Line between live image and reference image',
        'aria-valuemin': 0,
        'aria-valuemax': 100,
        'aria-orientation': 'horizontal',
      },
      element('span', { class: 'side live', 'aria-hidden': 'true' }, 'live'),
      element('span', { class: 'side reference', 'aria-hidden': 'true' }, 'reference'),
      element('span', { class: 'knob', 'aria-hidden': 'true' }, '‹ ›'),
    );
    divider.addEventListener('pointerdown', (/** @type {PointerEvent} */ event) => {
      divider.setPointerCapture(event.pointerId);
      divider.focus();
      event.preventDefault();
    });
    divider.addEventListener('pointermove', (/** @type {PointerEvent} */ event) => {
      if (!divider.hasPointerCapture(event.pointerId)) return;
      const { left, width } = this.controls.getBoundingClientRect();
      this.#move((event.clientX - left) / width);
    });
    divider.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => this.#key(event));
    return divider;
  }

  #key(/** @type {KeyboardEvent} */ event) {
    const { fraction } = this;
    const target = {
      ArrowLeft: fraction - STEP,
      ArrowDown: fraction - STEP,
      ArrowRight: fraction + STEP,
      ArrowUp: fraction + STEP,
      PageDown: fraction - LARGE_STEP,
      PageUp: fraction + LARGE_STEP,
      Home: 0,
      End: 1,
    }[event.key];
    if (target === undefined) return;
    event.preventDefault();
    this.#move(target);
  }

  #move(/** @type {number} */ fraction) {
    this.fraction = Math.min(Math.max(fraction, 0), 1);
    const percent = Math.round(100 * this.fraction);
    this.reference.style.clipPath = `inset(0 0 0 ${100 * this.fraction}%)`;
    this.divider.style.left = `${100 * this.fraction}%`;
    this.divider.setAttribute('aria-valuenow', String(percent));
    this.divider.setAttribute('aria-valuetext', `${percent} % live, ${100 - percent} % reference`);
  }
}

function setSource(/** @type {HTMLImageElement} */ picture, /** @type {string} */ url) {
  if (url && picture.src !== url) picture.src = url;
}

/** The scale of the error map. */
function makeLegend() {
  const scale = element('span', { class: 'scale', style: `background:${heatMapGradient()}` });
  const ends = element(
    'span',
    { class: 'ends' },
    ...['0', '0.5', '1'].map((text) => element('span', {}, text)),
  );
  return element(
    'div',
    {
      class: 'heat-legend',
      role: 'img',
      'aria-label':
        'Scale of the error map: LDR-FLIP from 0, black, by violet, red and orange to 1, ' +
        'pale yellow',
    },
    element('span', {}, 'LDR-FLIP: 0 as the reference image, 1 as wrong as can be'),
    scale,
    ends,
  );
}
