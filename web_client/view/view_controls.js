import { chooseViewSize } from './view_size.js';

const SETTLE_MS = 150;

/**
 * This client's view: its size follows the stage, its options follow the panel, and it pauses while
 * the page is hidden. A measured configuration may draw it instead of the shared settings. Events:
 * `changed`, when options have changed, and `configuration`, when the configuration has.
 */
export class ViewControls extends EventTarget {
  /**
   * @param {HTMLElement} stage
   * @param {import('../net/connection.js').Connection} connection
   * @param {(error: any) => void} onRefused
   */
  constructor(stage, connection, onRefused) {
    super();
    this.stage = stage;
    this.connection = connection;
    this.onRefused = onRefused;
    this.sizeChoice = 'auto';
    /** @type {'orbit' | 'fly'} */
    this.mode = 'orbit';
    /** @type {Record<string, any>} chosen options of group view */
    this.options = {};
    /** Name of the measured configuration that draws this view; "": the shared settings do. */
    this.configuration = '';
    this.server = { isSoftware: false, maxWidth: 4096, maxHeight: 2160 };
    /** @type {number | undefined} */
    this.timer = undefined;
    new ResizeObserver(() => {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => this.send(), SETTLE_MS);
    }).observe(stage);
    document.addEventListener('visibilitychange', () => this.send());
  }

  /** A new connection: takes over the server's description and keeps earlier choices. */
  begin(/** @type {any} */ hello) {
    this.server = {
      isSoftware: hello.gl.software,
      maxWidth: hello.limits.width,
      maxHeight: hello.limits.height,
    };
    // Measurements belong to a connection: at its start no configuration is chosen, and sizes do
    // not change the choice.
    const { width: _width, height: _height, rung: _configuration, ...options } = hello.view;
    this.options = { ...options, ...this.options };
    this.#setConfiguration('');
    this.send();
  }

  /**
   * Draws this view with a configuration of this client's newest measurement.
   * @param {string} configuration its name, or ""
   */
  async chooseConfiguration(configuration) {
    await this.connection.call('view.configure', { rung: configuration });
    this.#setConfiguration(configuration);
  }

  /**
   * The server has gone back to the shared settings, as it does for another scene or measurement.
   */
  forgetConfiguration() {
    this.#setConfiguration('');
  }

  #setConfiguration(/** @type {string} */ configuration) {
    if (configuration === this.configuration) return;
    this.configuration = configuration;
    this.dispatchEvent(new Event('configuration'));
  }

  /** @param {Record<string, any>} set fields of group view */
  configure(set) {
    this.options = { ...this.options, ...set };
    this.send();
  }

  /** @param {string} choice of RENDER_SIZES */
  chooseSize(choice) {
    this.sizeChoice = choice;
    this.send();
  }

  /** @param {'orbit' | 'fly'} mode */
  chooseMode(mode) {
    this.mode = mode;
    this.dispatchEvent(new Event('changed'));
  }

  /** The size that fits the stage now. */
  get size() {
    const stage = { width: this.stage.clientWidth, height: this.stage.clientHeight };
    return chooseViewSize(stage, devicePixelRatio, this.sizeChoice, this.server);
  }

  send() {
    if (!this.connection.isOpen || this.stage.clientWidth < 2 || this.stage.clientHeight < 2)
      return;
    const paused = this.options.paused || document.hidden;
    this.connection
      .call('view.configure', { ...this.options, ...this.size, paused })
      .catch(this.onRefused);
    this.dispatchEvent(new Event('changed'));
  }
}
