// Charts of error against time, for the page of an accuracy run, for the panel and for pages that
// node writes: time and error of a configuration, the Pareto front, and the shapes that show them.
//
// The page is opened from the disk, where it may load no modules. So this is a plain script that
// leaves everything in globalThis.errorChart. panel/error_chart.js names it for modules.

/** @typedef {{ name: string, title: string, unit: string }} Metric */
/** @typedef {{ metric: string, time: string, state: string, part: string }} Choice what is drawn */
/** @typedef {{ ms: number, error: number, configuration: any }} Point */
/** @typedef {{ left: number, right: number, top: number, bottom: number }} Area */
/**
 * @typedef {{ tag: string, attributes: Record<string, string | number>, text?: string, point?:
 *   Point }} Shape
 */

globalThis.errorChart = (() => {
  const COLORS = { none: '#8a8f99', clipmap: '#d9622b', grid: '#2b7fd9' };
  const OTHER_COLOR = '#3a9a5b';
  const MARK_RADIUS = 7;
  const LETTER_WIDTH = 6; // width of a letter, roughly
  const LETTER_HEIGHT = 11;
  const TICK_STEPS = [[1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 3, 5], [1, 2, 5], [1, 3], [1]];

  /** The times of a configuration; `short` is for narrow charts. */
  const TIMES = {
    frame: {
      title: 'median frame of a moving camera, ms',
      short: 'frame, ms',
      get: (configuration) => configuration.frame_ms.median,
    },
    cold: {
      title: 'first image of a scene just loaded, ms',
      short: 'first image, ms',
      get: (configuration) => configuration.cold.ms,
    },
    converged: {
      title: 'from the loaded scene to the final image, ms',
      short: 'final image, ms',
      get: (configuration) => configuration.converged.ms,
    },
    edit: {
      title: 'from an edit of a light to 95 % of its change, ms',
      short: 'edit of a light, ms',
      get: (configuration) => configuration.edit?.arrived_ms,
    },
  };
  const STATES = { converged: 'final image', cold: 'first image' };
  const PARTS = { metrics: 'all light', indirect: 'indirect light alone' };
  const FIRST_CHOICE = { metric: 'ldr_flip', time: 'frame', state: 'converged', part: 'metrics' };

  const colorOf = (method) => COLORS[method] ?? OTHER_COLOR;

  /**
   * The error that a metric's value stands for: 0 is perfect; null without a value. As in
   * image_metric_error().
   */
  function errorOf(metric, value) {
    if (typeof value !== 'number') return null;
    if (metric.startsWith('energy_')) return Math.abs(value - 1);
    if (metric === 'ssim') return 1 - value;
    if (metric === 'psnr') return 10 ** (-value / 20);
    return value;
  }

  /** @param {Metric} metric */
  function errorTitle({ name, title, unit }) {
    if (name.startsWith('energy_')) return `distance of ${title} from 1`;
    if (name === 'ssim') return '1 - SSIM';
    if (name === 'psnr') return 'RMSE of displayed values (from PSNR)';
    return unit ? `${title}, ${unit}` : title;
  }

  /** Three digits, or a dash. */
  const short = (value) => (typeof value === 'number' ? String(Number(value.toPrecision(3))) : '–');

  /** The value of a metric of a configuration, as its entry has it. @param {Choice} choice */
  const valueOf = (configuration, choice, metric = choice.metric) =>
    configuration[choice.state]?.[choice.part]?.[metric];

  /** @returns {Point[]} what can be drawn on logarithmic axes */
  function pointsOf(configurations, choice) {
    return configurations
      .map((configuration) => ({
        configuration,
        ms: TIMES[choice.time].get(configuration),
        error: errorOf(choice.metric, valueOf(configuration, choice)),
      }))
      .filter(({ ms, error }) => ms > 0 && error > 0);
  }

  /** The points for which no other is both faster and less wrong, from fast to slow. */
  function frontOf(points) {
    const front = [];
    for (const point of [...points].sort((a, b) => a.ms - b.ms || a.error - b.error))
      if (front.length === 0 || point.error < front.at(-1).error) front.push(point);
    return front;
  }

  /** The settings of a configuration in words. */
  function settingText({ settings }) {
    const sets = Object.entries(settings.set).map(([key, value]) => `${key} ${value}`);
    const scale = settings.scale === 1 ? [] : [`scale ${settings.scale}`];
    return [`preset ${settings.preset}`, ...scale, ...sets].join(', ');
  }

  /** The densest ticks between two powers of ten whose labels have room. */
  function ticksOf(low, high, scale, room) {
    for (const steps of TICK_STEPS) {
      const ticks = [];
      for (let decade = Math.floor(low); decade <= high; decade++)
        for (const step of steps) {
          const value = step * 10 ** decade;
          if (Math.log10(value) >= low && Math.log10(value) <= high) ticks.push(value);
        }
      if (ticks.every((tick, i) => i === 0 || Math.abs(scale(tick) - scale(ticks[i - 1])) >= room))
        return ticks;
    }
    return [];
  }

  /** Maps a range of values, widened a little, to a range of the chart. */
  function logScale(values, from, to, room) {
    let low = Math.log10(Math.min(...values));
    let high = Math.log10(Math.max(...values));
    const margin = Math.max(0.06 * (high - low), 0.05);
    low -= margin;
    high += margin;
    const scale = (value) => from + ((Math.log10(value) - low) / (high - low)) * (to - from);
    return { scale, ticks: ticksOf(low, high, scale, room) };
  }

  function axisShapes({ x, y, area, titles }) {
    const { left, right, top, bottom } = area;
    const shapes = [];
    for (const tick of x.ticks) {
      const at = x.scale(tick);
      shapes.push({
        tag: 'line',
        attributes: { class: 'grid', x1: at, x2: at, y1: top, y2: bottom },
      });
      shapes.push({
        tag: 'text',
        attributes: { x: at, y: bottom + 16, 'text-anchor': 'middle' },
        text: short(tick),
      });
    }
    for (const tick of y.ticks) {
      const at = y.scale(tick);
      shapes.push({
        tag: 'line',
        attributes: { class: 'grid', x1: left, x2: right, y1: at, y2: at },
      });
      shapes.push({
        tag: 'text',
        attributes: { x: left - 6, y: at + 4, 'text-anchor': 'end' },
        text: short(tick),
      });
    }
    const middle = { x: (left + right) / 2, y: (top + bottom) / 2 };
    shapes.push({
      tag: 'text',
      attributes: { x: middle.x, y: bottom + 34, 'text-anchor': 'middle' },
      text: titles.x,
    });
    const turned = { transform: `translate(12 ${middle.y}) rotate(-90)`, 'text-anchor': 'middle' };
    shapes.push({ tag: 'text', attributes: turned, text: titles.y });
    return shapes;
  }

  /** A dotted line with a label: the reference image's own error, or a limit of time. */
  function limitShapes({ x, y, area }, noise, budgetMs) {
    const { left, right, top, bottom } = area;
    const shapes = [];
    const height = noise > 0 ? y.scale(noise) : NaN;
    if (height <= bottom && height >= top) {
      shapes.push({
        tag: 'line',
        attributes: { class: 'noise', x1: left, x2: right, y1: height, y2: height },
      });
      const at = { class: 'limit', x: right, y: height - 5, 'text-anchor': 'end' };
      shapes.push({ tag: 'text', attributes: at, text: 'noise of the reference image' });
    }
    const position = budgetMs > 0 ? x.scale(budgetMs) : NaN;
    if (position >= left && position <= right)
      shapes.push({
        tag: 'line',
        attributes: { class: 'budget', x1: position, x2: position, y1: top, y2: bottom },
      });
    return shapes;
  }

  const meets = (a, b) =>
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

  /** Where a name may stand beside a mark: the best position first. */
  function labelPositions(text, cx, cy, area) {
    const width = LETTER_WIDTH * text.length;
    const isLeftFirst = cx > area.left + 0.6 * (area.right - area.left);
    const sides = isLeftFirst ? ['end', 'start'] : ['start', 'end'];
    return [-7, 16].flatMap((rise) =>
      sides.map((anchor) => {
        const x = cx + (anchor === 'end' ? -11 : 11);
        const left = anchor === 'end' ? x - width : x;
        return {
          x,
          y: cy + rise,
          anchor,
          left,
          right: left + width,
          top: cy + rise - LETTER_HEIGHT,
          bottom: cy + rise,
        };
      }),
    );
  }

  /** Names of points, the required ones first, where they cover no other name and no mark. */
  function labelShapes(labelled, all, { x, y, area }) {
    const taken = all.map(({ ms, error }) => {
      const [cx, cy] = [x.scale(ms), y.scale(error)];
      return {
        left: cx - MARK_RADIUS,
        right: cx + MARK_RADIUS,
        top: cy - MARK_RADIUS,
        bottom: cy + MARK_RADIUS,
      };
    });
    const shapes = [];
    for (const { point, mustShow } of [...labelled].sort(
      (a, b) => Number(b.mustShow) - Number(a.mustShow),
    )) {
      const { name } = point.configuration;
      const positions = labelPositions(name, x.scale(point.ms), y.scale(point.error), area);
      const fits = ({ left, right, bottom }) =>
        left >= area.left && right <= area.right && bottom <= area.bottom;
      const position =
        positions.find((one) => fits(one) && !taken.some((other) => meets(one, other))) ??
        (mustShow ? positions[0] : null);
      if (!position) continue;
      taken.push(position);
      shapes.push({
        tag: 'text',
        attributes: { class: 'name', x: position.x, y: position.y, 'text-anchor': position.anchor },
        text: name,
      });
    }
    return shapes;
  }

  function pointShape(point, { x, y }, { isLarge, isLive }) {
    const { name, method } = point.configuration;
    const attributes = {
      class: isLive ? 'point live' : 'point',
      cx: x.scale(point.ms),
      cy: y.scale(point.error),
      r: isLarge ? MARK_RADIUS : 5,
      fill: colorOf(method),
      'aria-label': `${name}: ${short(point.ms)} ms, error ${short(point.error)}`,
      'data-configuration': name,
    };
    return { tag: 'circle', attributes, point };
  }

  /** Marks the live configuration, or the selected one. */
  const ringShape = (point, { x, y }, name) => ({
    tag: 'circle',
    attributes: {
      class: `ring ${name}`,
      cx: x.scale(point.ms),
      cy: y.scale(point.error),
      r: MARK_RADIUS + 4,
    },
  });

  /**
   * What the chart consists of, in the order of drawing.
   * @param {{ results: any, choice: Choice, width: number, height: number, live?: string, chosen?:
   *   string, budgetMs?: number, isNarrow?: boolean, labels?: 'front' | 'marked' }} params `live`
   *   and `chosen` are names of configurations with a ring around them
   * @returns {Shape[]}
   */
  function shapesOf({
    results,
    choice,
    width,
    height,
    live,
    chosen,
    budgetMs = 0,
    isNarrow = false,
    labels = 'front',
  }) {
    const points = pointsOf(results.rungs, choice);
    if (points.length === 0) {
      const at = { x: width / 2, y: height / 2, 'text-anchor': 'middle' };
      return [{ tag: 'text', attributes: at, text: 'No setting has values for this.' }];
    }
    const front = frontOf(points);
    const area = { left: isNarrow ? 50 : 64, right: width - 12, top: 12, bottom: height - 42 };
    const metric = results.metrics.find(({ name }) => name === choice.metric);
    const time = TIMES[choice.time];
    const frame = {
      x: logScale(points.map(({ ms }) => ms), area.left, area.right, isNarrow ? 26 : 34),
      y: logScale(points.map(({ error }) => error), area.bottom, area.top, 20),
      area,
      titles: {
        x: isNarrow ? time.short : time.title,
        y: isNarrow ? (metric?.title ?? '') : errorTitle(metric),
      },
    };
    const corners = front.map(({ ms, error }, i) => {
      const from = i > 0 ? `H${frame.x.scale(ms)}V` : `M${frame.x.scale(ms)} `;
      return from + frame.y.scale(error);
    });
    const noise = results.noise?.[choice.part]?.[choice.metric]?.reference ?? 0;
    const shapes = [
      ...axisShapes(frame),
      ...limitShapes(frame, noise, choice.time === 'frame' ? budgetMs : 0),
    ];
    shapes.push({ tag: 'path', attributes: { class: 'front', d: corners.join('') } });
    const ringOf = ({ configuration: { name } }) =>
      name === chosen ? 'chosen' : name === live ? 'live' : '';
    // Marked points are drawn on top of the rest.
    const ordered = [...points].sort((a, b) => Number(ringOf(a) !== '') - Number(ringOf(b) !== ''));
    for (const point of ordered)
      shapes.push(
        pointShape(point, frame, {
          isLarge: front.includes(point),
          isLive: point.configuration.name === live,
        }),
      );
    for (const point of ordered)
      if (ringOf(point)) shapes.push(ringShape(point, frame, ringOf(point)));
    const labelled = points
      .filter((point) => ringOf(point) || (labels === 'front' && front.includes(point)))
      .map((point) => ({ point, mustShow: ringOf(point) !== '' }));
    shapes.push(...labelShapes(labelled, points, frame));
    return shapes;
  }

  return {
    TIMES,
    STATES,
    PARTS,
    FIRST_CHOICE,
    colorOf,
    errorOf,
    errorTitle,
    short,
    valueOf,
    pointsOf,
    frontOf,
    settingText,
    shapesOf,
  };
})();
