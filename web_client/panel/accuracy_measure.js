import { durationText, percentText } from '../accuracy/words.js';
import { element } from '../ui/element.js';
import { makeSection } from './sections.js';

/** The server's range for the wanted noise, in percent. */
const NOISE = { min: 0.05, max: 10, step: 0.05 };
/** How long it may take, in seconds. */
const TIMES = { '20 s': 20, '1 min': 60, '2 min': 120, '5 min': 300, '20 min': 1200, '1 h': 3600 };
const SWEEPS = { 'Quick: the presets': 'quick', 'Full: each setting': 'full' };

/** The form that starts a measurement of the view, and its progress. */
export class AccuracyMeasure {
  /** @param {HTMLElement} root @param {import('./app_context.js').AppContext} app */
  constructor(root, app) {
    this.app = app;
    this.choice = { sweep: 'quick', noise: 1, seconds: 120 };
    const gui = makeSection(root, 'Measurement');
    const sweep = gui.add(this.choice, 'sweep', SWEEPS).name('Settings');
    sweep.domElement.title =
      'Which settings are measured: a few presets, or all that differ in one thing.';
    const noise = gui
      .add(this.choice, 'noise', NOISE.min, NOISE.max, NOISE.step)
      .name('Noise of the reference (%)');
    noise.domElement.title =
      'The reference image is traced until its pixels err by no more than this. Less takes ' +
      'longer: half the noise, four times the time.';
    const seconds = gui.add(this.choice, 'seconds', TIMES).name('At most for');
    seconds.domElement.title =
      'Light through glass may take hours to be rid of noise. The chart tells what noise is left.';
    this.begin = element(
      'button',
      { type: 'button', onclick: () => this.#start() },
      'Measure this view',
    );
    this.stop = element('button', { type: 'button', onclick: () => this.#cancel() }, 'Cancel');
    this.text = element('p', { class: 'hint' });
    this.bar = element('progress', { max: 1, 'aria-label': 'Progress of the measurement' });
    // Screen readers announce the steps, not every half second.
    this.step = element('p', { class: 'visually-hidden', role: 'status' });
    root.append(
      element('div', { class: 'actions' }, this.begin, this.stop),
      this.bar,
      this.text,
      this.step,
    );
    for (const event of ['changed', 'begun'])
      app.measurement.addEventListener(event, () => this.refresh());
    app.connection.addEventListener('state', () => this.refresh());
    this.refresh();
  }

  refresh() {
    const { measurement, connection } = this.app;
    const { isRunning } = measurement;
    this.begin.disabled = isRunning || !connection.isOpen;
    this.stop.hidden = !isRunning;
    this.bar.hidden = !isRunning;
    this.#showBar(measurement.progress);
    this.text.textContent = describeProgress(measurement.progress);
    const step = describeStep(measurement.progress);
    if (this.step.textContent !== step) this.step.textContent = step;
  }

  #showBar(/** @type {any} */ progress) {
    const value = fractionDone(progress);
    if (value === null) this.bar.removeAttribute('value');
    else this.bar.value = value;
  }

  async #start() {
    this.begin.disabled = true;
    const { sweep, noise, seconds } = this.choice;
    try {
      // The image must not follow the measurement that this one replaces.
      if (this.app.view.configuration) await this.app.view.chooseConfiguration('');
      await this.app.measurement.start({
        ladder: sweep,
        noise: Number((noise / 100).toPrecision(6)),
        seconds,
      });
    } catch (error) {
      this.app.toasts.showError(/** @type {any} */ (error));
    }
    this.refresh();
  }

  #cancel() {
    this.app.measurement.cancel().catch((error) => this.app.toasts.showError(error));
  }
}

/** Of the present step; null if unknown. Noise falls with the square root of the samples. */
function fractionDone(/** @type {any} */ progress) {
  if (progress?.state === 'rungs')
    return progress.rung_count ? progress.done / progress.rung_count : null;
  if (progress?.state !== 'reference' || !(progress.noise > 0)) return null;
  return Math.min((progress.noise_wanted / progress.noise) ** 2, 1);
}

const left = (/** @type {any} */ { seconds_left }) => {
  const text = durationText(seconds_left);
  return text && ` About ${text} left.`;
};

/** @param {import('../accuracy/measurement.js').Progress | null} progress */
function describeProgress(progress) {
  if (!progress)
    return (
      'Traces the reference image of what you see in the background, then draws it by each ' +
      'setting and tells how far that is from the reference image, and what it costs.'
    );
  const count = `${progress.done ?? 0} of ${progress.rung_count ?? '?'} settings`;
  switch (progress.state) {
    case 'queued':
      return 'Waits until another measurement has ended.';
    case 'reference': {
      const noise = progress.noise ? `noise ${percentText(progress.noise)}` : 'noise not known yet';
      const wanted = progress.noise_wanted
        ? ` (wanted: ${percentText(progress.noise_wanted)})`
        : '';
      return (
        `Traces the reference: ${progress.samples ?? 0} samples a pixel, ` +
        `${noise}${wanted}.${left(progress)}`
      );
    }
    case 'rungs':
      return `Measured ${count}${progress.rung ? `; now ${progress.rung}` : ''}.${left(progress)}`;
    case 'done':
      return `Measured ${count}.`;
    case 'cancelled':
      return `Cancelled after ${count}${progress.done ? '; these stay.' : '.'}`;
    default:
      return `Failed: ${progress.message ?? 'the server did not say why'}`;
  }
}

const STEPS = /** @type {Record<string, string>} */ ({
  queued: 'The measurement waits.',
  reference: 'The reference image is being traced.',
  rungs: 'The settings are being measured.',
  done: 'The measurement is done.',
  cancelled: 'The measurement was cancelled.',
  failed: 'The measurement failed.',
});

const describeStep = (/** @type {any} */ progress) => (progress ? STEPS[progress.state] : '');
