import { element } from '../ui/element.js';
import { Chart } from './chart.js';
import { makeEffectList, showEffects } from './effect_list.js';
import { wordsOf } from './labels.js';

const DRAW_MS = 500;
const PING_MS = 2000;
const RATE_WINDOW_MS = 2000;

const BOTTLENECKS = /** @type {Record<string, string>} */ ({
  render: 'Rendering on the server',
  encode: 'Compressing images on the server',
  network: 'The network',
  client: 'This browser',
  none: 'Nothing: the image is at rest',
});

const bytes = (/** @type {number} */ count) =>
  count >= 1048576 ? `${(count / 1048576).toFixed(1)} MiB` : `${(count / 1024).toFixed(1)} KiB`;

/** Where the time goes: passes, effects, memory, stages, and charts of the last minute. */
export class StatsTab {
  /** @param {HTMLElement} root @param {import('./app_context.js').AppContext} app */
  constructor(root, app) {
    this.app = app;
    this.root = root;
    /** @type {any} the newest message of the server */
    this.stats = null;
    /** @type {number[]} */
    this.arrivals = [];
    this.header = /** @type {any} */ (null);
    this.decodeMs = 0;
    this.bottleneck = element('p', { class: 'bottleneck' }, 'No frames yet');
    this.figures = element('dl', { class: 'info figures' });
    this.passes = element('ul', { class: 'bars', 'aria-label': 'Passes' });
    this.stages = element('ul', { class: 'bars', 'aria-label': 'Stages' });
    this.effects = makeEffectList();
    this.memory = element('ul', { class: 'bars', 'aria-label': 'Memory' });
    this.rejects = element('dl', { class: 'info figures', 'aria-label': 'Clamped and left out' });
    const charts = element('div', {});
    const section = (/** @type {string} */ title, /** @type {HTMLElement} */ content) => [
      element('h2', {}, title),
      content,
    ];
    root.append(
      element('h2', {}, 'Bottleneck'),
      this.bottleneck,
      this.figures,
      charts,
      ...section('Passes', this.passes),
      ...section('From change to screen', this.stages),
      ...section('Effects', this.effects),
      ...section('Graphics memory', this.memory),
      ...section('Clamped and left out', this.rejects),
    );
    this.rateChart = new Chart(charts, { title: 'Frame rate', unit: 'fps', color: '#6fb1ff' });
    this.photonChart = new Chart(charts, { title: 'Edit to photon', unit: 'ms', color: '#ffc46b' });
    this.sizeChart = new Chart(charts, { title: 'Image size', unit: 'KiB', color: '#7bd6a4' });
    setInterval(() => this.#tick(), DRAW_MS);
    setInterval(() => this.#ping(), PING_MS);
  }

  /** @param {any} stats a notification of the server */
  takeStats(stats) {
    this.stats = stats;
  }

  /**
   * @param {import('../net/frame_header.js').FrameHeader} header @param {number} decodeMs
   */
  takeFrame(header, decodeMs) {
    this.arrivals.push(performance.now());
    this.header = header;
    this.decodeMs = decodeMs;
    this.sizeChart.add(header.jpegBytes / 1024);
  }

  /** @param {number} ms */
  takeEditToPhoton(ms) {
    this.photonChart.add(ms);
  }

  /** Frames shown per second over the last seconds. */
  get framesPerSecond() {
    return this.arrivals.length / (RATE_WINDOW_MS / 1000);
  }

  #ping() {
    // Any small request will do: its reply measures the round trip.
    if (!this.root.hidden && !document.hidden)
      this.app.connection.call('pick', { x: 0, y: 0 }).catch(() => {});
  }

  #tick() {
    const oldest = performance.now() - RATE_WINDOW_MS;
    this.arrivals = this.arrivals.filter((at) => at >= oldest);
    this.rateChart.add(this.framesPerSecond);
    if (this.root.hidden) return;
    for (const chart of [this.rateChart, this.photonChart, this.sizeChart]) chart.draw();
    if (this.header) this.#drawFigures();
    if (this.stats) this.#drawStats();
  }

  #drawFigures() {
    const { times } = this.app.timer;
    const median = [...times].sort((a, b) => a - b)[times.length >> 1];
    const rows = [
      ['Picture', `${this.header.width} × ${this.header.height}`],
      ['Frame', `${this.stats?.frame_time_ms.toFixed(1) ?? '–'} ms`],
      ['Round trip', `${this.app.connection.roundTripMs.toFixed(1)} ms`],
      ['Edit to photon', median === undefined ? 'no edit yet' : `${median.toFixed(0)} ms (median)`],
      ['Decode', `${this.decodeMs.toFixed(1)} ms`],
      ['Viewers', String(this.stats?.clients ?? 1)],
    ];
    this.figures.replaceChildren(
      ...rows.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]),
    );
  }

  #drawStats() {
    const { passes, stages_ms, effects, memory, rejects, bottleneck } = this.stats;
    this.bottleneck.textContent = BOTTLENECKS[bottleneck] ?? wordsOf(bottleneck);
    this.bottleneck.dataset.stage = bottleneck;
    const times = (/** @type {number} */ ms) => `${ms.toFixed(1)} ms`;
    this.#drawBars(
      this.passes,
      passes.map((/** @type {any} */ pass) => ({ ...pass, value: pass.time_ms, off: !pass.ran })),
      times,
    );
    const stages = Object.entries(stages_ms).map(([name, value]) => ({
      name,
      value: Number(value),
    }));
    this.#drawBars(this.stages, [...stages, { name: 'decode', value: this.decodeMs }], times);
    this.#drawBars(
      this.memory,
      memory.map((/** @type {any} */ part) => ({ name: part.name, value: part.bytes })),
      bytes,
    );
    showEffects(this.effects, effects);
    this.rejects.replaceChildren(
      ...rejects.flatMap((/** @type {any} */ { name, count }) => [
        element('dt', {}, wordsOf(name)),
        element('dd', {}, String(count)),
      ]),
    );
  }

  #drawBars(
    /** @type {HTMLElement} */ list,
    /** @type {{name: string, value: number, off?: boolean, reason?: string}[]} */ rows,
    /** @type {(value: number) => string} */ format,
  ) {
    const max = Math.max(...rows.map((row) => row.value), 1e-9);
    list.replaceChildren(
      ...rows.map(({ name, value, off, reason }) =>
        element(
          'li',
          { class: off ? 'off' : '', title: reason || undefined },
          element('span', { class: 'name' }, wordsOf(name)),
          ...(off
            ? [element('small', { class: 'reason' }, `skipped: ${reason || 'not needed'}`)]
            : [
                element(
                  'span',
                  { class: 'bar' },
                  element('span', { style: `width:${(100 * value) / max}%` }),
                ),
                element('small', {}, format(value)),
              ]),
        ),
      ),
    );
  }
}
