// docs/accuracy/figures.json: what accuracy runs have measured, small enough to be kept beside the
// sources, so that tests can judge presets by it. One line a configuration, in the order of names:
// what changes shows in a diff.

const METRICS = ['ldr_flip', 'rel_mse', 'ssim', 'energy_red', 'energy_green', 'energy_blue'];
const DIGITS = 4;

/** @typedef {import('./accuracy_page.mjs').Run} Run */

/** Null where there is no number. */
const rounded = (value, digits = DIGITS) =>
  Number.isFinite(value) ? Number(value.toPrecision(digits)) : null;

function configurationFigures({ name, settings, frame_ms, converged }) {
  const { preset, scale, set } = settings;
  return {
    name,
    settings: { preset, scale, set },
    frame_ms: rounded(frame_ms.median),
    settle_ms: rounded(converged.ms),
    settled: converged.settled,
    metrics: Object.fromEntries(
      METRICS.map((metric) => [metric, rounded(converged.metrics[metric])]),
    ),
  };
}

/**
 * @param {Run} run
 * @returns {any} its entry in figures.json; paths are those below the folder of scenes
 */
export function sceneFigures({ scene, results }) {
  const { width, height } = results.setup.scene;
  return {
    name: scene.name,
    source: scene.source ?? scene.path,
    width,
    height,
    truth: {
      noise: rounded(results.setup.reference.noise),
      ldr_flip: rounded(results.noise?.metrics?.ldr_flip?.reference),
    },
    rungs: results.rungs.map(configurationFigures).sort((a, b) => (a.name < b.name ? -1 : 1)),
  };
}

/**
 * The quality table that all runs were measured with; throws if there is no such.
 * @param {Run[]} runs
 */
function commonTable(runs) {
  const [first] = runs;
  for (const { scene, results } of runs) {
    const { quality } = results.setup;
    if (!quality)
      throw new Error(
        `the results of ${scene.name} do not tell the quality table; it must be measured anew`,
      );
    if (JSON.stringify(quality) !== JSON.stringify(first.results.setup.quality))
      throw new Error(
        `${first.scene.name} and ${scene.name} were measured with different quality tables; ` +
          'measure the older one anew',
      );
  }
  return first.results.setup.quality;
}

/**
 * @param {Run[]} runs at least one
 * @param {{ processor: string, cores: number, gl_renderer: string }} machine that they were
 *   measured on
 * @returns {{ machine: any, quality: Record<string, any>, scenes: any[] }}
 * @throws if the runs are not of one quality table
 */
export const figuresOf = (runs, machine) => ({
  machine,
  quality: commonTable(runs),
  scenes: runs.map(sceneFigures),
});

/** The file's text: JSON, of which a row of the table and a configuration are a line each. */
export function figuresText({ machine, quality, scenes }) {
  const line = (value) => JSON.stringify(value);
  const rows = Object.entries(quality).map(([preset, row]) => `    ${line(preset)}: ${line(row)}`);
  const blocks = scenes.map(({ rungs: configurations, ...facts }) => {
    const lines = configurations.map((configuration) => `      ${line(configuration)}`).join(',\n');
    return `    {${line(facts).slice(1, -1)}, "rungs": [\n${lines}\n    ]}`;
  });
  return [
    '{',
    `  "machine": ${line(machine)},`,
    `  "quality": {\n${rows.join(',\n')}\n  },`,
    `  "scenes": [\n${blocks.join(',\n')}\n  ]`,
    '}',
    '',
  ].join('\n');
}
