import { element } from '../ui/element.js';
import { RENDER_SIZES } from '../view/view_size.js';
import { wordsOf } from './labels.js';
import { addParameterControls } from './parameter_controls.js';
import { isRenderOption } from './render_tab.js';
import { makeSection } from './sections.js';

const KEYS = [
  ['Drag', 'orbit, or look in fly mode'],
  ['Right drag, Shift drag', 'pan'],
  ['Wheel, pinch, + −', 'nearer, farther'],
  ['W A S D, Q E', 'walk, down and up; Shift: faster'],
  ['Arrow keys', 'orbit or look'],
  ['F', 'frame the selection, or the scene'],
  ['Click, Enter', 'select; Enter takes the middle'],
  ['Esc', 'select nothing'],
  ['Ctrl Z, Ctrl Y', 'undo, redo'],
];

/**
 * Controls of other tabs: the stage decides the size, the accuracy tab the configuration, the
 * render tab the quality.
 */
const ELSEWHERE = ['width', 'height', 'rung'];

/** Whether there is anything to choose: an enum of one value needs no control. */
const hasChoice = (/** @type {any} */ { values }) => values === undefined || values.length > 1;

/** How this client looks: image size, pause, its camera, and the keys. */
export class ViewTab {
  /** @param {HTMLElement} root @param {import('./app_context.js').AppContext} app */
  constructor(root, app) {
    this.app = app;
    this.controls = element('div', {});
    root.append(
      element('h2', {}, 'View'),
      this.controls,
      element('h2', {}, 'Keys'),
      this.#makeKeys(),
    );
    /** @type {{refresh: () => void}[]} */
    this.sections = [];
  }

  /** Builds the controls from the table. */
  rebuild() {
    const { app } = this;
    const { view, camera } = app;
    this.controls.replaceChildren();
    const picture = makeSection(this.controls, 'Picture');
    const sizes = Object.fromEntries(
      Object.keys(RENDER_SIZES).map((name) => [wordsOf(name), name]),
    );
    const size = picture.add(view, 'sizeChoice', sizes).name('Render size');
    size.onChange((/** @type {string} */ choice) => view.chooseSize(choice));
    const rows = app
      .parameters('view')
      .filter((row) => !ELSEWHERE.includes(row.name) && !isRenderOption(row.name))
      .filter(hasChoice);
    const options = addParameterControls(picture, rows, {
      get: (name) => view.options[name],
      set: (name, value) => view.configure({ [name]: value }),
    });
    const lens = makeSection(this.controls, 'Camera');
    const mode = lens.add(view, 'mode', { Orbit: 'orbit', Fly: 'fly' }).name('Mode');
    mode.onChange((/** @type {'orbit' | 'fly'} */ chosen) => view.chooseMode(chosen));
    const pose = addParameterControls(lens, app.parameters('camera'), {
      get: (name) => /** @type {any} */ (camera.pose)[name],
      set: (name, value) => camera.set({ [name]: value }),
    });
    this.sections = [options, pose, { refresh: () => mode.updateDisplay() }];
  }

  refresh() {
    for (const section of this.sections) section.refresh();
  }

  #makeKeys() {
    const list = element('dl', { class: 'info keys' });
    for (const [keys, meaning] of KEYS)
      list.append(element('dt', {}, keys), element('dd', {}, meaning));
    return list;
  }
}
