// docs/accuracy.md from the results of accuracy runs.
import { join } from 'node:path';
import { writeFileSync } from 'node:fs';

import { buysTable } from './accuracy_buys.mjs';
import { worstWindows } from './accuracy_errors.mjs';
import { sceneFigures } from './accuracy_figures.mjs';
import { MAX_EXCESS, presetTable } from './accuracy_presets.mjs';
import { cropped, readPng, resized, tiled, writePng } from './png.mjs';
import { chartSvg } from './svg.mjs';

const { FIRST_CHOICE, errorOf, frontOf, pointsOf, settingText, short } = globalThis.errorChart;

const PRESETS = ['none', 'draft', 'interactive', 'high', 'final'];
const OVERVIEW_WIDTH = 256; // of each of four images
const WINDOW_WIDTH = 200;

/** @typedef {{ scene: import('./accuracy_scenes.mjs').Scene, folder: string, results: any }} Run */

const table = (head, rows) =>
  [
    `| ${head.join(' | ')} |`,
    `|${head.map(() => '---').join('|')}|`,
    ...rows.map((row) => `| ${row.join(' | ')} |`),
  ].join('\n');

const configurationOf = ({ results }, name) =>
  results.rungs.find((configuration) => configuration.name === name);

/**
 * The configuration whose errors are looked into: the best preset, or whatever is there that errs
 * least.
 */
function bestConfiguration(run) {
  const flip = (configuration) => configuration.converged?.metrics?.ldr_flip ?? Infinity;
  return (
    configurationOf(run, 'final') ?? [...run.results.rungs].sort((a, b) => flip(a) - flip(b))[0]
  );
}

/**
 * A figure; "~" before it where the reference image's own error is more than a tenth of its error.
 */
function figure(results, part, metric, value) {
  if (typeof value !== 'number') return '–';
  const own = results.noise?.[part]?.[metric]?.reference;
  const isSure = typeof own === 'number' && own <= 0.1 * errorOf(metric, value);
  return `${isSure ? '' : '~'}${short(value)}`;
}

const energies = (results, part, values) =>
  ['red', 'green', 'blue']
    .map((color) => figure(results, part, `energy_${color}`, values?.[`energy_${color}`]))
    .join(' ');

/** @param {Run} run @param {any} configuration */
function configurationRow({ results }, configuration, front) {
  const { converged } = configuration;
  const { metrics, indirect } = converged;
  return [
    `${front.has(configuration) ? `**${configuration.name}**` : configuration.name}`,
    short(configuration.frame_ms.median),
    `${short(converged.ms)}${converged.settled ? '' : ' (not settled)'}`,
    short(configuration.memory_bytes / 1048576),
    figure(results, 'metrics', 'ldr_flip', metrics.ldr_flip),
    figure(results, 'metrics', 'ssim', metrics.ssim),
    figure(results, 'metrics', 'rel_mse', metrics.rel_mse),
    energies(results, 'metrics', metrics),
    energies(results, 'indirect', indirect),
    front.has(configuration) ? 'yes' : '',
  ];
}

const ROW_HEAD = [
  'setting',
  'ms a frame',
  'ms to settle',
  'MiB',
  'LDR-FLIP',
  'SSIM',
  'relMSE',
  'energy R G B',
  'indirect energy R G B',
  'front',
];

/** The presets and the front, and all the rest folded away. */
function configurationTables(run) {
  const front = new Set(
    frontOf(pointsOf(run.results.rungs, FIRST_CHOICE)).map(({ configuration }) => configuration),
  );
  const sorted = [...run.results.rungs].sort((a, b) => a.frame_ms.median - b.frame_ms.median);
  const isShown = (configuration) =>
    front.has(configuration) || PRESETS.includes(configuration.name);
  const rows = (list) =>
    table(
      ROW_HEAD,
      list.map((configuration) => configurationRow(run, configuration, front)),
    );
  const parts = [rows(sorted.filter(isShown))];
  const others = sorted.filter((configuration) => !isShown(configuration));
  const meanings = sorted
    .map((configuration) => `- \`${configuration.name}\`: ${settingText(configuration)}`)
    .join('\n');
  if (others.length > 0)
    parts.push(
      `<details><summary>${others.length} more</summary>\n\n${rows(others)}\n\n</details>`,
    );
  parts.push(`<details><summary>What the names mean</summary>\n\n${meanings}\n\n</details>`);
  return parts.join('\n\n');
}

/** What is known of the reference image's own error, and by which measures it is too much. */
function noiseText({ results }) {
  const { reference } = results.setup;
  const total =
    typeof reference.noise === 'number' ? `${short(100 * reference.noise)} %` : 'not known';
  const tooMuch = [
    ['metrics', 'all light'],
    ['indirect', 'indirect light'],
  ].flatMap(([part, of]) => {
    const titles = results.metrics
      .filter(({ name }) => results.noise?.[part]?.[name]?.enough === false)
      .map(({ title }) => title);
    return titles.length > 0 ? `${titles.join(', ')} of ${of}` : [];
  });
  const own = results.noise?.metrics?.ldr_flip;
  const flip = own
    ? ` By LDR-FLIP it errs by ${short(own.reference)} itself, and the smallest error shown is ` +
      `${short(own.smallest)}.`
    : '';
  const verdict =
    tooMuch.length === 0
      ? 'By every measure that is less than a tenth of the smallest error.'
      : 'That is more than a tenth of the smallest error by these measures: ' +
        `${tooMuch.join('; ')}. Figures with “~” are no surer.`;
  const text = `${total} (standard error of pixels over the mean)`;
  return `Noise of the reference: ${text}.${flip} ${verdict}`;
}

