// Whether the presets of the quality table are where measured settings say that they should be:
// near the Pareto front of error and time. Works on figures as accuracy_figures.mjs records them,
// never on times taken now.

/**
 * @typedef {{ name: string, settings: any, frame_ms: number, settle_ms: number, settled: boolean,
 *   metrics: any }} Configuration
 */

export const PRESETS = ['draft', 'interactive', 'high', 'final'];

/** An error over the least of all that is as fast, up to which a preset counts as on the front. */
export const MAX_EXCESS = 1.1;

/** As fast is what is as fast both while the camera moves and until its image has converged. */
const TIMES = ['frame_ms', 'settle_ms'];

const flipOf = (configuration) => configuration.metrics.ldr_flip;

/** What has not settled takes longer than was waited for. */
const timeOf = (configuration, time) =>
  time === 'settle_ms' && !configuration.settled ? Infinity : configuration[time];

const hasFigures = (configuration) =>
  [flipOf(configuration), ...TIMES.map((time) => configuration[time])].every(Number.isFinite);

/**
 * The configuration that is the preset itself, whatever its name.
 * @param {Configuration[]} configurations
 * @returns {Configuration | undefined}
 */
export const configurationOfPreset = (configurations, preset) =>
  configurations.find(
    ({ settings }) =>
      settings.preset === preset && settings.scale === 1 && Object.keys(settings.set).length === 0,
  );

/**
 * The point of the front at a preset's time: of the configurations at most as slow, itself
 * included, the one that errs least.
 * @param {Configuration[]} configurations the configurations of one scene
 * @returns {Configuration | undefined} none if the preset has no figures
 */
export function frontAt(configurations, preset) {
  const own = configurationOfPreset(configurations, preset);
  if (!own || !hasFigures(own)) return undefined;
  const asFast = configurations.filter(
    (configuration) =>
      hasFigures(configuration) &&
      TIMES.every((time) => timeOf(configuration, time) <= timeOf(own, time)),
  );
  return asFast.reduce(
    (best, configuration) => (flipOf(configuration) < flipOf(best) ? configuration : best),
    own,
  );
}

/**
 * Each preset in one scene.
 * @param {{ rungs: Configuration[] }} scene
 * @returns {{ preset: string, own?: Configuration, front?: Configuration, excess: number, isNear:
 *   boolean }[]} `excess`: the preset's LDR-FLIP over the front's, 1 on it; infinite where the
 *   preset was not measured
 */
export function judgePresets({ rungs: configurations }) {
  return PRESETS.map((preset) => {
    const own = configurationOfPreset(configurations, preset);
    const front = frontAt(configurations, preset);
    const excess = !own || !front ? Infinity : front === own ? 1 : flipOf(own) / flipOf(front);
    return { preset, own, front, excess, isNear: excess <= MAX_EXCESS };
  });
}

/** The figures that a preset is judged by. */
function judgedText(configuration) {
  const settling = configuration.settled
    ? `${configuration.settle_ms} ms to settle`
    : `not settled after ${configuration.settle_ms} ms`;
  return `LDR-FLIP ${flipOf(configuration)}, ${configuration.frame_ms} ms a frame, ${settling}`;
}

/**
 * What is wrong with the presets in one scene, a sentence each.
 * @param {{ name: string, rungs: Configuration[] }} scene
 */
export function faultsOf(scene) {
  return judgePresets(scene)
    .filter(({ isNear }) => !isNear)
    .map(({ preset, own, front, excess }) => {
      if (!own) return `${scene.name}: preset ${preset} was not measured`;
      if (!front) return `${scene.name}: preset ${preset} has no figures of error and time`;
      const [more, allowed] = [excess - 1, MAX_EXCESS - 1].map(
        (part) => `${(100 * part).toFixed(1)} %`,
      );
      const [mine, other] = [own, front].map((configuration) => judgedText(configuration));
      return (
        `${scene.name}: preset ${preset} (${mine}) errs ${more} more than ` +
        `configuration ${front.name} (${other}), which is at most as slow; ` +
        `up to ${allowed} is allowed`
      );
    });
}

/**
 * Whether settings beside the presets were measured: without them, any preset is on the front of
 * what there is.
 */
export const hasVariations = ({ rungs: configurations }) =>
  configurations.some(
    (configuration) =>
      configuration.settings.set.gi_method !== 'none' &&
      !PRESETS.some((preset) => configurationOfPreset(configurations, preset) === configuration),
  );

/**
 * Where two quality tables differ, a phrase each; none if they are the same.
 * @param {Record<string, any>} recorded @param {Record<string, any>} present
 */
export function tableChanges(recorded, present) {
  const union = (a, b) => [...new Set([...Object.keys(a ?? {}), ...Object.keys(b ?? {})])];
  const text = (value) => (value === undefined ? 'nothing' : JSON.stringify(value));
  return union(recorded, present).flatMap((preset) =>
    union(recorded[preset], present[preset])
      .map((field) => [field, recorded[preset]?.[field], present[preset]?.[field]])
      .filter(([, before, now]) => before !== now)
      .map(
        ([field, before, now]) =>
          `${preset}.${field}: ${text(before)} when it was measured, ${text(now)} now`,
      ),
  );
}

/**
 * A table of all presets in all scenes.
 * @param {{ title: string, rungs: Configuration[] }[]} scenes
 * @returns {string} Markdown
 */
export function presetTable(scenes) {
  const cell = ({ own, front, excess, isNear }) => {
    if (!own || !front) return '–';
    if (front === own) return 'on it';
    const text = `+${(100 * (excess - 1)).toFixed(1)} % (\`${front.name}\`)`;
    return isNear ? text : `**${text}**`;
  };
  const rows = scenes.map(
    (scene) => `| ${scene.title} | ${judgePresets(scene).map(cell).join(' | ')} |`,
  );
  return [`| scene | ${PRESETS.join(' | ')} |`, '|---|---|---|---|---|', ...rows].join('\n');
}
