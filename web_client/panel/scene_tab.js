import { element } from '../ui/element.js';
import { icon } from '../ui/icon.js';
import { SceneTree } from '../ui/scene_tree.js';
import { AnimationControls } from './animation_controls.js';
import { addParameterControls } from './parameter_controls.js';
import { SceneLoader } from './scene_loader.js';
import { makeSection } from './sections.js';

const vectorText = (/** @type {number[]} */ vector) => vector.map((v) => v.toFixed(3)).join(', ');

const counted = (/** @type {number} */ count, /** @type {string} */ noun) =>
  `${count.toLocaleString('en')} ${noun}${count === 1 ? '' : 's'}`;

/** The scene: its source, its nodes, the selection and its placement, cameras and animations. */
export class SceneTab {
  /** @param {HTMLElement} root @param {import('./app_context.js').AppContext} app */
  constructor(root, app) {
    this.app = app;
    this.loader = new SceneLoader(app);
    const sceneTree = element('div', {
      class: 'tree',
      role: 'tree',
      tabindex: 0,
      'aria-label': 'Scene nodes',
    });
    this.sceneTree = new SceneTree(sceneTree, {
      onChoose: (nodeId) => this.#choose(nodeId),
      onShow: (nodeId, visible) => app.editor.update('node', nodeId, { visible }, false),
    });
    this.counts = element('small', { class: 'counts' });
    this.info = element('dl', { class: 'info', 'aria-label': 'Selection' });
    this.chosen = element('div', {});
    this.cameras = element('div', { class: 'choices', role: 'group', 'aria-label': 'Cameras' });
    this.animations = new AnimationControls(app);
    root.append(
      element('h2', {}, 'Scene'),
      this.loader.root,
      sceneTree,
      this.counts,
      this.info,
      this.chosen,
      element('h2', {}, 'Cameras'),
      this.cameras,
      this.animations.root,
    );
    /** @type {{refresh: () => void} | null} */
    this.controls = null;
  }

  /** The scene is another one, or nodes were added or removed. */
  rebuild() {
    const { data } = this.app.document;
    const { nodes, lights, materials } = data;
    this.counts.textContent = [
      counted(nodes.length, 'node'),
      counted(data.counts.triangles, 'triangle'),
      counted(materials.length, 'material'),
      counted(lights.length, 'light'),
    ].join(' · ');
    this.sceneTree.show(data.nodes);
    this.loader.showSource(data.source);
    this.#drawCameras();
    this.animations.rebuild();
    this.chooseNode();
  }

  /** Shows the selection. */
  chooseNode() {
    const { app } = this;
    const { nodeId, hit } = app.selection;
    const node = app.document.find('node', nodeId ?? undefined);
    this.sceneTree.choose(nodeId);
    this.#drawInfo(hit);
    this.chosen.replaceChildren();
    this.controls = null;
    if (!node) return;
    const gui = makeSection(this.chosen, `Transform: ${node.name || `node ${node.id}`}`);
    this.controls = addParameterControls(gui, app.parameters('node'), app.target('node', node.id));
  }

  /** @param {number} [id] */
  refresh(id) {
    this.sceneTree.show(this.app.document.data.nodes);
    if (id === this.app.selection.nodeId) this.controls?.refresh();
  }

  #choose(/** @type {number} */ nodeId) {
    const { app } = this;
    const node = app.document.find('node', nodeId);
    const mesh = app.document.data.meshes.find(
      (/** @type {any} */ other) => other.id === node.mesh,
    );
    const materialId = mesh?.primitives[0]?.material;
    app.selection.choose({ nodeId, lightId: node.light, materialId });
  }

  #drawInfo(/** @type {any} */ hit) {
    this.info.replaceChildren();
    if (!hit) return;
    const material = this.app.document.find('material', hit.material);
    const rows = [
      ['Position', `${vectorText(hit.position)} m`],
      ['Normal', vectorText(hit.normal)],
      ['Material', material?.name || String(hit.material)],
      ['Distance', `${hit.distance.toFixed(3)} m`],
    ];
    for (const [name, value] of rows)
      this.info.append(element('dt', {}, name), element('dd', {}, value));
  }

  #drawCameras() {
    const { app } = this;
    const cameras = app.document.data.cameras.map((/** @type {any} */ camera) =>
      element(
        'button',
        {
          type: 'button',
          'data-camera': camera.id,
          onclick: () => {
            const { eye, target, up, fov_y_rad } = camera;
            app.camera.set({ eye, target, up, fov_y_rad });
          },
        },
        icon('camera'),
        element('span', { class: 'name' }, camera.name || `Camera ${camera.id}`),
      ),
    );
    this.cameras.replaceChildren(
      ...(cameras.length
        ? cameras
        : [element('p', { class: 'hint' }, 'This scene has no cameras.')]),
    );
  }
}
