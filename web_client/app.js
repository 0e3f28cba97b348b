import { Measurement } from './accuracy/measurement.js';
import { mapDirection, mapPoint, unmapDirection } from './math/affine.js';
import { add, length, subtract } from './math/vector.js';
import { Connection } from './net/connection.js';
import { AccuracyTab } from './panel/accuracy_tab.js';
import { LightTab } from './panel/light_tab.js';
import { MaterialTab } from './panel/material_tab.js';
import { RenderTab } from './panel/render_tab.js';
import { SceneTab } from './panel/scene_tab.js';
import { StatsTab } from './panel/stats_tab.js';
import { ViewTab } from './panel/view_tab.js';
import { EditTimer } from './scene/edit_timer.js';
import { Editor } from './scene/editor.js';
import { SceneDocument } from './scene/scene_document.js';
import { Selection } from './scene/selection.js';
import { DarkHint } from './ui/dark_hint.js';
import { PictureBadge } from './ui/picture_badge.js';
import { bindTabs } from './ui/tabs.js';
import { Toasts } from './ui/toasts.js';
import { TokenDialog } from './ui/token_dialog.js';
import { Camera } from './view/camera.js';
import { CameraInput } from './view/camera_input.js';
import { CameraSender } from './view/camera_sender.js';
import { Comparison } from './view/comparison.js';
import { Overlay } from './view/overlay.js';
import { Picture } from './view/picture.js';
import { ViewControls } from './view/view_controls.js';

/** @typedef {import('./math/vector.js').Vector} Vector */

const WALK_SECONDS = 4; // to cross half of the scene
const RATE_MS = 500;

const STATE_WORDS = {
  connecting: 'Connecting',
  open: 'Connected',
  waiting: 'Reconnecting',
  unauthorized: 'Token needed',
};

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));

/** Connects the client's parts by their events. */
export class App {
  constructor() {
    this.toasts = new Toasts(byId('toasts'));
    this.tokens = new TokenDialog(byId('token-dialog'), () => this.connection.connect());
    const url = new URL('.', location.href);
    url.protocol = url.protocol.replace('http', 'ws');
    this.connection = new Connection(url.href, () => this.#identity());
    this.document = new SceneDocument();
    this.timer = new EditTimer();
    /** @type {any} the header of the frame on the screen */
    this.shownHeader = null;
    /** @type {any} of this connection */
    this.newestStats = null;
    this.editor = new Editor(this.connection, this.document, this.timer, (error) =>
      this.#refused(error),
    );
    this.selection = new Selection();
    this.camera = new Camera();
    this.sender = new CameraSender(this.connection, this.camera);
    this.picture = new Picture(byId('picture'));
    this.overlay = new Overlay(byId('overlay'));
    this.comparison = new Comparison(byId('comparison-pictures'), byId('comparison'));
    this.measurement = new Measurement(this.connection, document.baseURI);
    this.view = new ViewControls(byId('stage'), this.connection, (error) =>
      this.toasts.showError(error),
    );
    /** @type {any} the server's description of itself */
    this.hello = null;
    this.clientId = 0;
    this.lastSource = '';
    this.scene = new SceneTab(byId('panel-scene'), this);
    this.light = new LightTab(byId('panel-light'), this);
    this.material = new MaterialTab(byId('panel-material'), this);
    this.renderTab = new RenderTab(byId('panel-render'), this);
    this.viewTab = new ViewTab(byId('panel-view'), this);
    this.stats = new StatsTab(byId('panel-stats'), this);
    this.accuracy = new AccuracyTab(byId('panel-accuracy'), this);
    this.badge = new PictureBadge(byId('badge'));
    this.darkHint = new DarkHint(byId('dark-hint'), this);
  }

  start() {
    bindTabs(/** @type {any} */ (document.querySelector('[role=tablist]')), () => {});
    this.#bindConnection();
    this.#bindDocument();
    this.#bindView();
    this.#bindTools();
    this.connection.connect();
  }

  /** @param {string} group */
  parameters(group) {
    return (this.hello?.parameters ?? []).filter((/** @type {any} */ row) => row.group === group);
  }

  /** @param {string} group @param {number} [id] */
  target(group, id) {
    return {
      get: (/** @type {string} */ name) =>
        this.document.find(group, id)?.[name] ?? this.#fallback(group, name),
      set: (
        /** @type {string} */ name,
        /** @type {any} */ value,
        /** @type {boolean} */ transient,
      ) => this.editor.update(group, id, { [name]: value }, transient),
    };
  }

  /**
   * Adds a light where it is seen, above the middle, and as strong as the scene is large.
   * @param {string} type
   */
  async addLight(type) {
    const { center, radius } = this.document.ball;
    const position = add(center, [0, radius * 0.3, 0]);
    const intensity = type === 'directional' ? 3 : Number((4 * radius * radius).toPrecision(2));
    const count = this.document.data.lights.length + 1;
    const set = { type, position, intensity, name: `${type} ${count}` };
    const result = await this.editor.addLight(set);
    if (result) this.selection.choose({ lightId: result.id, nodeId: result.node });
  }

  /** Moves the camera to see the selected thing, or the scene. */
  frameSelection() {
    const { center, radius } = this.document.ball;
    const position = this.#handlePosition();
    const aspect = this.overlay.aspect;
    if (position) this.camera.frame(position, radius * 0.4, aspect);
    else this.camera.frame(center, radius, aspect);
  }

  #identity() {
    const { token } = this.tokens;
    return token === undefined ? {} : { token };
  }

