import { element } from './element.js';

/** Over the picture: the quality that it was drawn with, and how far it has come. */
export class PictureBadge {
  /** @param {HTMLElement} root */
  constructor(root) {
    this.root = root;
    this.row = element('span', { class: 'row-name' });
    this.share = element('span', { class: 'share' });
    this.bar = element('progress', { max: 1, 'aria-label': 'How far the picture has come' });
    root.replaceChildren(this.row, this.share, this.bar);
  }

  /** @param {import('../net/frame_header.js').FrameHeader} header @param {string} rowName */
  show({ converged, convergence }, rowName) {
    this.root.hidden = false;
    this.root.classList.toggle('done', converged);
    this.row.textContent = rowName;
    this.share.textContent = converged ? 'done' : `${Math.floor(100 * convergence)} %`;
    this.bar.value = convergence;
  }
}
