/**
 * Knows whether the document has changed since it was measured.
 * Event: `changed`.
 */
export class EditWatch extends EventTarget {
  /**
   * @param {import('../scene/scene_document.js').SceneDocument} document
   * @param {import('./measurement.js').Measurement} measurement
   */
  constructor(document, measurement) {
    super();
    this.document = document;
    this.measurement = measurement;
    /** Whether lights, materials, objects or surroundings are others than those measured. */
    this.isScene = false;
    /** Whether the shared settings are. */
    this.isSettings = false;
    // An edit that the server had before it measured has come back by the time it replies.
    measurement.addEventListener('begun', () => this.#set(false, false));
    document.addEventListener('structure', () => this.#set(true, this.isSettings));
    document.addEventListener('changed', (event) => {
      const isSettings = /** @type {CustomEvent} */ (event).detail.group === 'settings';
      this.#set(this.isScene || !isSettings, this.isSettings || isSettings);
    });
  }

  /** What people should know, in words; "" if nothing has changed. */
  get words() {
    if (!this.measurement.id) return '';
    const isMoving = this.document.data?.animations.some((/** @type {any} */ { playing }) => playing);
    if (isMoving) return 'An animation runs: the truth shows the moment that was measured.';
    if (this.isScene) return 'The scene has been edited since it was measured: the figures are those of before.';
    if (this.isSettings) return 'The settings have changed since: “live” stands for those of before.';
    return '';
  }

  #set(/** @type {boolean} */ isScene, /** @type {boolean} */ isSettings) {
    if (isScene === this.isScene && isSettings === this.isSettings) return;
    this.isScene = isScene;
    this.isSettings = isSettings;
    this.dispatchEvent(new Event('changed'));
  }
}
