// The page of an accuracy run: a chart of error against time, a table, and pictures, of what results.js
// has left in globalThis.results. Opened from the disk, so it is no module and loads nothing.

/** @typedef {{ name: string, title: string, unit: string }} Metric */
/** @typedef {{ ms: number, error: number, rung: object }} Point */

(() => {
  const { setup, metrics, rungs } = globalThis.results;
  const SVG = 'http://www.w3.org/2000/svg';
  const AREA = { left: 70, right: 980, top: 15, bottom: 510 };
  const COLORS = { none: '#8a8f99', clipmap: '#d9622b', grid: '#2b7fd9' };
  const OTHER_COLOR = '#3a9a5b';

  const TIMES = {
    frame: { title: 'median frame of a moving camera, ms', get: (rung) => rung.frame_ms.median },
    cold: { title: 'first picture of a scene just loaded, ms', get: (rung) => rung.cold.ms },
    converged: { title: 'from the loaded scene to the final picture, ms', get: (rung) => rung.converged.ms },
    edit: { title: 'from an edit of a light to 95 % of its change, ms', get: (rung) => rung.edit?.arrived_ms },
  };
  const STATES = { converged: 'final picture', cold: 'first picture' };
  const PARTS = { metrics: 'all light', indirect: 'indirect light alone' };
  const choice = { metric: 'ldr_flip', time: 'frame', state: 'converged', part: 'metrics' };

  /** What a metric errs by: 0 is perfect. As image_metric_error() has it. */
  function errorOf(metric, value) {
    if (typeof value !== 'number') return null;
    if (metric.startsWith('energy_')) return Math.abs(value - 1);
    if (metric === 'ssim') return 1 - value;
    if (metric === 'psnr') return 10 ** (-value / 20);
    return value;
  }

  function errorTitle({ name, title, unit }) {
    if (name.startsWith('energy_')) return `distance of ${title} from 1`;
    if (name === 'ssim') return '1 - SSIM';
    if (name === 'psnr') return 'RMSE of displayed values (from PSNR)';
    return unit ? `${title}, ${unit}` : title;
  }

  const metricOf = (name) => metrics.find((metric) => metric.name === name);
  const valueOf = (rung, name) => rung[choice.state]?.[choice.part]?.[name];
  const short = (value) => (typeof value === 'number' ? String(Number(value.toPrecision(3))) : '–');

  /** @returns {Point[]} what can be drawn on logarithmic axes */
  function points() {
    return rungs
      .map((rung) => ({ rung, ms: TIMES[choice.time].get(rung), error: errorOf(choice.metric, valueOf(rung, choice.metric)) }))
      .filter(({ ms, error }) => ms > 0 && error > 0);
  }

  /** Points than which none is both faster and less wrong, from fast to slow. */
  function frontOf(all) {
    const front = [];
    for (const point of [...all].sort((a, b) => a.ms - b.ms || a.error - b.error))
      if (front.length === 0 || point.error < front.at(-1).error) front.push(point);
    return front;
  }

  /** Maps a range of values, widened a little, to a range of the chart. */
  function logScale(values, from, to) {
    let low = Math.log10(Math.min(...values));
    let high = Math.log10(Math.max(...values));
    const margin = Math.max(0.06 * (high - low), 0.05);
    low -= margin;
    high += margin;
    const scale = (value) => from + ((Math.log10(value) - low) / (high - low)) * (to - from);
    const steps = high - low > 4 ? [1] : high - low > 1 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9];
    const ticks = [];
    for (let decade = Math.floor(low); decade <= high; decade++)
      for (const step of steps) {
        const value = step * 10 ** decade;
        if (Math.log10(value) >= low && Math.log10(value) <= high) ticks.push(value);
      }
    return { scale, ticks };
  }

  function element(parent, name, attributes, text) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    parent.append(made);
    return made;
  }

  function settingText({ settings }) {
    const sets = Object.entries(settings.set).map(([key, value]) => `${key} ${value}`);
    const scale = settings.scale === 1 ? [] : [`scale ${settings.scale}`];
    return [`preset ${settings.preset}`, ...scale, ...sets].join(', ');
  }

  const tip = document.getElementById('tip');

  function showTip(point, x, y) {
    const { rung } = point;
    tip.replaceChildren();
    const title = document.createElement('b');
    title.textContent = rung.name;
    const text = document.createElement('div');
    text.textContent =
      `${settingText(rung)}. ${short(point.ms)} ms; ` +
      `${metricOf(choice.metric).title} ${short(valueOf(rung, choice.metric))}; ` +
      `${short(rung.memory_bytes / 1048576)} MiB`;
    const picture = document.createElement('img');
    picture.src = rung.pictures.converged;
    picture.alt = `Final picture of ${rung.name}`;
    tip.append(title, text, picture);
    tip.hidden = false;
    // The chart may be drawn smaller than its own coordinates.
    const svg = document.getElementById('chart');
    const ratio = svg.clientWidth / svg.viewBox.baseVal.width;
    tip.style.left = `${x > 600 ? Math.max(x * ratio - tip.offsetWidth - 15, 0) : x * ratio + 15}px`;
    tip.style.top = `${Math.max(Math.min(y * ratio, svg.clientHeight - tip.offsetHeight), 0)}px`;
  }

  function drawAxes(svg, x, y) {
    for (const tick of x.ticks) {
      element(svg, 'line', { class: 'grid', x1: x.scale(tick), x2: x.scale(tick), y1: AREA.top, y2: AREA.bottom });
      element(svg, 'text', { x: x.scale(tick), y: AREA.bottom + 18, 'text-anchor': 'middle' }, short(tick));
    }
    for (const tick of y.ticks) {
      element(svg, 'line', { class: 'grid', x1: AREA.left, x2: AREA.right, y1: y.scale(tick), y2: y.scale(tick) });
      element(svg, 'text', { x: AREA.left - 8, y: y.scale(tick) + 4, 'text-anchor': 'end' }, short(tick));
    }
    element(svg, 'text', { x: (AREA.left + AREA.right) / 2, y: AREA.bottom + 42, 'text-anchor': 'middle' }, TIMES[choice.time].title);
    element(
      svg,
      'text',
      { transform: `translate(16 ${(AREA.top + AREA.bottom) / 2}) rotate(-90)`, 'text-anchor': 'middle' },
      errorTitle(metricOf(choice.metric)),
    );
  }

  function drawPoint(svg, point, x, y, onFront) {
    const [cx, cy] = [x.scale(point.ms), y.scale(point.error)];
    const mark = element(svg, 'circle', {
      class: 'point',
      cx,
      cy,
      r: onFront ? 8 : 5,
      fill: COLORS[point.rung.method] ?? OTHER_COLOR,
      tabindex: 0,
      role: 'img',
      'aria-label': `${point.rung.name}: ${short(point.ms)} ms, error ${short(point.error)}`,
    });
    for (const event of ['pointerenter', 'focus']) mark.addEventListener(event, () => showTip(point, cx, cy));
    for (const event of ['pointerleave', 'blur'])
      mark.addEventListener(event, () => {
        tip.hidden = true;
      });
    mark.addEventListener('click', () => {
      const strip = document.getElementById(`strip-${point.rung.name}`);
      strip.open = true;
      strip.scrollIntoView();
    });
    if (onFront) element(svg, 'text', { class: 'name', x: cx + 11, y: cy - 7 }, point.rung.name);
  }

  /** What the truth errs by itself: a line where it is within the chart, and words. */
  function drawNoise(svg, y) {
    const noise = noiseOf();
    const note = document.getElementById('noise');
    note.textContent = 'The error of the truth itself is not known.';
    if (!noise) return;
    note.textContent =
      `By this measure the truth itself errs by ${short(noise.reference)}; the smallest error of a final picture ` +
      `is ${short(noise.smallest)}. ${noise.enough ? 'That is little enough.' : 'That is more than a tenth: it needs more samples.'}`;
    const height = y.scale(noise.reference);
    if (!(height <= AREA.bottom && height >= AREA.top)) return;
    element(svg, 'line', { class: 'noise', x1: AREA.left, x2: AREA.right, y1: height, y2: height });
    element(svg, 'text', { x: AREA.right, y: height - 5, 'text-anchor': 'end' }, 'noise of the truth');
  }

  function drawChart() {
    const svg = document.getElementById('chart');
    svg.replaceChildren();
    const all = points();
    if (all.length === 0) {
      element(svg, 'text', { x: 500, y: 260, 'text-anchor': 'middle' }, 'No rung has values for this.');
      return;
    }
    const front = frontOf(all);
    const x = logScale(all.map(({ ms }) => ms), AREA.left, AREA.right);
    const y = logScale(all.map(({ error }) => error), AREA.bottom, AREA.top);
    drawAxes(svg, x, y);
    drawNoise(svg, y);
    const corners = front.map(({ ms, error }, i) => {
      const from = i > 0 ? `H${x.scale(ms)}V` : `M${x.scale(ms)} `;
      return from + y.scale(error);
    });
    element(svg, 'path', { class: 'front', d: corners.join('') });
    for (const point of all) drawPoint(svg, point, x, y, front.includes(point));
  }

  function cell(row, text, kind = 'td') {
    const made = document.createElement(kind);
    made.textContent = text;
    row.append(made);
  }

  function drawTable() {
    const table = document.getElementById('table');
    table.replaceChildren();
    const head = table.createTHead().insertRow();
    for (const text of ['rung', 'frame ms', 'first ms', 'final ms', 'edit ms', 'MiB', ...metrics.map(({ title }) => title)])
      cell(head, text, 'th');
    const body = table.createTBody();
    const front = new Set(frontOf(points()).map(({ rung }) => rung));
    for (const rung of [...rungs].sort((a, b) => a.frame_ms.median - b.frame_ms.median)) {
      const row = body.insertRow();
      row.className = front.has(rung) ? 'on-front' : '';
      row.title = settingText(rung);
      cell(row, rung.name);
      for (const { get } of Object.values(TIMES)) cell(row, short(get(rung)));
      cell(row, short(rung.memory_bytes / 1048576));
      for (const { name } of metrics) cell(row, short(valueOf(rung, name)));
    }
  }

  function drawStrips() {
    const place = document.getElementById('strips');
    for (const rung of rungs) {
      const strip = document.createElement('details');
      strip.id = `strip-${rung.name}`;
      const summary = document.createElement('summary');
      summary.textContent = `${rung.name}: ${settingText(rung)}`;
      const picture = document.createElement('img');
      picture.loading = 'lazy';
      picture.src = rung.pictures.strip;
      picture.alt = `Truth, first picture, final picture and error of ${rung.name}`;
      const passes = document.createElement('p');
      const times = Object.entries(rung.pass_ms ?? {}).sort(([, a], [, b]) => b - a);
      passes.textContent = `Median ms of passes: ${times.map(([name, ms]) => `${name} ${short(ms)}`).join(', ')}.`;
      strip.append(summary, picture, passes);
      place.append(strip);
    }
  }

  function draw() {
    drawChart();
    drawTable();
  }

  /** A drop-down for one of the fields of `choice`. */
  function addChoice(field, label, options) {
    const wrapper = document.createElement('label');
    wrapper.textContent = `${label} `;
    const select = document.createElement('select');
    select.name = field;
    for (const [value, text] of options) select.append(new Option(text, value, false, value === choice[field]));
    select.addEventListener('change', () => {
      choice[field] = select.value;
      draw();
    });
    wrapper.append(select);
    document.getElementById('choice').append(wrapper);
  }

  /** The truth's own error by the metric chosen, or undefined. */
  const noiseOf = () => globalThis.results.noise[choice.part]?.[choice.metric];

  function describeNoise() {
    const { reference } = setup;
    if (typeof reference.noise !== 'number') return 'Its noise is not known.';
    return `Its noise (standard error of pixels over the mean) is ${short(100 * reference.noise)} %.`;
  }

  function describeSetup() {
    const { scene, reference } = setup;
    document.getElementById('setup').textContent =
      `${scene.source}, ${scene.width} x ${scene.height}, on ${setup.gl_renderer}. ` +
      `The truth is ${reference.source}. ${describeNoise()} ` +
      `Displayed by the ${setup.tonemap} curve at exposure ${short(setup.exposure)}.`;
    const legend = document.getElementById('legend');
    for (const method of new Set(rungs.map((rung) => rung.method))) {
      const mark = document.createElement('b');
      mark.style.background = COLORS[method] ?? OTHER_COLOR;
      legend.append(mark, method);
    }
    legend.append('. Large: on the Pareto front.');
  }

  addChoice('metric', 'error', metrics.filter(({ name }) => name !== 'not_finite').map(({ name, title }) => [name, title]));
  addChoice('state', 'of the', Object.entries(STATES));
  if (setup.reference.direct) addChoice('part', 'of', Object.entries(PARTS));
  addChoice('time', 'against', Object.entries(TIMES).map(([name, { title }]) => [name, title]));
  describeSetup();
  drawStrips();
  draw();
})();
