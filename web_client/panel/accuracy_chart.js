import { msText, configurationTitle } from '../accuracy/words.js';
import { element } from '../ui/element.js';
import { errorChart, ErrorChartView } from './error_chart.js';
import { makeSection } from './sections.js';

const HEIGHT_PX = 236;
const TIP_ID = 'error-tip';
const GAP_PX = 10;

/**
 * The chart of error against time: cost and accuracy of each measured configuration; a click draws
 * with it.
 */
export class AccuracyChart {
  /**
   * @param {HTMLElement} root
   * @param {import('./app_context.js').AppContext} app
   * @param {{ getBudgetMs: () => number, onChoose: (name: string) => void }} options
   */
  constructor(root, app, options) {
    this.app = app;
    this.options = options;
    this.choice = { ...errorChart.FIRST_CHOICE };
    this.svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    this.svg.setAttribute('class', 'error-chart');
    this.svg.setAttribute('role', 'group');
    this.svg.setAttribute('aria-label', 'Error against time, both logarithmic');
    this.legend = element('p', { class: 'chart-legend' });
    this.noise = element('p', { class: 'hint' });
    this.empty = element('p', { class: 'hint chart-empty' }, 'Nothing has been measured yet.');
    this.figure = element('div', { class: 'error-figure' }, this.svg);
    root.append(this.empty, this.figure, this.legend, this.noise);
    this.#addChoices(root);
    this.tip = element('div', { id: TIP_ID, class: 'error-tip', role: 'tooltip', hidden: true });
    document.body.append(this.tip);
    this.view = new ErrorChartView(this.svg, {
      label: 'Measured settings, from fast to slow; Enter draws with one',
      onShow: (/** @type {any} */ point, /** @type {SVGElement} */ mark) =>
        this.#showTip(point, mark),
      onHide: () => (this.tip.hidden = true),
      onChoose: (/** @type {any} */ { configuration }) => options.onChoose(configuration.name),
    });
    new ResizeObserver(() => this.refresh()).observe(this.figure);
  }

  refresh() {
    const { results } = this.app.measurement;
    const hasConfigurations = this.app.measurement.configurations.length > 0;
    this.empty.hidden = hasConfigurations;
    for (const part of [this.figure, this.legend, this.noise, this.section.domElement])
      part.hidden = !hasConfigurations;
    if (!hasConfigurations) this.tip.hidden = true;
    const width = this.figure.clientWidth;
    if (!hasConfigurations || width < 2) return;
    this.#fillMetrics(results);
    const budgetMs = this.options.getBudgetMs();
    this.view.draw({
      results,
      choice: this.choice,
      width,
      height: HEIGHT_PX,
      live: 'live',
      chosen: this.app.view.configuration || undefined,
      budgetMs: Number.isFinite(budgetMs) ? budgetMs : 0,
      isNarrow: true,
      labels: 'marked',
    });
    this.#drawLegend(results);
    this.noise.textContent = describeNoise(results, this.choice);
  }

