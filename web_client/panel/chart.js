// The only file that names the library's file; see lil_gui.js.
import uPlot from '../node_modules/uplot/dist/uPlot.esm.js';
import { element } from '../ui/element.js';

const SECONDS = 60;
const HEIGHT_PX = 84;

/** A value over the last minute. */
export class Chart {
  /**
   * @param {HTMLElement} container
   * @param {{title: string, unit: string, color: string}} options
   */
  constructor(container, { title, unit, color }) {
    this.times = /** @type {number[]} */ ([]);
    this.values = /** @type {number[]} */ ([]);
    this.unit = unit;
    this.now = element('output', {}, '–');
    const box = element('div', {
      class: 'chart-box',
      role: 'img',
      'aria-label': `${title} over the last ${SECONDS} seconds`,
    });
    container.append(element('div', { class: 'chart' }, element('h3', {}, title, this.now), box));
    const axis = {
      stroke: '#98a1ad',
      grid: { stroke: '#2c3139', width: 1 },
      ticks: { show: false },
      font: '11px system-ui',
    };
    this.plot = new uPlot(
      {
        width: 280,
        height: HEIGHT_PX,
        legend: { show: false },
        cursor: { show: false },
        scales: {
          x: { time: false, range: () => [-SECONDS, 0] },
          y: {
            range: (
              /** @type {any} */ _plot,
              /** @type {number} */ _low,
              /** @type {number} */ high,
            ) => [0, Math.max(high * 1.15, 1)],
          },
        },
        axes: [
          {
            ...axis,
            size: 22,
            space: 60,
            values: (/** @type {any} */ _plot, /** @type {number[]} */ at) =>
              at.map((v) => `${v} s`),
          },
          { ...axis, size: 38, space: 24 },
        ],
        series: [
          {},
          {
            stroke: color,
            width: 1.5,
            fill: `${color}22`,
            points: { show: true, size: 3, fill: color },
          },
        ],
      },
      [[], []],
      box,
    );
    new ResizeObserver(() => {
      if (box.clientWidth > 0) this.plot.setSize({ width: box.clientWidth, height: HEIGHT_PX });
    }).observe(box);
  }

  /** @param {number} value */
  add(value) {
    this.times.push(performance.now() / 1000);
    this.values.push(value);
    this.now.textContent = `${value.toFixed(value < 10 ? 1 : 0)} ${this.unit}`;
  }

  draw() {
    const now = performance.now() / 1000;
    while (this.times.length && this.times[0] < now - SECONDS) {
      this.times.shift();
      this.values.shift();
    }
    this.plot.setData([this.times.map((time) => time - now), this.values]);
  }
}
