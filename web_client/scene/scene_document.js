import { IDENTITY, multiply, parentFromNode } from '../math/affine.js';

/** @typedef {import('../math/vector.js').Vector} Vector */

/** Arrays of the document, by the parameter group of their items. */
const ARRAYS = /** @type {Record<string, string>} */ ({
  light: 'lights',
  material: 'materials',
  node: 'nodes',
  animation: 'animations',
});

/**
 * The client's copy of the shared document.
 *
 * Events: `loaded` (another scene, or all of it anew), `structure` (lights or nodes were added or
 * removed), `changed` (detail: group and id of what has new values).
 */
export class SceneDocument extends EventTarget {
  constructor() {
    super();
    /** @type {any} */
    this.data = null;
  }

  /** Takes a result of scene.get. @param {any} data */
  load(data) {
    this.data = data;
    this.dispatchEvent(new Event('loaded'));
  }

  /** The thing that edits of a group and id change. @param {string} group @param {number} [id] */
  find(group, id) {
    if (!this.data) return undefined;
    const list = this.data[ARRAYS[group]];
    return list ? list.find((/** @type {any} */ item) => item.id === id) : this.data[group];
  }

  /**
   * Applies one edit of scene.changed.
   * @param {any} edit
   * @param {(group: string, id: number | undefined, field: string) => boolean} isStale whether a
   *   field has a newer value here, on its way to the server
   */
  apply(edit, isStale) {
    const [group, verb] = edit.method.split('.');
    if (verb === 'add') this.#add(edit);
    else if (verb === 'remove') this.#removeLight(edit.id);
    else if (verb === 'load') this.#loadEnvironment(edit, isStale);
    else this.assign(group, edit.id, edit.set, isStale);
    for (const placement of edit.lights ?? []) this.#move('light', placement, isStale);
    for (const placement of edit.nodes ?? []) this.#move('node', placement, isStale);
  }

  /** @param {string} group @param {number | undefined} id @param {Record<string, any>} set */
  assign(group, id, set, isStale = (/** @type {any[]} */ ..._key) => false) {
    const item = this.find(group, id);
    if (!item) return;
    for (const [field, value] of Object.entries(set))
      if (!isStale(group, id, field)) item[field] = value;
    this.dispatchEvent(new CustomEvent('changed', { detail: { group, id } }));
  }

  /** @param {number} nodeId @returns {import('../math/affine.js').Affine} */
  worldFromNode(nodeId) {
    const node = this.find('node', nodeId);
    if (!node) return IDENTITY;
    const local = parentFromNode(node);
    return node.parent === null ? local : multiply(this.worldFromNode(node.parent), local);
  }

  /**
   * The middle of the scene and the radius of a ball around it.
   * @returns {{center: Vector, radius: number}}
   */
  get ball() {
    const bounds = this.data?.bounds;
    if (!bounds) return { center: [0, 0, 0], radius: 1 };
    const middle = (/** @type {number} */ i) => (bounds.min[i] + bounds.max[i]) / 2;
    const half = (/** @type {number} */ i) => (bounds.max[i] - bounds.min[i]) / 2;
    return {
      center: [middle(0), middle(1), middle(2)],
      radius: Math.max(Math.hypot(half(0), half(1), half(2)), 1e-3),
    };
  }

  #move(
    /** @type {string} */ group,
    /** @type {any} */ { id, ...set },
    /** @type {any} */ isStale,
  ) {
    this.assign(group, id, set, isStale);
  }

  #loadEnvironment(/** @type {any} */ { name, set }, /** @type {any} */ isStale) {
    this.assign(
      'environment',
      undefined,
      { ...set, image: name, has_picture: name !== null },
      isStale,
    );
  }

  #add(/** @type {any} */ edit) {
    for (const [list, item] of [
      [this.data.lights, edit.light],
      [this.data.nodes, edit.node],
    ]) {
      const at = list.findIndex((/** @type {any} */ other) => other.id === item.id);
      if (at >= 0) list[at] = item;
      else list.push(item);
    }
    this.dispatchEvent(new Event('structure'));
  }

  #removeLight(/** @type {number} */ id) {
    const light = this.find('light', id);
    if (!light) return;
    this.data.lights = this.data.lights.filter((/** @type {any} */ other) => other !== light);
    const node = this.find('node', light.node);
    const isOnlyLight =
      node &&
      node.mesh === null &&
      node.camera === null &&
      !this.data.nodes.some((/** @type {any} */ other) => other.parent === node.id);
    if (isOnlyLight)
      this.data.nodes = this.data.nodes.filter((/** @type {any} */ other) => other !== node);
    else if (node) node.light = null;
    this.dispatchEvent(new Event('structure'));
  }
}