  #fallback(/** @type {string} */ group, /** @type {string} */ name) {
    return this.parameters(group).find((/** @type {any} */ row) => row.name === name)?.default;
  }

  async #refused(/** @type {import('./net/rpc_error.js').RpcError} */ error) {
    if (!this.connection.isOpen) return; // the state in the bar says so already
    this.toasts.showError(error);
    // Shows the server's values again instead of the refused ones.
    await this.#loadDocument();
  }

  #bindConnection() {
    const { connection } = this;
    connection.addEventListener('state', () => this.#showState());
    connection.addEventListener('hello', (event) =>
      this.#greet(/** @type {CustomEvent} */ (event).detail),
    );
    connection.addEventListener('frame', (event) =>
      this.picture.show(/** @type {CustomEvent} */ (event).detail),
    );
    connection.addEventListener('notification', (event) => {
      const { method, params } = /** @type {CustomEvent} */ (event).detail;
      if (method === 'stats') this.#takeStats(params);
      else if (method === 'scene.changed') this.#applyEdits(params);
      else if (method === 'scene.loaded') this.#sceneLoaded(params);
      else if (method === 'accuracy.progress') this.measurement.takeProgress(params);
      else if (method === 'session.notice') this.toasts.show(params.level, params.message);
    });
  }

  #takeStats(/** @type {any} */ params) {
    this.newestStats = params;
    this.#noteRevision();
    this.stats.takeStats(params);
    this.renderTab.takeStats(params);
  }

  #showState() {
    const { state } = this.connection;
    const shown = byId('connection');
    shown.dataset.state = state;
    shown.textContent = STATE_WORDS[state];
    if (state === 'unauthorized') this.tokens.ask();
  }

  async #greet(/** @type {any} */ hello) {
    this.hello = hello;
    this.clientId = hello.client_id;
    this.editor.reset();
    this.timer.reset();
    this.newestStats = null;
    const codec = this.parameters('view').find((/** @type {any} */ row) => row.name === 'codec');
    this.picture.reset(codec.values);
    this.measurement.forget(); // the server measures for a connection
    this.view.begin(hello);
    this.viewTab.rebuild();
    // The camera of an earlier connection stays if the scene is the same.
    const known = this.lastSource;
    this.#fillLists().catch(() => {});
    if (!hello.ready) return;
    await this.#loadDocument();
    const isSame = known !== '' && known === this.document.data?.source;
    this.sender.adopt(isSame ? this.camera.pose : hello.camera);
    if (hello.role === 'viewer') this.toasts.show('info', 'You may look, but not edit.');
  }

  /** The lists of what the server can load. */
  async #fillLists() {
    const { scenes, environments } = await this.connection.call('scene.list');
    this.scene.loader.fillList(scenes);
    this.light.environments.fillList(environments);
  }

  async #loadDocument() {
    try {
      const data = await this.connection.call('scene.get');
      this.lastSource = data.source;
      this.document.load(data);
    } catch (error) {
      if (this.connection.isOpen) this.toasts.showError(/** @type {any} */ (error));
    }
  }

  async #sceneLoaded(/** @type {any} */ params) {
    this.selection.clear();
    this.#forgetMeasurement();
    if (params.camera) this.sender.adopt(params.camera);
    await this.#loadDocument();
    for (const warning of this.document.data?.warnings.slice(0, 3) ?? [])
      this.toasts.show('warn', warning);
  }

  /** The measurement was of another scene. */
  #forgetMeasurement() {
    if (this.measurement.isRunning) this.measurement.cancel().catch(() => {});
    this.measurement.forget();
    this.view.forgetConfiguration();
  }

  #applyEdits(/** @type {any} */ params) {
    if (!this.document.data || params.epoch !== this.document.data.epoch) return;
    const isMine = params.author?.client_id === this.clientId;
    const isStale = isMine ? this.editor.isStale : () => false;
    for (const edit of params.edits) this.document.apply(edit, isStale);
  }

  #bindDocument() {
    const { document: scene, selection } = this;
    scene.addEventListener('loaded', () => {
      byId('scene-name').textContent = scene.data.name;
      this.#forgetLost();
      this.#rebuild();
    });
    scene.addEventListener('structure', () => {
      this.#forgetLost();
      this.scene.rebuild();
      this.light.chooseLight();
      this.#drawOverlay();
    });
    scene.addEventListener('changed', (event) => {
      const { group, id } = /** @type {CustomEvent} */ (event).detail;
      this.#refresh(group, id);
    });
    selection.addEventListener('changed', () => {
      this.scene.chooseNode();
      this.light.chooseLight();
      this.material.chooseMaterial();
      this.#drawOverlay();
    });
  }

  #rebuild() {
    this.scene.rebuild();
    this.light.rebuild();
    this.material.rebuild();
    this.renderTab.rebuild();
    this.#drawOverlay();
  }

  #refresh(/** @type {string} */ group, /** @type {number} */ id) {
    if (group === 'node') this.scene.refresh(id);
    else if (group === 'animation') this.scene.animations.refresh(id);
    else if (group === 'material') this.material.refresh(id);
    else this.light.refresh(group, id);
    if (group === 'settings') this.renderTab.refresh();
    if (group !== 'animation' && group !== 'settings') this.#drawOverlay();
  }

  /** Selected things may have gone. */
  #forgetLost() {
    const { nodeId, lightId, materialId } = this.selection;
    const isLost =
      (nodeId !== null && !this.document.find('node', nodeId)) ||
      (lightId !== null && !this.document.find('light', lightId)) ||
      (materialId !== null && !this.document.find('material', materialId));
    if (isLost) this.selection.clear();
  }

  #bindView() {
    const input = byId('controls');
    new CameraInput(input, this.camera, {
      getMode: () => this.view.mode,
      getSpeed: () => this.document.ball.radius / WALK_SECONDS,
      onClick: (x, y) => this.#pick(x, y),
    });
    input.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) =>
      this.#stageKey(event),
    );
    this.picture.addEventListener('presented', (event) =>
      this.#presented(/** @type {CustomEvent} */ (event).detail),
    );
    this.picture.addEventListener('skipped', (event) =>
      this.#acknowledge(/** @type {CustomEvent} */ (event).detail.header),
    );
    this.overlay.addEventListener('light', (event) => {
      const light = this.document.find('light', /** @type {CustomEvent} */ (event).detail);
      if (light) this.selection.choose({ lightId: light.id, nodeId: light.node });
    });
    this.overlay.addEventListener('drag', (event) =>
      this.#drag(/** @type {CustomEvent} */ (event).detail),
    );
    this.camera.addEventListener('changed', () => this.viewTab.refresh());
    this.view.addEventListener('changed', () => {
      byId('tool-fly').setAttribute('aria-pressed', String(this.view.mode === 'fly'));
      this.viewTab.refresh();
      this.renderTab.refresh();
    });
    new ResizeObserver(() => this.overlay.draw()).observe(byId('stage'));
    setInterval(() => {
      const rate = this.stats.framesPerSecond;
      byId('frame-rate').textContent = rate > 0 ? `${Math.ceil(rate)} fps` : 'at rest';
    }, RATE_MS);
  }

  /**
   * Records which camera the shown frame is of. A camera that changed nothing came without a frame,
   * in the statistics.
   */
  #noteRevision() {
    const { shownHeader: shown, newestStats: stats } = this;
    if (!shown) return;
    const told = stats?.frame_id === shown.frameId ? stats.camera_revision : 0;
    byId('stage').dataset.cameraRevision = String(Math.max(shown.cameraRevision, told));
  }

  #presented(/** @type {any} */ { header, decodeMs }) {
    this.#acknowledge(header);
    byId('waiting').hidden = true;
    byId('stage').dataset.frame = String(header.frameId);
    byId('stage').dataset.converged = String(header.converged);
    this.shownHeader = header;
    this.#noteRevision();
    const rows = this.parameters('view').find(
      (/** @type {any} */ row) => row.name === 'quality',
    )?.values;
    this.badge.show(header, this.view.configuration || (rows?.[header.quality] ?? ''));
    this.overlay.pose = this.sender.poseOf(header.cameraRevision);
    this.overlay.aspect = header.width / header.height;
    this.overlay.draw();
    this.stats.takeFrame(header, decodeMs);
    // The canvas reaches the screen with the frame that the browser draws next.
    requestAnimationFrame(() => {
      const ms = this.timer.present(header.editId, performance.now());
      if (ms !== null) this.stats.takeEditToPhoton(ms);
    });
  }

  #acknowledge(/** @type {import('./net/frame_header.js').FrameHeader} */ header) {
    this.connection.notify('frame.ack', { frame_id: header.frameId });
  }

  /** @param {number} x @param {number} y in pixels of the stage */
  async #pick(x, y) {
    const stage = byId('stage');
    const { canvas } = this.picture;
    try {
      const hit = await this.connection.call('pick', {
        x: Math.min(Math.floor((x / stage.clientWidth) * canvas.width), canvas.width - 1),
        y: Math.min(Math.floor((y / stage.clientHeight) * canvas.height), canvas.height - 1),
      });
      this.#choosePicked(hit);
    } catch (error) {
      this.toasts.showError(/** @type {any} */ (error));
    }
  }

  #choosePicked(/** @type {any} */ hit) {
    if (!hit.hit) {
      this.selection.clear();
      return;
    }
    const world = this.document.worldFromNode(hit.node);
    const anchorNode = unmapDirection(world, subtract(hit.position, world[3]));
    const lightId = this.document.find('node', hit.node)?.light ?? null;
    const distance = length(subtract(hit.position, this.camera.pose.eye));
    this.selection.choose({
      nodeId: hit.node,
      lightId,
      materialId: hit.material,
      hit: { ...hit, distance },
      anchorNode,
    });
  }

  /** Where the handle is: at the light, where the object was clicked, or at its origin. */
  #handlePosition() {
    const { lightId, nodeId, anchorNode } = this.selection;
    const light = this.document.find('light', lightId ?? undefined);
    if (light) return /** @type {Vector} */ (light.position);
    if (nodeId === null || !this.document.find('node', nodeId)) return null;
    return mapPoint(this.document.worldFromNode(nodeId), anchorNode ?? [0, 0, 0]);
  }

  #drawOverlay() {
    this.darkHint.refresh();
    this.overlay.lights = this.document.data?.lights ?? [];
    this.overlay.chosenLight = this.selection.lightId;
    this.overlay.handle = this.#handlePosition();
    this.overlay.draw();
  }

  #drag(/** @type {{position: Vector, isLast: boolean}} */ { position, isLast }) {
    const { lightId, nodeId, anchorNode } = this.selection;
    if (lightId !== null) {
      this.editor.update('light', lightId, { position }, !isLast);
      return;
    }
    const node = this.document.find('node', nodeId ?? undefined);
    if (!node) return;
    const world = this.document.worldFromNode(node.id);
    const offset = mapDirection(world, anchorNode ?? [0, 0, 0]);
    const shift = subtract(subtract(position, offset), world[3]);
    const parentShift =
      node.parent === null
        ? shift
        : unmapDirection(this.document.worldFromNode(node.parent), shift);
    if (!parentShift) return;
    const translation = add(node.translation, parentShift);
    this.editor.update('node', node.id, { translation }, !isLast);
  }

  #stageKey(/** @type {KeyboardEvent} */ event) {
    if (event.ctrlKey || event.metaKey) return;
    const stage = byId('stage');
    if (event.key === 'Enter') this.#pick(stage.clientWidth / 2, stage.clientHeight / 2);
    else if (event.key === 'Escape') this.selection.clear();
    else if (event.key === 'f' || event.key === 'F') this.frameSelection();
    else return;
    event.preventDefault();
  }

  #bindTools() {
    byId('tool-undo').addEventListener('click', () => this.editor.undo());
    byId('tool-redo').addEventListener('click', () => this.editor.redo());
    byId('tool-frame').addEventListener('click', () => this.frameSelection());
    byId('tool-fly').addEventListener('click', () => {
      this.view.chooseMode(this.view.mode === 'fly' ? 'orbit' : 'fly');
    });
    const panelButton = byId('tool-panel');
    panelButton.addEventListener('click', () => {
      const panel = byId('panel');
      panel.hidden = !panel.hidden;
      panelButton.setAttribute('aria-expanded', String(!panel.hidden));
    });
    window.addEventListener('keydown', (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.target instanceof HTMLInputElement) return;
      const key = event.key.toLowerCase();
      if (key !== 'z' && key !== 'y') return;
      event.preventDefault();
      if (key === 'y' || event.shiftKey) this.editor.redo();
      else this.editor.undo();
    });
  }
}
