/**
 * Knows whether the document has changed since it was measured. It compares revisions, so that
 * edits that were on their way when the measurement began count correctly. Event: `changed`.
 */
export class EditWatch extends EventTarget {
  /**
   * @param {import('../net/connection.js').Connection} connection
   * @param {import('../scene/scene_document.js').SceneDocument} document
   * @param {import('./measurement.js').Measurement} measurement
   */
  constructor(connection, document, measurement) {
    super();
    this.document = document;
    this.measurement = measurement;
    /**
     * Revisions of the newest edit of lights, materials, objects or surroundings, and of the shared
     * settings.
     */
    this.newest = { scene: 0, settings: 0 };
    connection.addEventListener('notification', (event) => {
      const { method, params } = /** @type {CustomEvent} */ (event).detail;
      if (method === 'scene.changed') this.#take(params.edits);
    });
  }

  /** What people should know, as a sentence; "" if nothing has changed. */
  get words() {
    const { id, revision } = this.measurement;
    if (!id) return '';
    const isMoving = this.document.data?.animations.some(
      (/** @type {any} */ { playing }) => playing,
    );
    if (isMoving)
      return 'An animation runs: the reference image shows the moment that was measured.';
    if (this.newest.scene > revision)
      return 'The scene has been edited since it was measured: the figures are those of before.';
    if (this.newest.settings > revision)
      return 'The settings have changed since: “live” stands for those of before.';
    return '';
  }

  #take(/** @type {{method: string, revision: number}[]} */ edits) {
    for (const { method, revision } of edits)
      this.newest[method === 'settings.update' ? 'settings' : 'scene'] = revision;
    this.dispatchEvent(new Event('changed'));
  }
}
