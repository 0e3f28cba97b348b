import { element } from '../ui/element.js';
import { icon } from '../ui/icon.js';
import { srgbFromLinear } from '../math/color.js';
import { EnvironmentLoader } from './environment_loader.js';
import { addParameterControls } from './parameter_controls.js';
import { wordsOf } from './labels.js';
import { isGiSetting } from './render_tab.js';
import { makeSection } from './sections.js';

/** @typedef {import('./app_context.js').AppContext} AppContext */

/**
 * Lights: the list, adding and removing, every property; the environment; exposure and tone curve.
 */
export class LightTab {
  /** @param {HTMLElement} root @param {AppContext} app */
  constructor(root, app) {
    this.app = app;
    this.list = element('div', { class: 'choices', role: 'group', 'aria-label': 'Lights' });
    this.actions = element('div', { class: 'actions' });
    this.chosen = element('div', {});
    this.shared = element('div', {});
    this.environments = new EnvironmentLoader(app);
    root.append(element('h2', {}, 'Lights'), this.list, this.actions, this.chosen, this.shared);
    /** @type {{refresh: () => void}[]} */
    this.sharedControls = [];
    /** @type {{refresh: () => void} | null} */
    this.lightControls = null;
  }

  /** Builds what depends on the table and the scene. */
  rebuild() {
    const { app } = this;
    const types = app.parameters('light').find((row) => row.name === 'type')?.values ?? [];
    this.actions.replaceChildren(
      ...types.map((type) =>
        element(
          'button',
          { type: 'button', 'data-add-light': type, onclick: () => app.addLight(type) },
          `Add ${type}`,
        ),
      ),
    );
    this.shared.replaceChildren();
    this.sharedControls = [
      ['environment', 'Environment'],
      ['settings', 'Picture'],
    ].map(([group, title]) => {
      const section = makeSection(this.shared, title);
      if (group === 'environment') section.$children.append(this.environments.root);
      return addParameterControls(
        section,
        app.parameters(group).filter((parameter) => !isGiSetting(parameter)),
        app.target(group),
      );
    });
    this.environments.refresh();
    this.chooseLight();
  }

  /** Shows the lights and the controls of the selected one. */
  chooseLight() {
    const { app } = this;
    const light = app.document.find('light', app.selection.lightId ?? undefined);
    this.#drawList();
    this.chosen.replaceChildren();
    this.lightControls = null;
    if (!light) return;
    const gui = makeSection(this.chosen, light.name || `Light ${light.id}`);
    this.lightControls = addParameterControls(
      gui,
      app.parameters('light'),
      app.target('light', light.id),
    );
    this.chosen.append(
      element(
        'div',
        { class: 'actions' },
        element(
          'button',
          {
            type: 'button',
            'data-remove-light': light.id,
            onclick: () => app.editor.removeLight(light.id),
          },
          `Remove ${light.name || 'light'}`,
        ),
      ),
    );
  }

  /** Shows new values in the controls that are there. @param {string} group @param {number} [id] */
  refresh(group, id) {
    if (group === 'light') {
      this.#drawList();
      if (id === this.app.selection.lightId) this.lightControls?.refresh();
    } else {
      for (const controls of this.sharedControls) controls.refresh();
      this.environments.refresh();
    }
  }

  #drawList() {
    const { app } = this;
    const lights = app.document.data?.lights ?? [];
    const items = lights.map((/** @type {any} */ light) => {
      const [r, g, b] = light.color.map((/** @type {number} */ c) => 255 * srgbFromLinear(c));
      return element(
        'button',
        {
          type: 'button',
          'aria-pressed': light.id === app.selection.lightId,
          'data-light': light.id,
          onclick: () => app.selection.choose({ lightId: light.id, nodeId: light.node }),
        },
        element('span', { class: 'swatch', style: `background:rgb(${r},${g},${b})` }),
        element('span', { class: 'name' }, light.name || `Light ${light.id}`),
        element('small', {}, wordsOf(light.type) + (light.enabled ? '' : ', off')),
        icon('light'),
      );
    });
    const empty = element(
      'p',
      { class: 'hint' },
      'No lights yet. Emissive surfaces and the environment light the scene; add a light below.',
    );
    const focused = /** @type {HTMLElement | null} */ (document.activeElement)?.dataset?.light;
    this.list.replaceChildren(...(items.length ? items : [empty]));
    if (focused !== undefined) this.list.querySelector(`[data-light="${focused}"]`)?.focus();
  }
}
