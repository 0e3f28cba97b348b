// The page of an accuracy run: a chart of error against time, a table, and images, from what
// results.js has left in globalThis.results. Opened from the disk, so it is no module and loads
// nothing.

(() => {
  const { setup, metrics, rungs: configurations } = globalThis.results;
  const {
    TIMES,
    STATES,
    PARTS,
    FIRST_CHOICE,
    colorOf,
    frontOf,
    pointsOf,
    settingText,
    short,
    valueOf,
  } = globalThis.errorChart;
  const SIZE = { width: 1000, height: 560 };
  const choice = { ...FIRST_CHOICE };

  const metricOf = (name) => metrics.find((metric) => metric.name === name);
  const tip = document.getElementById('tip');
  const svg = document.getElementById('chart');

  function showTip({ configuration, ms }, mark) {
    tip.replaceChildren();
    const title = document.createElement('b');
    title.textContent = configuration.name;
    const text = document.createElement('div');
    text.textContent =
      `${settingText(configuration)}. ${short(ms)} ms; ` +
      `${metricOf(choice.metric).title} ${short(valueOf(configuration, choice))}; ` +
      `${short(configuration.memory_bytes / 1048576)} MiB`;
    const picture = document.createElement('img');
    picture.src = configuration.pictures.converged;
    picture.alt = `Final image of ${configuration.name}`;
    tip.append(title, text, picture);
    tip.hidden = false;
    // The chart may be drawn smaller than its own coordinates.
    const ratio = svg.clientWidth / SIZE.width;
    const [x, y] = ['cx', 'cy'].map((name) => Number(mark.getAttribute(name)));
    const left = x > 600 ? Math.max(x * ratio - tip.offsetWidth - 15, 0) : x * ratio + 15;
    tip.style.left = `${left}px`;
    tip.style.top = `${Math.max(Math.min(y * ratio, svg.clientHeight - tip.offsetHeight), 0)}px`;
  }

  const chart = new globalThis.ErrorChartView(svg, {
    label: 'Settings, from fast to slow',
    onShow: showTip,
    onHide: () => {
      tip.hidden = true;
    },
    onChoose: ({ configuration }) => {
      const strip = document.getElementById(`strip-${configuration.name}`);
      strip.open = true;
      strip.scrollIntoView();
    },
  });

  /** The reference image's own error by the chosen metric, as a sentence. */
  function describeOwnError() {
    const noise = globalThis.results.noise[choice.part]?.[choice.metric];
    document.getElementById('noise').textContent = noise
      ? `By this measure the reference image itself errs by ${short(noise.reference)}; the ` +
        `smallest error of a final image is ${short(noise.smallest)}. ` +
        (noise.enough
          ? 'That is little enough.'
          : 'That is more than a tenth: it needs more samples.')
      : 'The error of the reference image itself is not known.';
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
    for (const text of [
      'configuration',
      'frame ms',
      'first ms',
      'final ms',
      'edit ms',
      'MiB',
      ...metrics.map(({ title }) => title),
    ])
      cell(head, text, 'th');
    const body = table.createTBody();
    const front = new Set(
      frontOf(pointsOf(configurations, choice)).map(({ configuration }) => configuration),
    );
    for (const configuration of [...configurations].sort(
      (a, b) => a.frame_ms.median - b.frame_ms.median,
    )) {
      const row = body.insertRow();
      row.className = front.has(configuration) ? 'on-front' : '';
      row.title = settingText(configuration);
      cell(row, configuration.name);
      for (const { get } of Object.values(TIMES)) cell(row, short(get(configuration)));
      cell(row, short(configuration.memory_bytes / 1048576));
      for (const { name } of metrics) cell(row, short(valueOf(configuration, choice, name)));
    }
  }

  function drawStrips() {
    const strips = document.getElementById('strips');
    for (const configuration of configurations) {
      const strip = document.createElement('details');
      strip.id = `strip-${configuration.name}`;
      const summary = document.createElement('summary');
      summary.textContent = `${configuration.name}: ${settingText(configuration)}`;
      const picture = document.createElement('img');
      picture.loading = 'lazy';
      picture.src = configuration.pictures.strip;
      picture.alt =
        'Reference image, first image, final image and error of ' + configuration.name;
      const passes = document.createElement('p');
      const times = Object.entries(configuration.pass_ms ?? {}).sort(([, a], [, b]) => b - a);
      const passTimes = times.map(([name, ms]) => `${name} ${short(ms)}`).join(', ');
      passes.textContent = `Median ms of passes: ${passTimes}.`;
      strip.append(summary, picture, passes);
      strips.append(strip);
    }
  }

  function draw() {
    chart.draw({ results: globalThis.results, choice, ...SIZE });
    describeOwnError();
    drawTable();
  }

  /** A drop-down for one of the fields of `choice`. */
  function addChoice(field, label, options) {
    const wrapper = document.createElement('label');
    wrapper.textContent = `${label} `;
    const select = document.createElement('select');
    select.name = field;
    for (const [value, text] of options)
      select.append(new Option(text, value, false, value === choice[field]));
    select.addEventListener('change', () => {
      choice[field] = select.value;
      draw();
    });
    wrapper.append(select);
    document.getElementById('choice').append(wrapper);
  }

  function describeNoise() {
    const { reference } = setup;
    if (typeof reference.noise !== 'number') return 'Its noise is not known.';
    const noise = short(100 * reference.noise);
    return `Its noise (standard error of pixels over the mean) is ${noise} %.`;
  }

  function describeSetup() {
    const { scene, reference } = setup;
    document.getElementById('setup').textContent =
      `${scene.source}, ${scene.width} x ${scene.height}, on ${setup.gl_renderer}. ` +
      `The reference image is ${reference.source}. ${describeNoise()} ` +
      `Displayed by the ${setup.tonemap} curve at exposure ${short(setup.exposure)}.`;
    const legend = document.getElementById('legend');
    for (const method of new Set(configurations.map((configuration) => configuration.method))) {
      const mark = document.createElement('b');
      mark.style.background = colorOf(method);
      legend.append(mark, method);
    }
    legend.append('. Large: on the Pareto front.');
  }

  addChoice(
    'metric',
    'error',
    metrics.filter(({ name }) => name !== 'not_finite').map(({ name, title }) => [name, title]),
  );
  addChoice('state', 'of the', Object.entries(STATES));
  if (setup.reference.direct) addChoice('part', 'of', Object.entries(PARTS));
  addChoice('time', 'against', Object.entries(TIMES).map(([name, { title }]) => [name, title]));
  describeSetup();
  drawStrips();
  draw();
})();
