const KEEP = 256;

/**
 * Measures edit to photon: from the moment of an edit to the presentation of the first frame that
 * shows it, by the edit ids in the frames' headers.
 */
export class EditTimer {
  constructor() {
    /** @type {Map<number, number>} when the edits that no frame shows yet were made */
    this.waiting = new Map();
    /** @type {number[]} the newest times in milliseconds */
    this.times = [];
  }

  /** @param {number} editId @param {number} [at] of performance.now() */
  begin(editId, at = performance.now()) {
    this.waiting.set(editId, at);
    if (this.waiting.size > KEEP) this.waiting.delete(this.waiting.keys().next().value ?? 0);
  }

  /** The server refused the edit, or a newer one took its place. @param {number} editId */
  drop(editId) {
    this.waiting.delete(editId);
  }

  /**
   * A frame that shows all edits up to `editId` is on the screen.
   * @param {number} editId @param {number} at @returns {number | null} the time of the oldest
   */
  present(editId, at) {
    let longest = null;
    for (const [id, began] of this.waiting) {
      if (id > editId) continue;
      longest = Math.max(longest ?? 0, at - began);
      this.waiting.delete(id);
    }
    if (longest !== null) {
      this.times.push(longest);
      if (this.times.length > KEEP) this.times.shift();
    }
    return longest;
  }

  /** The connection is new: frames will not show earlier edits. */
  reset() {
    this.waiting.clear();
  }
}