/** Writes the images of a scene; returns the Markdown that shows them. */
function scenePictures(run, folder) {
  const { scene, results } = run;
  const best = bestConfiguration(run);
  const cheap = configurationOf(run, 'interactive') ?? best;
  const read = (file) => readPng(join(run.folder, file));
  const [reference, picture, map] = [
    read('reference.png'),
    read(best.pictures.converged),
    read(best.pictures.error),
  ];
  const small = [reference, read(cheap.pictures.converged), picture, map].map((one) =>
    resized(one, OVERVIEW_WIDTH),
  );
  writePng(join(folder, `${scene.name}.png`), tiled([small.slice(0, 2), small.slice(2)]));
  const windows = worstWindows(map);
  const crops = windows.map((window) =>
    [reference, picture, map].map((one) => resized(cropped(one, window), WINDOW_WIDTH)),
  );
  writePng(join(folder, `${scene.name}-errors.png`), tiled(crops));
  writeFileSync(join(folder, `${scene.name}.svg`), chartSvg(results, FIRST_CHOICE));
  const errors = windows.map(
    ({ x, y, width, height, error }) =>
      `LDR-FLIP ${short(error)} around (${x + (width >> 1)}, ${y + (height >> 1)})`,
  );
  return [
    `![Error against time of ${scene.title}](accuracy/${scene.name}.svg)`,
    `![Reference image, ${cheap.name}, ${best.name} and its errors](accuracy/${scene.name}.png)`,
    `Above: the reference image and \`${cheap.name}\`; below: \`${best.name}\` and where it ` +
      'errs (LDR-FLIP, black 0 to pale yellow 1).',
    `![The largest errors: reference image, ${best.name}, ` +
      `error](accuracy/${scene.name}-errors.png)`,
    `The largest errors of \`${best.name}\` (reference image, image, error), from the worst: ` +
      `${errors.join('; ')}.`,
  ].join('\n\n');
}

function sceneSection(run, folder) {
  const { scene, results } = run;
  const { width, height } = results.setup.scene;
  return [
    `### ${scene.title}`,
    `${scene.about} ${width} x ${height} pixels, ${results.rungs.length} settings.`,
    scenePictures(run, folder),
    noiseText(run),
    configurationTables(run),
  ].join('\n\n');
}

/** Error of each preset in each scene. */
function overview(runs) {
  const rows = runs.map((run) => {
    const flips = PRESETS.map((name) =>
      figure(
        run.results,
        'metrics',
        'ldr_flip',
        configurationOf(run, name)?.converged.metrics.ldr_flip,
      ),
    );
    const { metrics, indirect } = bestConfiguration(run).converged;
    const { noise } = run.results.setup.reference;
    return [
      run.scene.title,
      ...flips,
      figure(run.results, 'metrics', 'ssim', metrics.ssim),
      energies(run.results, 'indirect', indirect),
      typeof noise === 'number' ? `${short(100 * noise)} %` : '–',
    ];
  });
  return table(
    ['scene', ...PRESETS, 'SSIM of final', 'indirect energy of final', 'noise of the reference'],
    rows,
  );
}

const INTRO = `<!-- Written by ./dev accuracy; the last chapter is kept in accuracy/causes.md. -->
# Accuracy

How far images are from the reference image, and what less error costs. The reference image is the
path tracer's, of the same scene, camera and size. Each setting is measured in a scene that has just
been loaded: the median frame of a moving camera, the time until the image has converged, and the
error of the converged image.

**LDR-FLIP** is that of the displayed image at one fixed exposure, 0 to 1: for scale, an image
uniformly 10 % too bright scores about 0.15, one 2 % too bright 0.05. **Energy** is the mean of a
channel over the reference image's: 1 is right. **Indirect** is without the light of emitters that
was reflected once. **Front**: no other setting is both faster and less wrong; its names are bold.
**~** before a figure: the reference image's own error, by the same measure, is more than a tenth of
the error shown.`;

const PRESETS_INTRO = `How much more each preset errs than the best setting that is as fast and has
settled as soon. A test reads these figures from [accuracy/figures.json](accuracy/figures.json) and
allows up to ${(100 * (MAX_EXCESS - 1)).toFixed(0)} % in the built-in scenes; what is beyond is
bold.`;

/**
 * Writes accuracy.md and its images.
 * @param {{ runs: Run[], missing: import('./accuracy_scenes.mjs').Scene[], machine: string, causes:
 *   string, folder: string }} params `folder`: that of the page; images go into its folder
 *   "accuracy"
 */
export function writePage({ runs, missing, machine, causes, folder }) {
  const buys = buysTable(runs.map(({ results }) => results.rungs));
  const parts = [INTRO, machine, '## All scenes', 'LDR-FLIP of each preset.', overview(runs)];
  if (missing.length > 0)
    parts.push(`Not measured: ${missing.map(({ title }) => title).join(', ')}.`);
  parts.push(
    '## Presets and the front',
    PRESETS_INTRO,
    presetTable(runs.map((run) => ({ title: run.scene.title, ...sceneFigures(run) }))),
  );
  parts.push(
    '## Scene by scene',
    ...runs.map((run) => sceneSection(run, join(folder, 'accuracy'))),
  );
  parts.push('## What each setting buys');
  parts.push(
    buys
      ? 'Pairs of settings that differ in one step, over all scenes: the median change, and ' +
          'the least and the most. Less error is better; so is less time.'
      : 'The sweep that was measured has no settings that differ in one step; the full one has.',
  );
  if (buys) parts.push(buys);
  parts.push('## Where it is wrong and why', causes.trim());
  writeFileSync(join(folder, 'accuracy.md'), `${parts.join('\n\n')}\n`);
}
