// Proves the client's state without a browser: the document after edits as scene.changed brings
// them, and the times from edit to photon.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { EditTimer } from '../../web_client/scene/edit_timer.js';
import { SceneDocument } from '../../web_client/scene/scene_document.js';

// Node 18, Debian 12's, lacks what every browser has.
globalThis.CustomEvent ??= class extends Event {
  constructor(type, options) {
    super(type, options);
    this.detail = options?.detail ?? null;
  }
};

const fresh = () => false;

function makeDocument() {
  const scene = new SceneDocument();
  const node = { mesh: null, light: null, camera: null, rotation: [0, 0, 0, 1], scale: [1, 1, 1] };
  scene.load({
    nodes: [{ ...node, id: 0, parent: null, mesh: 0, translation: [1, 0, 0] }],
    lights: [],
    materials: [{ id: 0, roughness: 1 }],
    animations: [],
    environment: { intensity: 1 },
    bounds: { min: [-1, 0, -1], max: [1, 2, 1] },
  });
  const light = { id: 4, node: 7, position: [0, 1, 0], intensity: 1 };
  const lightNode = { ...node, id: 7, parent: 0, light: 4, translation: [-1, 1, 0] };
  return { scene, light, lightNode };
}

test('applies updates to things, to the environment and to what moves along', () => {
  const { scene, light, lightNode } = makeDocument();
  scene.apply({ method: 'light.add', id: 4, light, node: lightNode }, fresh);
  scene.apply({ method: 'material.update', id: 0, set: { roughness: 0.25 } }, fresh);
  scene.apply({ method: 'environment.update', set: { intensity: 3 } }, fresh);
  scene.apply(
    {
      method: 'node.update',
      id: 0,
      set: { translation: [2, 0, 0] },
      lights: [{ id: 4, position: [1, 1, 0], direction: [0, 0, -1] }],
    },
    fresh,
  );
  assert.equal(scene.find('material', 0).roughness, 0.25);
  assert.equal(scene.find('environment').intensity, 3);
  assert.deepEqual(scene.find('light', 4).position, [1, 1, 0]);
  assert.deepEqual(scene.worldFromNode(7)[3], [1, 1, 0]);
});

test('a loaded environment has its image, until an undo takes it back', () => {
  const { scene } = makeDocument();
  scene.apply({ method: 'environment.load', name: 'noon.exr', set: { type: 'equirect' } }, fresh);
  assert.deepEqual(scene.find('environment'), {
    intensity: 1,
    type: 'equirect',
    image: 'noon.exr',
    has_picture: true,
  });
  scene.apply({ method: 'environment.load', name: null, set: { type: 'none' } }, fresh);
  assert.deepEqual(scene.find('environment'), {
    intensity: 1,
    type: 'none',
    image: null,
    has_picture: false,
  });
});

test('a removed light takes its node along; undo brings both back', () => {
  const { scene, light, lightNode } = makeDocument();
  scene.apply({ method: 'light.add', id: 4, light, node: lightNode }, fresh);
  scene.apply({ method: 'light.remove', id: 4 }, fresh);
  assert.equal(scene.find('light', 4), undefined);
  assert.equal(scene.find('node', 7), undefined);
  scene.apply({ method: 'light.add', id: 4, light, node: lightNode }, fresh);
  scene.apply({ method: 'light.add', id: 4, light, node: lightNode }, fresh);
  assert.equal(scene.data.lights.length, 1, 'never twice');
  assert.equal(scene.data.nodes.length, 2);
});

test('fields with a newer value on its way stay', () => {
  const { scene } = makeDocument();
  scene.assign('material', 0, { roughness: 0.9 });
  const isStale = (group, id, field) => group === 'material' && id === 0 && field === 'roughness';
  scene.apply({ method: 'material.update', id: 0, set: { roughness: 0.5, metallic: 1 } }, isStale);
  assert.equal(scene.find('material', 0).roughness, 0.9);
  assert.equal(scene.find('material', 0).metallic, 1);
});

test('times each edit until a frame shows it', () => {
  const timer = new EditTimer();
  timer.begin(1, 100);
  timer.begin(2, 110);
  timer.begin(3, 120);
  timer.drop(2);
  assert.equal(timer.present(0, 130), null, 'a frame from before');
  assert.equal(timer.present(2, 150), 50);
  assert.equal(timer.present(2, 160), null, 'only once');
  assert.equal(timer.present(9, 170), 50);
  assert.deepEqual(timer.times, [50, 50]);
});
