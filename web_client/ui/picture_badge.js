import { element } from './element.js';

/** Samples and noise of a reference image, as in "64 samples, noise 3.1 %". */
function describeReference(/** @type {number} */ samples, /** @type {number} */ noise) {
  const count = `${samples} sample${samples === 1 ? '' : 's'}`;
  return noise > 0 ? `${count}, noise ${(100 * noise).toPrecision(2)} %` : count;
}

/** Over the image: the quality it was drawn with, and its convergence. */
export class PictureBadge {
  /** @param {HTMLElement} root */
  constructor(root) {
    this.root = root;
    this.row = element('span', { class: 'row-name' });
    this.fraction = element('span', { class: 'fraction' });
    this.bar = element('progress', { max: 1, 'aria-label': 'How far the image has come' });
    root.replaceChildren(this.row, this.fraction, this.bar);
  }

  /** @param {import('../net/frame_header.js').FrameHeader} header @param {string} rowName */
  show({ converged, convergence, referenceSamples, referenceNoise }, rowName) {
    this.root.hidden = false;
    this.root.classList.toggle('done', converged);
    this.row.textContent =
      referenceSamples > 0 ? describeReference(referenceSamples, referenceNoise) : rowName;
    this.fraction.textContent = converged ? 'done' : `${Math.floor(100 * convergence)} %`;
    this.bar.value = convergence;
  }
}
