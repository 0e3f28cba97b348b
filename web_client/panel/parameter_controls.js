import { linearFromSrgb, srgbFromLinear } from '../math/color.js';
import { fromEulerDegrees, toEulerDegrees } from '../math/quaternion.js';
import { element } from '../ui/element.js';
import { labelOf, wordsOf } from './labels.js';
import { VectorController } from './vector_controller.js';

/**
 * @typedef {object} Parameter a row of the server's table
 * @property {string} group
 * @property {string} name
 * @property {string} type
 * @property {number} [min]
 * @property {number} [max]
 * @property {number} [step]
 * @property {string} unit
 * @property {any} default
 * @property {string[]} [values]
 * @property {boolean} live
 * @property {{name: string, in: any[], reason: string}[]} [needs] what others of its group must be
 *   for it to have an effect
 * @property {string} doc
 */

/**
 * @typedef {object} Target what the controls show and change
 * @property {(name: string) => any} get
 * @property {(name: string, value: any, transient: boolean) => void} set
 */

/**
 * Why a parameter has no effect beside the others of its group; "" if it has.
 * @param {Parameter} parameter @param {Target} target
 */
const whyRests = ({ needs = [] }, target) =>
  needs.find((need) => !need.in.includes(target.get(need.name)))?.reason ?? '';

const MAX_SLIDER_STEPS = 1001;
const DEGREES = 180 / Math.PI;

const rounded = (/** @type {number} */ value) => Number(value.toPrecision(5));

// The picker has 256 steps and truncates: a value just above a step stays on it.
const pickerFromLinear = (/** @type {number} */ v) =>
  (Math.round(255 * srgbFromLinear(v)) + 1e-3) / 255;

/**
 * How a type is shown: the value for people, and back.
 * @type {Record<string, {show: Function, read: Function}>}
 */
const CONVERSIONS = {
  plain: { show: (/** @type {any} */ v) => v, read: (/** @type {any} */ v) => v },
  number: { show: rounded, read: (/** @type {number} */ v) => v },
  angle: {
    show: (/** @type {number} */ v) => rounded(v * DEGREES),
    read: (/** @type {number} */ v) => v / DEGREES,
  },
  color: {
    show: (/** @type {number[]} */ v) => v.slice(0, 3).map(pickerFromLinear),
    read: (/** @type {number[]} */ v) => v.map(linearFromSrgb),
  },
  quaternion: { show: toEulerDegrees, read: fromEulerDegrees },
};

function conversionOf(/** @type {Parameter} */ { type, unit }) {
  if (unit === 'rad') return CONVERSIONS.angle;
  if (type === 'float' || type === 'int') return CONVERSIONS.number;
  if (type === 'color' || type === 'color_alpha') return CONVERSIONS.color;
  return CONVERSIONS[type] ?? CONVERSIONS.plain;
}

/**
 * Adds a control for each parameter to a GUI: what is there, its range and its words come from the
 * server's table.
 * @param {any} gui @param {Parameter[]} parameters @param {Target} target
 * @returns {{refresh: () => void}} refresh shows the target's present values
 */
export function addParameterControls(gui, parameters, target) {
  const controllers = parameters.flatMap((parameter) => addControl(gui, parameter, target));
  return { refresh: () => controllers.forEach((controller) => controller.updateDisplay()) };
}

function addControl(
  /** @type {any} */ gui,
  /** @type {Parameter} */ parameter,
  /** @type {Target} */ target,
) {
  const { name, type } = parameter;
  const { show, read } = conversionOf(parameter);
  const shown = { [name]: show(target.get(name)) };
  const controller = makeController(gui, parameter, shown);
  const update = controller.updateDisplay.bind(controller);
  const send = (/** @type {any} */ value, /** @type {boolean} */ transient) => {
    const next = read(value);
    target.set(name, type === 'color_alpha' ? [...next, target.get(name)[3]] : next, transient);
  };
  const isChosen = ['bool', 'enum', 'string'].includes(type); // at once, not by dragging
  let isChanging = false;
  controller.onChange((/** @type {any} */ value) => {
    isChanging = true;
    if (parameter.live && !isChosen) send(value, true);
  });
  controller.onFinishChange((/** @type {any} */ value) => {
    send(value, false);
    isChanging = false;
  });
  controller.updateDisplay = () => {
    // While a control changes it shows its own value: converting it there and back would round it.
    if (!isChanging) shown[name] = show(target.get(name));
    showWhyRests(controller, parameter, target);
    return update();
  };
  describe(controller, parameter, name);
  showWhyRests(controller, parameter, target);
  if (type !== 'color_alpha') return [controller];
  return [controller, addAlpha(gui, parameter, target)];
}

