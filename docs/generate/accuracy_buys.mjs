// What each setting buys: pairs of configurations that differ in one setting by one step.
import '../../web_client/report/error_chart.js';

const { errorOf } = globalThis.errorChart;

/**
 * Steps of each setting, from cheap to dear; null is the default, where it has a place among them.
 */
const STEPS =
  /** @type {Record<string, { title: string, values: (string | null)[], isDefault?: string }>} */ ({
    voxel_resolution: { title: 'voxels along an edge', values: ['64', '128', '256'] },
    gather_mode: { title: 'where cones start', values: ['cache', 'half', 'pixel'] },
    cone_set: { title: 'cones', values: ['5', '6', '16', '32'] },
    cone_step: { title: 'length of a cone’s steps', values: ['2', '0.5', '0.25'] },
    bounces: { title: 'bounces', values: ['1', '2', '4', null], isDefault: 'unlimited' },
    clip_levels: { title: 'levels of the clipmap', values: ['1', '2', '4', '6'] },
    voxel_directions: {
      title: 'directions of a voxel',
      values: ['isotropic', null],
      isDefault: 'anisotropic',
    },
    scale: { title: 'resolution over that shown', values: ['0.5', null, '2'], isDefault: '1' },
  });

/** All that a configuration is, as text by key. */
function factsOf({ method, settings }) {
  const { gi_method: _method, ...set } = settings.set;
  return {
    method,
    preset: settings.preset,
    ...(settings.scale === 1 ? {} : { scale: String(settings.scale) }),
    ...set,
  };
}

const keyOf = (facts) => JSON.stringify(Object.entries(facts).sort(([a], [b]) => (a < b ? -1 : 1)));

const fractionOf = (after, before) => (before > 0 && after > 0 ? after / before - 1 : null);

/** How much more (1: twice, -0.5: half) each thing is after a step. */
function changesOf(before, after) {
  const error = (configuration, part) =>
    errorOf('ldr_flip', configuration.converged?.[part]?.ldr_flip);
  return {
    error: fractionOf(error(after, 'metrics'), error(before, 'metrics')),
    indirect: fractionOf(error(after, 'indirect'), error(before, 'indirect')),
    frame: fractionOf(after.frame_ms.median, before.frame_ms.median),
    settled: fractionOf(after.converged.ms, before.converged.ms),
    memory: fractionOf(after.memory_bytes, before.memory_bytes),
  };
}

/**
 * @param {any[]} configurations the configurations of one run
 * @returns {{ key: string, from: string, to: string, changes: any }[]} one for each pair of
 *   configurations
 */
export function stepsOf(configurations) {
  const byFacts = new Map(
    configurations.map((configuration) => [keyOf(factsOf(configuration)), configuration]),
  );
  const steps = [];
  for (const [key, { values, isDefault }] of Object.entries(STEPS))
    for (const configuration of configurations) {
      const { [key]: value = null, ...others } = factsOf(configuration);
      const at = values.indexOf(value);
      const withValue = (other) =>
        byFacts.get(keyOf(other === null ? others : { ...others, [key]: other }));
      const next = at < 0 ? undefined : values.slice(at + 1).find(withValue);
      if (next === undefined) continue;
      steps.push({
        key,
        from: value ?? isDefault,
        to: next ?? isDefault,
        changes: changesOf(configuration, withValue(next)),
      });
    }
  return steps;
}

const percent = (value) =>
  `${value > 0 ? '+' : value < 0 ? '−' : ''}${Math.abs(100 * value).toFixed(0)} %`;

/** Median, and the range where there are several. */
function summary(values) {
  const known = values.filter((value) => value !== null).sort((a, b) => a - b);
  if (known.length === 0) return '–';
  const median = known[known.length >> 1];
  return known.length === 1
    ? percent(median)
    : `${percent(median)} (${percent(known[0])} to ${percent(known.at(-1))})`;
}

/** A table of all steps, over all runs. @param {any[][]} runs @returns {string} Markdown, or "" */
export function buysTable(runs) {
  const groups = new Map();
  for (const step of runs.flatMap(stepsOf)) {
    const name = `${STEPS[step.key].title}: ${step.from} → ${step.to}`;
    groups.set(name, [...(groups.get(name) ?? []), step.changes]);
  }
  if (groups.size === 0) return '';
  const rows = [...groups].map(([name, changes]) => {
    const cells = ['error', 'indirect', 'frame', 'settled', 'memory'].map((part) =>
      summary(changes.map((change) => change[part])),
    );
    return `| ${name} | ${changes.length} | ${cells.join(' | ')} |`;
  });
  return [
    '| step | pairs | LDR-FLIP | of indirect light | frame | until settled | memory |',
    '|---|---|---|---|---|---|---|',
    ...rows,
  ].join('\n');
}
