import { isSameAspect, isSamePose } from '../accuracy/same_view.js';
import { element } from '../ui/element.js';

const MODES = [
  { name: 'none', title: 'Picture alone' },
  { name: 'split', title: 'Split' },
  { name: 'error', title: 'Error map' },
];

/**
 * What is laid over the image: nothing, the reference image beside it, or the error map of a
 * configuration.
 */
export class AccuracyCompare {
  /** @param {HTMLElement} root @param {import('./app_context.js').AppContext} app */
  constructor(root, app) {
    this.app = app;
    this.mode = 'none';
    this.inputs = MODES.map(({ name }) =>
      element('input', {
        type: 'radio',
        name: 'comparison',
        value: name,
        checked: name === 'none',
        onchange: () => this.#choose(name),
      }),
    );
    const labels = MODES.map(({ title }, i) =>
      element('label', {}, this.inputs[i], element('span', {}, title)),
    );
    this.text = element('p', { class: 'hint' });
    root.append(
      element(
        'div',
        { class: 'segments', role: 'radiogroup', 'aria-label': 'Over the image' },
        ...labels,
      ),
      this.text,
    );
    app.comparison.addEventListener('return', () => this.#goBack());
    app.camera.addEventListener('changed', () => this.refresh());
    app.picture.addEventListener('presented', () => this.#checkShape());
    this.refresh();
  }

  /** The view as it was measured; null until there are results. */
  get measuredView() {
    return this.app.measurement.results?.setup.scene ?? null;
  }

  refresh() {
    const { measurement } = this.app;
    const hasReference = measurement.hasReference && this.measuredView !== null;
    const shown = this.#errorConfiguration();
    this.inputs[1].disabled = !hasReference;
    this.inputs[2].disabled = !shown;
    if (this.inputs.find((input) => input.value === this.mode)?.disabled) this.mode = 'none';
    for (const input of this.inputs) input.checked = input.value === this.mode;
    this.text.textContent = this.#describe(hasReference, shown);
    this.app.comparison.show({
      mode: /** @type {any} */ (this.mode),
      referenceUrl: hasReference ? measurement.url('reference.png') : '',
      errorUrl: shown ? measurement.url(shown.pictures.error) : '',
      errorName: shown?.name ?? '',
      obstacle: this.mode === 'none' ? '' : this.#obstacle(),
    });
  }

  /**
   * Whose errors are shown: those of the configuration that draws, or of the client's own settings.
   */
  #errorConfiguration() {
    const { measurement, view } = this.app;
    return (
      measurement.configuration(view.configuration || 'live') ??
      measurement.configurations[0] ??
      null
    );
  }

  /**
   * Why the measured images do not fit over the shown one; "" if they do.
   * @returns {'' | 'camera' | 'shape'}
   */
  #obstacle() {
    const view = this.measuredView;
    const { canvas } = this.app.picture;
    if (!view || !isSamePose(this.app.camera.pose, view)) return 'camera';
    this.shape = canvas.width / canvas.height;
    return isSameAspect(this.shape, view.width / view.height) ? '' : 'shape';
  }

  /** The stage may have another shape now. */
  #checkShape() {
    const { canvas } = this.app.picture;
    if (this.mode !== 'none' && this.shape !== canvas.width / canvas.height) this.refresh();
  }

  #describe(/** @type {boolean} */ hasReference, /** @type {any} */ shown) {
    if (!hasReference)
      return this.app.measurement.isRunning
        ? 'The reference image can be laid beside the image once the first setting has been ' +
            'measured.'
        : 'Measure the view first: then the reference image can be laid beside the image.';
    if (this.mode === 'split')
      return (
        'Drag the line over the image, or move it by the arrow keys: live on its left, ' +
        'reference image on its right.'
      );
    if (this.mode === 'error') return `Where the final image of ${shown.name} errs, by LDR-FLIP.`;
    return '';
  }

  #choose(/** @type {string} */ mode) {
    this.mode = mode;
    this.refresh();
  }

  #goBack() {
    const { eye, target, up, fov_y_rad } = this.measuredView;
    this.app.camera.set({ eye, target, up, fov_y_rad });
  }
}