function makeController(
  /** @type {any} */ gui,
  /** @type {Parameter} */ parameter,
  /** @type {any} */ object,
) {
  const { name, type, unit, values } = parameter;
  const label = labelOf(parameter);
  const factor = unit === 'rad' ? DEGREES : 1;
  const [min, max, step] = [parameter.min ?? 0, parameter.max ?? 0, parameter.step ?? 1].map(
    (number) => number * factor,
  );
  if (values)
    return gui
      .add(object, name, Object.fromEntries(values.map((v) => [choiceOf(v), v])))
      .name(label);
  if (type === 'vec3') return new VectorController(gui, object, name, { min, max, step, label });
  if (type === 'quaternion')
    return new VectorController(gui, object, name, {
      min: -360,
      max: 360,
      step: 1,
      label: `${label} (°)`,
    });
  if (type.startsWith('color')) return gui.addColor(object, name).name(label);
  const controller = gui.add(object, name).name(label);
  if (type !== 'float' && type !== 'int') return controller;
  // A slider over millions of steps is useless: such numbers are typed, stepped or dragged.
  if ((parameter.max ?? 0) - (parameter.min ?? 0) > MAX_SLIDER_STEPS * (parameter.step ?? 1))
    controller.min(min);
  else controller.min(rounded(min)).max(rounded(max));
  return controller.step(unit === 'rad' ? 1 : step, false);
}

/** Keys that are whole numbers would come first, out of order. An invisible space prevents that. */
function choiceOf(/** @type {string} */ value) {
  return /^\d+$/.test(value) ? `${value}\u00a0` : wordsOf(value);
}

/** Disables the control of a value that has no effect now, and says why. */
function showWhyRests(
  /** @type {any} */ controller,
  /** @type {Parameter} */ parameter,
  /** @type {Target} */ target,
) {
  const { doc } = parameter;
  const why = whyRests(parameter, target);
  if (controller.domElement.dataset.why === why) return;
  controller.domElement.dataset.why = why;
  controller.domElement.title = why ? `${doc} Has no effect now: ${why}.` : doc;
  controller.$name.querySelector('small')?.remove();
  if (why) controller.$name.append(element('small', { class: 'why' }, ` ${why}`));
  controller.disable(why !== '');
}

function addAlpha(
  /** @type {any} */ gui,
  /** @type {Parameter} */ parameter,
  /** @type {Target} */ target,
) {
  const { name, live } = parameter;
  const proxy = { alpha: target.get(name)[3] };
  const set = (/** @type {number} */ alpha, /** @type {boolean} */ transient) =>
    target.set(name, [...target.get(name).slice(0, 3), alpha], transient);
  const controller = gui
    .add(proxy, 'alpha', parameter.min, parameter.max, parameter.step)
    .name('Alpha');
  controller.onChange((/** @type {number} */ alpha) => live && set(alpha, true));
  controller.onFinishChange((/** @type {number} */ alpha) => set(alpha, false));
  const update = controller.updateDisplay.bind(controller);
  controller.updateDisplay = () => {
    proxy.alpha = rounded(target.get(name)[3]);
    return update();
  };
  describe(controller, parameter, 'alpha');
  return controller;
}

function describe(
  /** @type {any} */ controller,
  /** @type {Parameter} */ parameter,
  /** @type {string} */ name,
) {
  controller.domElement.dataset.parameter = `${parameter.group}.${name}`;
  controller.domElement.title = parameter.doc;
}