  #addChoices(/** @type {HTMLElement} */ root) {
    const redraw = () => this.refresh();
    const named = (/** @type {Record<string, string>} */ words) =>
      Object.fromEntries(Object.entries(words).map(([name, title]) => [title, name]));
    const times = Object.fromEntries(
      Object.entries(errorChart.TIMES).map(([name, time]) => [
        /** @type {any} */ (time).short,
        name,
      ]),
    );
    this.section = makeSection(root, 'What the chart shows', false);
    this.metric = this.section
      .add(this.choice, 'metric', { 'LDR-FLIP': 'ldr_flip' })
      .name('Error by')
      .onChange(redraw);
    this.section.add(this.choice, 'time', times).name('Against').onChange(redraw);
    this.section
      .add(this.choice, 'state', named(errorChart.STATES))
      .name('Of the')
      .onChange(redraw);
    this.part = this.section
      .add(this.choice, 'part', named(errorChart.PARTS))
      .name('Of')
      .onChange(redraw);
  }

  /** The results say which metrics there are. */
  #fillMetrics(/** @type {any} */ results) {
    const rows = results.metrics.filter((/** @type {any} */ { name }) => name !== 'not_finite');
    const known = rows.map((/** @type {any} */ { name }) => name).join();
    if (this.knownMetrics === known) return;
    this.knownMetrics = known;
    this.metric.options(
      Object.fromEntries(rows.map((/** @type {any} */ { name, title }) => [title, name])),
    );
    this.metric.name('Error by').onChange(() => this.refresh());
    this.part.show(results.setup.reference.direct === true);
  }

  #drawLegend(/** @type {any} */ results) {
    const methods = new Set(results.rungs.map((/** @type {any} */ { method }) => method));
    this.legend.replaceChildren(
      ...[...methods].map((method) =>
        element(
          'span',
          {},
          element('b', { style: `background:${errorChart.colorOf(method)}` }),
          String(method),
        ),
      ),
      element('span', {}, 'large: none is faster and better'),
    );
  }

  #showTip(/** @type {any} */ { configuration, ms }, /** @type {SVGElement} */ mark) {
    const title = this.app.measurement.results.metrics.find(
      (/** @type {any} */ row) => row.name === this.choice.metric,
    )?.title;
    const figures = [
      [title, errorChart.short(errorChart.valueOf(configuration, this.choice))],
      [errorChart.TIMES[this.choice.time].short.replace(/, ms$/, ''), msText(ms)],
      ['memory', `${(configuration.memory_bytes / 1048576).toFixed(0)} MiB`],
    ];
    this.tip.replaceChildren(
      element('b', {}, configurationTitle(configuration.name)),
      element('small', {}, errorChart.settingText(configuration)),
      element(
        'dl',
        { class: 'info' },
        ...figures.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]),
      ),
      this.#makePicture(configuration),
    );
    this.tip.hidden = false;
    mark.setAttribute('aria-describedby', TIP_ID);
    this.#positionTip(mark);
  }

  /**
   * The final image, or the strip, which includes the first one. Its size is set before it has
   * loaded.
   */
  #makePicture(/** @type {any} */ configuration) {
    const { width, height } = this.app.measurement.results.setup.scene;
    const isCold = this.choice.state === 'cold';
    return element('img', {
      src: this.app.measurement.url(
        isCold ? configuration.pictures.strip : configuration.pictures.converged,
      ),
      alt:
        `${isCold ? 'Reference image, first and final image and error' : 'Final image'} of ` +
        `${configuration.name}`,
      style: `aspect-ratio:${isCold ? 4 * width : width}/${height}`,
    });
  }

  /** Beside the panel, or above it where the panel is a sheet: never over the chart. */
  #positionTip(/** @type {SVGElement} */ mark) {
    const panel = /** @type {HTMLElement} */ (
      this.figure.closest('.panel') ?? this.figure
    ).getBoundingClientRect();
    const { top } = mark.getBoundingClientRect();
    const isSheet = panel.left < this.tip.offsetWidth + GAP_PX;
    const highest = window.innerHeight - this.tip.offsetHeight - GAP_PX;
    const style = this.tip.style;
    style.left = isSheet ? `${GAP_PX}px` : `${panel.left - this.tip.offsetWidth - GAP_PX}px`;
    style.top = isSheet
      ? `${Math.max(panel.top - this.tip.offsetHeight - GAP_PX, GAP_PX)}px`
      : `${Math.max(Math.min(top - 40, highest), GAP_PX)}px`;
  }
}

/** The reference image's own error, where that matters. */
function describeNoise(/** @type {any} */ results, /** @type {any} */ { part, metric }) {
  const noise = results.noise?.[part]?.[metric];
  if (!noise || noise.enough) return '';
  return (
    `The reference image itself errs by ${errorChart.short(noise.reference)}, more than a ` +
    `tenth of the least error (${errorChart.short(noise.smallest)}): ask for less noise to ` +
    'tell the best apart.'
  );
}
