/** @typedef {import('../math/vector.js').Vector} Vector */

/** The selection: a node, and with it its light or a material. Event: `changed`. */
export class Selection extends EventTarget {
  constructor() {
    super();
    /** @type {number | null} */
    this.nodeId = null;
    /** @type {number | null} */
    this.lightId = null;
    /** @type {number | null} */
    this.materialId = null;
    /** @type {any} the reply of `pick` that selected it */
    this.hit = null;
    /** @type {Vector | null} where the handle is, in the node's own space; null: its origin */
    this.anchorNode = null;
  }

  /**
   * @param {Partial<Pick<Selection, 'nodeId' | 'lightId' | 'materialId' | 'hit' | 'anchorNode'>>}
   *   choice
   */
  choose(choice) {
    this.nodeId = choice.nodeId ?? null;
    this.lightId = choice.lightId ?? null;
    this.materialId = choice.materialId ?? this.materialId;
    this.hit = choice.hit ?? null;
    this.anchorNode = choice.anchorNode ?? null;
    this.dispatchEvent(new Event('changed'));
  }

  /** Only the material; the object stays. @param {number | null} materialId */
  chooseMaterial(materialId) {
    this.materialId = materialId;
    this.dispatchEvent(new Event('changed'));
  }

  clear() {
    this.materialId = null;
    this.choose({});
  }
}
