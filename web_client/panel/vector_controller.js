import { Controller } from './lil_gui.js';

const AXIS_NAMES = ['X', 'Y', 'Z'];

/** Three numbers in a row, one for each axis; arrow keys step them. */
export class VectorController extends Controller {
  /**
   * @param {any} parent the GUI @param {object} object @param {string} property
   * @param {{min: number, max: number, step: number, label: string}} options
   */
  constructor(parent, object, property, { min, max, step, label }) {
    super(parent, object, property, 'vector');
    this.inputs = AXIS_NAMES.map((axis, i) => {
      const input = document.createElement('input');
      input.type = 'number';
      input.min = String(min);
      input.max = String(max);
      input.step = String(step);
      input.className = `axis-${axis.toLowerCase()}`;
      input.setAttribute('aria-label', `${label} ${axis}`);
      input.addEventListener('input', () => this.#change(i, input));
      input.addEventListener('change', () => this._callOnFinishChange());
      input.addEventListener('keydown', (event) => {
        if (event.key === 'Enter') this._callOnFinishChange();
      });
      return input;
    });
    this.$widget.append(...this.inputs);
    this.name(label);
    this.updateDisplay();
  }

  #change(/** @type {number} */ index, /** @type {HTMLInputElement} */ input) {
    const number = input.valueAsNumber;
    if (!Number.isFinite(number)) return;
    const value = [...this.getValue()];
    value[index] = Math.min(Math.max(number, Number(input.min)), Number(input.max));
    this.setValue(value);
  }

  updateDisplay() {
    const value = this.getValue();
    this.inputs.forEach((/** @type {HTMLInputElement} */ input, /** @type {number} */ i) => {
      if (document.activeElement === input && input.valueAsNumber === value[i]) return;
      const number = Number(value[i]);
      const shown = String(
        Number(Math.abs(number) < 1 ? number.toFixed(4) : number.toPrecision(5)),
      );
      if (input.value !== shown && document.activeElement !== input) input.value = shown;
    });
    return this;
  }
}
