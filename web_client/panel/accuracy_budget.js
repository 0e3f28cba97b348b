import { BUDGETS, pickConfiguration } from '../accuracy/budget.js';
import { msText, configurationTitle } from '../accuracy/words.js';
import { element } from '../ui/element.js';
import { errorChart } from './error_chart.js';

const FIRST = 1;

/**
 * The slider for the time that a frame may take. It draws with the most accurate configuration that
 * keeps it.
 */
export class AccuracyBudget {
  /**
   * @param {HTMLElement} root
   * @param {import('./app_context.js').AppContext} app
   * @param {{ onChoose: (name: string) => void, onMove: () => void }} options onMove: another
   *   budget is shown
   */
  constructor(root, app, options) {
    this.app = app;
    this.slider = element('input', {
      type: 'range',
      min: 0,
      max: BUDGETS.length - 1,
      step: 1,
      value: FIRST,
      'aria-label': 'Time that a frame may take',
      oninput: () => {
        this.refresh();
        options.onMove();
      },
      // The slider was released: the image follows.
      onchange: () => this.pick && options.onChoose(this.pick.name),
    });
    this.marks = element('div', { class: 'budget-marks', 'aria-hidden': 'true' });
    this.marks.append(
      ...BUDGETS.map(({ name }, i) =>
        element('span', { style: `--position:${i / (BUDGETS.length - 1)}` }, name),
      ),
    );
    this.text = element('p', { class: 'budget-text' });
    this.use = element(
      'button',
      { type: 'button', onclick: () => options.onChoose(this.pick.name) },
      'Draw with it',
    );
    root.append(
      element('div', { class: 'budget' }, this.slider, this.marks),
      this.text,
      element('div', { class: 'actions' }, this.use),
    );
    /** @type {any} entry of the configuration that fits the budget */
    this.pick = null;
    this.refresh();
  }

  /** Milliseconds; infinite for images at rest. */
  get budgetMs() {
    return BUDGETS[this.slider.valueAsNumber].ms;
  }

  refresh() {
    const { measurement, view } = this.app;
    const { name, ms } = BUDGETS[this.slider.valueAsNumber];
    const { best, fastest } = pickConfiguration(measurement.configurations, ms);
    this.pick = best;
    this.slider.disabled = !fastest;
    this.text.classList.toggle('hint', !fastest);
    this.use.hidden = !best || view.configuration === best.name;
    this.text.textContent = fastest ? describePick(name, best, fastest) : this.#describeNothing();
    this.slider.setAttribute('aria-valuetext', best ? `${name}: ${best.name}` : name);
    [...this.marks.children].forEach((mark, i) =>
      mark.classList.toggle('chosen', i === this.slider.valueAsNumber),
    );
  }

  #describeNothing() {
    return this.app.measurement.isRunning
      ? 'The first settings are still to be measured.'
      : 'Measure the view first: then this finds the most accurate setting that is fast ' +
          'enough, here and on this machine.';
  }
}

const errorText = (/** @type {any} */ configuration) =>
  `LDR-FLIP ${errorChart.short(configuration.converged.metrics.ldr_flip)}`;

function describePick(
  /** @type {string} */ name,
  /** @type {any} */ best,
  /** @type {any} */ fastest,
) {
  if (!best)
    return (
      `Nothing measured keeps ${name}: the fastest, ${configurationTitle(fastest.name)}, takes ` +
      `${msText(fastest.frame_ms.median)} a frame (${errorText(fastest)}).`
    );
  const untilFinal = `, ${msText(best.converged.ms)} to the final image`;
  const budget = name === 'still' ? 'When time does not matter' : `Within ${name}`;
  return (
    `${budget}: ${configurationTitle(best.name)}, ${errorText(best)}, ` +
    `${msText(best.frame_ms.median)} a frame${untilFinal}.`
  );
}
