import { EditWatch } from '../accuracy/edit_watch.js';
import { element } from '../ui/element.js';
import { AccuracyBudget } from './accuracy_budget.js';
import { AccuracyChart } from './accuracy_chart.js';
import { AccuracyCompare } from './accuracy_compare.js';
import { AccuracyMeasure } from './accuracy_measure.js';

/**
 * How far the image is from the reference image, what less error costs, and the choice of a
 * configuration.
 */
export class AccuracyTab {
  /** @param {HTMLElement} root @param {import('./app_context.js').AppContext} app */
  constructor(root, app) {
    this.app = app;
    const { measurement, view } = app;
    const parts = Array.from({ length: 4 }, () => element('div', {}));
    const [form, chart, budget, compare] = parts;
    this.edited = element('p', { class: 'note', role: 'status', hidden: true });
    this.drawnWith = element('span', {});
    this.back = element(
      'button',
      { type: 'button', onclick: () => this.#draw('') },
      'Back to own settings',
    );
    this.drawn = element('div', { class: 'drawn-with' }, this.drawnWith, this.back);
    root.append(
      element('h2', {}, 'Accuracy'),
      form,
      this.edited,
      element('h2', {}, 'Error against time'),
      chart,
      this.drawn,
      element('h2', {}, 'Time for a frame'),
      budget,
      element('h2', {}, 'Over the image'),
      compare,
    );
    this.edits = new EditWatch(app.connection, app.document, measurement);
    this.measure = new AccuracyMeasure(form, app);
    this.budget = new AccuracyBudget(budget, app, {
      onChoose: (name) => this.#draw(name),
      onMove: () => this.chart.refresh(),
    });
    this.chart = new AccuracyChart(chart, app, {
      getBudgetMs: () => this.budget.budgetMs,
      onChoose: (name) => this.#draw(name),
    });
    this.compare = new AccuracyCompare(compare, app);
    for (const event of ['begun', 'results'])
      measurement.addEventListener(event, () => this.refresh());
    measurement.addEventListener('changed', () => {
      this.budget.refresh();
      this.compare.refresh();
    });
    this.edits.addEventListener('changed', () => this.#showEdits());
    view.addEventListener('configuration', () => this.refresh());
    this.refresh();
  }

  refresh() {
    const { configuration } = this.app.view;
    this.drawnWith.textContent = configuration
      ? `Drawn with ${configuration}`
      : 'Drawn with your own settings';
    this.back.hidden = !configuration;
    this.drawn.hidden = this.app.measurement.configurations.length === 0;
    this.chart.refresh();
    this.budget.refresh();
    this.compare.refresh();
    this.#showEdits();
  }

  #showEdits() {
    const { words } = this.edits;
    this.edited.hidden = words === '';
    if (this.edited.textContent !== words) this.edited.textContent = words;
  }

  async #draw(/** @type {string} */ name) {
    try {
      await this.app.view.chooseConfiguration(name);
    } catch (error) {
      this.app.toasts.showError(/** @type {any} */ (error));
    }
  }
}
