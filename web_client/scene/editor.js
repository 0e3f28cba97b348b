import { RpcError } from '../net/rpc_error.js';

const LONGEST_PHOTON_MS = 5000;

/** @typedef {import('../net/connection.js').Connection} Connection */
/**
 * @typedef {{group: string, id: number | undefined, set: Record<string, any>, at: number | null}}
 *   Pending
 */

/**
 * Sends edits: what is dragged at most once per animation frame, marked transient, and what is
 * settled at once. The document shows an edit before the server has it; if the server refuses,
 * `onRefused` hears why.
 */
export class Editor {
  /**
   * @param {Connection} connection
   * @param {import('./scene_document.js').SceneDocument} document
   * @param {import('./edit_timer.js').EditTimer} timer
   * @param {(error: RpcError) => void} onRefused
   */
  constructor(connection, document, timer, onRefused) {
    this.connection = connection;
    this.document = document;
    this.timer = timer;
    this.onRefused = onRefused;
    this.lastEditId = 0;
    /** @type {Map<string, Pending>} dragged values that the next animation frame sends */
    this.pending = new Map();
    /** @type {Map<string, number>} newest edit of each field that has no reply yet */
    this.underWay = new Map();
    this.isThrottled = false;
    // A field in a broadcast is stale while a newer edit of it is on its way.
    this.isStale = (
      /** @type {string} */ group,
      /** @type {number | undefined} */ id,
      /** @type {string} */ field,
    ) => this.underWay.has(`${group}/${id}/${field}`) || this.#isPending(group, id, field);
  }

  /**
   * Changes fields of a light, material, node, animation, the environment or the settings.
   * @param {string} group @param {number | undefined} id @param {Record<string, any>} set
   * @param {boolean} transient true while dragging
   */
  update(group, id, set, transient) {
    const key = `${group}/${id}`;
    const waiting = this.pending.get(key);
    // A final edit that sets what is there already changes no image: it is not timed.
    const now = this.#isNews(group, id, set) ? performance.now() : null;
    this.document.assign(group, id, set);
    const at = waiting?.at ?? now;
    const merged = { group, id, set: { ...waiting?.set, ...set }, at };
    if (!transient || !this.isThrottled) {
      this.pending.delete(key);
      this.#send(merged, transient);
    } else {
      this.pending.set(key, merged);
    }
    if (!this.isThrottled) this.#throttle();
  }

  /** @param {Record<string, any>} set @returns {Promise<any>} the new light's id and node */
  addLight(set) {
    return this.#request('light.add', { set });
  }

  /** @param {number} id */
  removeLight(id) {
    return this.#request('light.remove', { id });
  }

  /**
   * @param {string} name of scene.list; how long it loads says nothing of edits
   * @returns {Promise<any>}
   */
  loadEnvironment(name) {
    return this.#request('environment.load', { name }, null);
  }

  undo() {
    return this.#request('edit.undo', {});
  }

  redo() {
    return this.#request('edit.redo', {});
  }

  /** Forgets the replies that the last connection owed. */
  reset() {
    this.pending.clear();
    this.underWay.clear();
  }

  #isNews(
    /** @type {string} */ group,
    /** @type {number | undefined} */ id,
    /** @type {Record<string, any>} */ set,
  ) {
    const item = this.document.find(group, id) ?? {};
    return Object.entries(set).some(
      ([field, value]) => JSON.stringify(item[field]) !== JSON.stringify(value),
    );
  }

  #isPending(
    /** @type {string} */ group,
    /** @type {number | undefined} */ id,
    /** @type {string} */ field,
  ) {
    return field in (this.pending.get(`${group}/${id}`)?.set ?? {});
  }

  /** Keeps what comes before the next animation frame until then. */
  #throttle() {
    this.isThrottled = true;
    requestAnimationFrame(() => {
      this.isThrottled = false;
      const waiting = [...this.pending.values()];
      this.pending.clear();
      for (const edit of waiting) this.#send(edit, true);
      if (waiting.length > 0) this.#throttle();
    });
  }

  async #send(/** @type {Pending} */ { group, id, set, at }, /** @type {boolean} */ transient) {
    const method = group === 'animation' ? 'animation.set' : `${group}.update`;
    const keys = Object.keys(set).map((field) => `${group}/${id}/${field}`);
    const editId = this.lastEditId + 1;
    for (const key of keys) this.underWay.set(key, editId);
    const params = { ...(id === undefined ? {} : { id }), set, ...(transient && { transient }) };
    await this.#request(method, params, at);
    for (const key of keys) if (this.underWay.get(key) === editId) this.underWay.delete(key);
  }

  /**
   * @param {string} method @param {object} params
   * @param {number | null} [at] when the user acted; null: not to be timed
   */
  async #request(method, params, at = performance.now()) {
    const editId = ++this.lastEditId;
    if (at !== null) this.timer.begin(editId, at);
    try {
      const result = await this.connection.call(method, { ...params, edit_id: editId });
      if ('superseded_by' in result || result.method === null) this.timer.drop(editId);
      // Not every edit can be seen: a name, or a light that is off.
      else setTimeout(() => this.timer.drop(editId), LONGEST_PHOTON_MS);
      return result;
    } catch (error) {
      this.timer.drop(editId);
      if (error instanceof RpcError) this.onRefused(error);
      return null;
    }
  }
}
