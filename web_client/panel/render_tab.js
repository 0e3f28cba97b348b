import { element } from '../ui/element.js';
import { makeEffectList, showEffects } from './effect_list.js';
import { addParameterControls } from './parameter_controls.js';
import { makeSection } from './sections.js';

const QUALITY_OPTIONS = ['quality', 'adaptive', 'target_frame_ms'];
const DEBUG_OPTIONS = ['debug_view', 'debug_level', 'debug_face'];

/**
 * Whether a setting is one of global illumination: the method, and what has an effect with some
 * only.
 * @param {import('./parameter_controls.js').Parameter} parameter of the group settings
 */
export const isGiSetting = ({ name, needs = [] }) =>
  name === 'gi_method' || needs.some((need) => need.name === 'gi_method');

/** Whether this tab shows an option of the view. @param {string} name */
export const isRenderOption = (name) =>
  QUALITY_OPTIONS.includes(name) || DEBUG_OPTIONS.includes(name);

/** How the image is made: quality, global illumination, debug views, effects and their reasons. */
export class RenderTab {
  /** @param {HTMLElement} root @param {import('./app_context.js').AppContext} app */
  constructor(root, app) {
    this.app = app;
    this.root = root;
    this.controls = element('div', {});
    this.effects = makeEffectList();
    this.noEffects = element('p', { class: 'hint' }, 'The first frame will tell.');
    this.measured = element('p', { class: 'note', hidden: true });
    app.view.addEventListener('configuration', () => this.#showConfiguration());
    root.append(
      element('h2', {}, 'Rendering'),
      this.measured,
      this.controls,
      element('h2', {}, 'Effects of this frame'),
    );
    root.append(this.noEffects, this.effects);
    /** @type {{refresh: () => void}[]} */
    this.sections = [];
    this.offHint = element(
      'p',
      { class: 'hint' },
      'Choose a method; the rest of this section needs one.',
    );
    /** @type {HTMLElement | null} */
    this.giRoot = null;
  }

  /** Builds the controls from the table. */
  rebuild() {
    const { app } = this;
    const { view } = app;
    this.controls.replaceChildren();
    const options = (/** @type {string} */ title, /** @type {string[]} */ names) =>
      addParameterControls(
        makeSection(this.controls, title),
        app.parameters('view').filter(({ name }) => names.includes(name)),
        {
          get: (name) => view.options[name],
          set: (name, value) => view.configure({ [name]: value }),
        },
      );
    this.sections = [
      options('Quality', QUALITY_OPTIONS),
      this.#addGi(),
      options('Look inside', DEBUG_OPTIONS),
    ];
    this.refresh();
  }

  refresh() {
    for (const section of this.sections) section.refresh();
    const isOff = this.app.target('settings').get('gi_method') === 'none';
    this.giRoot?.classList.toggle('off', isOff);
    this.offHint.hidden = !isOff;
  }

  /** The settings of this tab have no effect while a measured configuration draws. */
  #showConfiguration() {
    const { configuration } = this.app.view;
    this.measured.hidden = configuration === '';
    this.measured.textContent =
      `This view is drawn with ${configuration}, as chosen in the tab of accuracy. What is set ` +
      'here shows when it goes back to its own settings.';
  }

  /** @param {any} stats a notification of the server */
  takeStats(stats) {
    this.noEffects.hidden = true;
    if (!this.root.hidden || this.effects.childElementCount === 0)
      showEffects(this.effects, stats.effects);
  }

  #addGi() {
    const rows = this.app.parameters('settings').filter(isGiSetting);
    const gui = makeSection(this.controls, 'Global illumination');
    this.giRoot = gui.domElement;
    const controls = addParameterControls(gui, rows, this.app.target('settings'));
    gui.$children.prepend(this.offHint);
    return controls;
  }
}
