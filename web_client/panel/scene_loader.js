import { element } from '../ui/element.js';

/** The choice of the scene, and loading another one. */
export class SceneLoader {
  /** @param {import('./app_context.js').AppContext} app */
  constructor(app) {
    this.app = app;
    this.select = element('select', { id: 'scene-source', 'aria-label': 'Scene' });
    this.button = element('button', { type: 'button', onclick: () => this.#load() }, 'Load');
    this.progress = element('progress', { hidden: true, 'aria-label': 'Loading the scene' });
    this.root = element('div', { class: 'loader' }, this.select, this.button, this.progress);
    this.source = '';
    this.select.addEventListener('change', () => this.#update());
  }

  /** @param {{source: string, description: string}[]} scenes of scene.list */
  fillList(scenes) {
    const options = scenes.map((scene) =>
      element(
        'option',
        { value: scene.source, title: scene.description },
        scene.source.replace(/^builtin:/, 'Built-in: '),
      ),
    );
    this.select.replaceChildren(...options);
    this.showSource(this.source);
  }

  /** @param {string} source of the scene that is shown */
  showSource(source) {
    this.source = source;
    const isListed = [...this.select.options].some((option) => option.value === source);
    if (!isListed && source) this.select.prepend(element('option', { value: source }, source));
    if (source) this.select.value = source;
    this.#update();
  }

  #update() {
    this.button.textContent = this.select.value === this.source ? 'Reload' : 'Load';
  }

  async #load() {
    const source = this.select.value;
    this.button.disabled = true;
    this.progress.hidden = false;
    try {
      await this.app.connection.call('scene.load', { source });
    } catch (error) {
      this.app.toasts.showError(/** @type {any} */ (error));
    }
    this.button.disabled = false;
    this.progress.hidden = true;
  }
}
