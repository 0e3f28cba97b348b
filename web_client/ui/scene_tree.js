import { element } from './element.js';
import { icon } from './icon.js';

const ROW_PX = 26;
const SPARE_ROWS = 6;

/**
 * @typedef {{id: number, name: string, parent: number | null, mesh: number | null, light: number |
 *   null, camera: number | null, visible: boolean}} Node
 */
/**
 * @typedef {{node: Node, level: number, hasChildren: boolean, position: number, siblings: number}}
 *   Row
 */

const kindOf = (/** @type {Node} */ node) =>
  node.light !== null
    ? 'light'
    : node.camera !== null
      ? 'camera'
      : node.mesh !== null
        ? 'mesh'
        : 'group';

/**
 * The nodes as an ARIA tree. Only visible rows are in the page, so that thousands of nodes cost
 * little. The focus stays on the tree; arrow keys move the selection, V shows and hides.
 */
export class SceneTree {
  /**
   * @param {HTMLElement} container
   * @param {{onChoose: (nodeId: number) => void, onShow: (nodeId: number, visible: boolean) =>
   *   void}} options
   */
  constructor(container, options) {
    this.container = container;
    this.options = options;
    /** @type {Node[]} */
    this.nodes = [];
    /** @type {Row[]} */
    this.rows = [];
    /** @type {Set<number>} */
    this.closed = new Set();
    /** @type {number | null} */
    this.chosen = null;
    this.space = element('div', { class: 'tree-space' });
    container.append(this.space);
    container.addEventListener('scroll', () => this.#draw());
    container.addEventListener('keydown', (event) => this.#key(event));
    new ResizeObserver(() => this.#draw()).observe(container);
  }

  /** @param {Node[]} nodes */
  show(nodes) {
    this.nodes = nodes;
    this.#layOut();
  }

  /** @param {number | null} nodeId */
  choose(nodeId) {
    if (nodeId !== this.chosen && nodeId !== null) this.#reveal(nodeId);
    this.chosen = nodeId;
    this.#draw();
  }

  #layOut() {
    /** @type {Map<number | null, Node[]>} */
    const children = new Map();
    for (const node of this.nodes) {
      const list = children.get(node.parent);
      if (list) list.push(node);
      else children.set(node.parent, [node]);
    }
    this.rows = [];
    const add = (/** @type {Node[]} */ list, /** @type {number} */ level) =>
      list.forEach((node, i) => {
        const below = children.get(node.id) ?? [];
        const hasChildren = below.length > 0;
        this.rows.push({ node, level, hasChildren, position: i + 1, siblings: list.length });
        if (hasChildren && !this.closed.has(node.id)) add(below, level + 1);
      });
    add(children.get(null) ?? [], 1);
    this.space.style.height = `${this.rows.length * ROW_PX}px`;
    this.#draw();
  }

  #reveal(/** @type {number} */ nodeId) {
    const byId = new Map(this.nodes.map((node) => [node.id, node]));
    for (let node = byId.get(nodeId); node && node.parent !== null; node = byId.get(node.parent))
      this.closed.delete(node.parent);
    this.#layOut();
    const top = this.rows.findIndex((row) => row.node.id === nodeId) * ROW_PX;
    const { scrollTop, clientHeight } = this.container;
    if (top < scrollTop) this.container.scrollTop = top;
    if (top + ROW_PX > scrollTop + clientHeight)
      this.container.scrollTop = top + ROW_PX - clientHeight;
  }

  #draw() {
    const first = Math.max(0, Math.floor(this.container.scrollTop / ROW_PX) - SPARE_ROWS);
    const count = Math.ceil(this.container.clientHeight / ROW_PX) + 2 * SPARE_ROWS;
    const seen = this.rows.slice(first, first + count);
    this.space.replaceChildren(...seen.map((row, i) => this.#makeRow(row, first + i)));
    const isSeen = seen.some((row) => row.node.id === this.chosen);
    if (isSeen) this.container.setAttribute('aria-activedescendant', `tree-node-${this.chosen}`);
    else this.container.removeAttribute('aria-activedescendant');
  }

  #makeRow(
    /** @type {Row} */ { node, level, hasChildren, position, siblings },
    /** @type {number} */ index,
  ) {
    const isOpen = !this.closed.has(node.id);
    const name = node.name || `node ${node.id}`;
    const twisty = element('span', { class: 'twisty', 'aria-hidden': 'true' });
    if (hasChildren) {
      twisty.append(icon(isOpen ? 'open' : 'closed'));
      twisty.addEventListener('click', (/** @type {Event} */ event) => {
        event.stopPropagation();
        this.#toggle(node.id);
      });
    }
    const eye = element(
      'button',
      {
        type: 'button',
        class: 'eye',
        tabindex: -1,
        'aria-label': `${node.visible ? 'Hide' : 'Show'} ${name}`,
        onclick: (/** @type {Event} */ event) => {
          event.stopPropagation();
          this.options.onShow(node.id, !node.visible);
        },
      },
      icon(node.visible ? 'eye' : 'eye-off'),
    );
    return element(
      'div',
      {
        role: 'treeitem',
        id: `tree-node-${node.id}`,
        class: node.visible ? 'row' : 'row unseen',
        style: `top:${index * ROW_PX}px;padding-left:${4 + (level - 1) * 14}px`,
        'aria-level': level,
        'aria-posinset': position,
        'aria-setsize': siblings,
        'aria-selected': node.id === this.chosen,
        'aria-expanded': hasChildren ? isOpen : undefined,
        'aria-label': `${name}, ${kindOf(node)}${node.visible ? '' : ', hidden'}`,
        title: name,
        onclick: () => this.options.onChoose(node.id),
      },
      twisty,
      icon(kindOf(node)),
      element('span', { class: 'name' }, name),
      eye,
    );
  }

  #toggle(/** @type {number} */ nodeId) {
    if (!this.closed.delete(nodeId)) this.closed.add(nodeId);
    this.#layOut();
  }

  #key(/** @type {KeyboardEvent} */ event) {
    const at = this.rows.findIndex((row) => row.node.id === this.chosen);
    const row = this.rows[at];
    const page = Math.max(1, Math.floor(this.container.clientHeight / ROW_PX) - 1);
    const target = {
      ArrowDown: at + 1,
      ArrowUp: Math.max(at - 1, 0),
      Home: 0,
      End: this.rows.length - 1,
      PageDown: at + page,
      PageUp: Math.max(at - page, 0),
    }[event.key];
    if (target !== undefined) {
      const next = this.rows[Math.min(target, this.rows.length - 1)];
      if (next) this.options.onChoose(next.node.id);
    } else if (!row) return;
    else if (event.key === 'ArrowRight' || event.key === 'ArrowLeft') {
      const opens = event.key === 'ArrowRight';
      if (row.hasChildren && opens === this.closed.has(row.node.id)) this.#toggle(row.node.id);
      else if (!opens && row.node.parent !== null) this.options.onChoose(row.node.parent);
    } else if (event.key === 'v') this.options.onShow(row.node.id, !row.node.visible);
    else return;
    event.preventDefault();
  }
}
