/**
 * @typedef {object} Progress as accuracy.progress tells it
 * @property {string} measurement
 * @property {'queued' | 'reference' | 'rungs' | 'done' | 'cancelled' | 'failed'} state
 * @property {string} [message]
 * @property {number} [samples]
 * @property {number | null} [noise]
 * @property {number} [noise_wanted]
 * @property {number} [done]
 * @property {number} [rung_count]
 * @property {string | null} [rung]
 * @property {number | null} [seconds_left]
 */

const ENDED = ['done', 'cancelled', 'failed'];

/**
 * This client's newest measurement: its progress and its results.
 *
 * Events: `changed` (progress), `results` (no detail: `results` is another object), `begun`
 * (another measurement, or none).
 */
export class Measurement extends EventTarget {
  /**
   * @param {import('../net/connection.js').Connection} connection
   * @param {string} baseUrl of the client's page
   * @param {(url: string) => Promise<any>} [getJson] null where there is none
   */
  constructor(connection, baseUrl, getJson = fetchJson) {
    super();
    this.connection = connection;
    this.baseUrl = baseUrl;
    this.getJson = getJson;
    this.id = '';
    /** Revision of the document that was measured. */
    this.revision = 0;
    /** @type {Progress | null} */
    this.progress = null;
    /** @type {any} what results.json holds; null before the first configuration */
    this.results = null;
    this.hasReference = false;
    this.isFetching = false;
    this.isOutdated = false;
    /** @type {Progress | null} of another measurement: the one whose id is on its way, perhaps */
    this.stray = null;
  }

  get isRunning() {
    return this.id !== '' && !ENDED.includes(this.progress?.state ?? '');
  }

  /** @returns {any[]} entries of results.json */
  get configurations() {
    return this.results?.rungs ?? [];
  }

  /** @param {string} name */
  configuration(name) {
    return this.configurations.find((configuration) => configuration.name === name) ?? null;
  }

  /** The address of one of the measurement's files. @param {string} file */
  url(file) {
    return new URL(`accuracy/${this.id}/${encodeURIComponent(file)}`, this.baseUrl).href;
  }

  /**
   * Measures this client's view as it is now, in place of what was measured before.
   * @param {{ladder: string, noise: number, seconds: number}} params noise: standard error over
   *   mean luminance
   */
  async start(params) {
    const { measurement, rung_count, revision } = await this.connection.call(
      'accuracy.start',
      params,
    );
    this.#begin(measurement, revision);
    const early = this.stray?.measurement === measurement ? this.stray : null;
    this.takeProgress(early ?? { measurement, state: 'queued', done: 0, rung_count });
  }

  cancel() {
    return this.connection.call('accuracy.cancel', {});
  }

  /** Forgets the measurement: another scene or another connection has come. */
  forget() {
    this.#begin('', 0);
    this.dispatchEvent(new Event('changed'));
  }

  /** @param {Progress} progress params of a notification */
  takeProgress(progress) {
    if (progress.measurement !== this.id) {
      this.stray = progress;
      return;
    }
    const before = this.progress;
    this.progress = progress;
    if (progress.state === 'rungs' || progress.state === 'done') this.hasReference = true;
    if (before?.state !== progress.state || before?.done !== progress.done) this.#fetch();
    this.dispatchEvent(new Event('changed'));
  }

  #begin(/** @type {string} */ id, /** @type {number} */ revision) {
    this.id = id;
    this.revision = revision;
    this.progress = null;
    this.results = null;
    this.hasReference = false;
    this.dispatchEvent(new Event('begun'));
  }

  /** Reads the results. If more come meanwhile, reads once more afterwards. */
  async #fetch() {
    this.isOutdated = true;
    if (this.isFetching) return;
    this.isFetching = true;
    while (this.isOutdated) {
      this.isOutdated = false;
      const { id } = this;
      const results = id ? await this.getJson(this.url('results.json')) : null;
      if (results && id === this.id) {
        this.results = results;
        this.hasReference = true;
        this.dispatchEvent(new Event('results'));
      }
    }
    this.isFetching = false;
  }
}

/** @param {string} url @returns {Promise<any>} null where there is none, or no connection */
async function fetchJson(url) {
  try {
    const response = await fetch(url, { cache: 'no-store' });
    return response.ok ? await response.json() : null;
  } catch {
    return null;
  }
}
