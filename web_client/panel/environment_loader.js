import { element } from '../ui/element.js';

/** The choice of an environment image among those of the server; hidden if it has none. */
export class EnvironmentLoader {
  /** @param {import('./app_context.js').AppContext} app */
  constructor(app) {
    this.app = app;
    this.select = element('select', { id: 'environment-image', 'aria-label': 'Environment image' });
    this.button = element('button', { type: 'button', onclick: () => this.#load() }, 'Load');
    this.progress = element('progress', { hidden: true, 'aria-label': 'Loading the environment' });
    this.root = element(
      'div',
      { class: 'loader', hidden: true },
      this.select,
      this.button,
      this.progress,
    );
    this.select.addEventListener('change', () => this.#update());
  }

  /** @param {{name: string}[]} environments of scene.list */
  fillList(environments) {
    this.root.hidden = environments.length === 0;
    this.select.replaceChildren(
      ...environments.map(({ name }) => element('option', { value: name }, name)),
    );
    this.refresh();
  }

  /** Selects the image that is shown. */
  refresh() {
    const { image } = this;
    if ([...this.select.options].some((option) => option.value === image))
      this.select.value = image;
    this.#update();
  }

  get image() {
    return this.app.document.data?.environment.image ?? '';
  }

  #update() {
    this.button.textContent = this.select.value === this.image ? 'Reload' : 'Load';
  }

  async #load() {
    this.button.disabled = true;
    this.progress.hidden = false;
    const result = await this.app.editor.loadEnvironment(this.select.value);
    for (const warning of result?.warnings ?? []) this.app.toasts.show('warn', warning);
    this.button.disabled = false;
    this.progress.hidden = true;
  }
}
