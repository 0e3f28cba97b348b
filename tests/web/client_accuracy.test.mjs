// Proves what the panel's accuracy tab computes, without a browser: which configuration fits a
// budget, when two cameras see the same, the colours of the error map, and the state of a
// measurement from the server's messages.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { pickConfiguration } from '../../web_client/accuracy/budget.js';
import { EditWatch } from '../../web_client/accuracy/edit_watch.js';
import { heatMapColor } from '../../web_client/accuracy/heat_map.js';
import { Measurement } from '../../web_client/accuracy/measurement.js';
import { isSameAspect, isSamePose } from '../../web_client/accuracy/same_view.js';
import { durationText, msText, percentText } from '../../web_client/accuracy/words.js';
import { SceneDocument } from '../../web_client/scene/scene_document.js';

// Node 18, Debian 12's, lacks what every browser has.
globalThis.CustomEvent ??= class extends Event {
  constructor(type, options) {
    super(type, options);
    this.detail = options?.detail ?? null;
  }
};

const configuration = (name, ms, flip) => ({
  name,
  frame_ms: { median: ms },
  converged: { ms: 10 * ms, metrics: { ldr_flip: flip } },
});

test('a budget calls for the least error among what is fast enough', () => {
  const configurations = [
    configuration('none', 5, 0.4),
    configuration('draft', 16, 0.2),
    configuration('good', 30, 0.1),
    configuration('worse', 31, 0.15),
    configuration('best', 900, 0.05),
  ];
  const names = [16, 33, 100, Infinity].map(
    (ms) => pickConfiguration(configurations, ms).best.name,
  );
  assert.deepEqual(names, ['draft', 'good', 'good', 'best']);
  const slow = pickConfiguration(configurations, 4);
  assert.equal(slow.best, null);
  assert.equal(slow.fastest.name, 'none');
});

test('of equal errors the faster is taken; what has no figures is left out', () => {
  const configurations = [
    configuration('slow', 20, 0.1),
    configuration('fast', 10, 0.1),
    configuration('broken', 1, null),
    { name: 'empty' },
  ];
  assert.equal(pickConfiguration(configurations, 33).best.name, 'fast');
  assert.deepEqual(pickConfiguration([{ name: 'empty' }], 33), { best: null, fastest: null });
});

const pose = { eye: [0, 1, 4], target: [0, 1, 0], up: [0, 1, 0], fov_y_rad: 0.7 };

test('a pose is the same in single precision and with another target ahead', () => {
  const single = Object.fromEntries(
    Object.entries(pose).map(([key, value]) => [
      key,
      Array.isArray(value) ? value.map(Math.fround) : Math.fround(value),
    ]),
  );
  assert.ok(isSamePose(pose, single));
  assert.ok(isSamePose(pose, { ...pose, target: [0, 1, 3], up: [0, 2, 0.5] }));
});

test('a pose is another one by a pixel of position, direction, roll or lens', () => {
  assert.ok(!isSamePose(pose, { ...pose, eye: [0.005, 1, 4], target: [0.005, 1, 0] }));
  assert.ok(!isSamePose(pose, { ...pose, target: [0.005, 1, 0] }));
  assert.ok(!isSamePose(pose, { ...pose, up: [0.002, 1, 0] }));
  assert.ok(!isSamePose(pose, { ...pose, fov_y_rad: 0.701 }));
  assert.ok(isSameAspect(640 / 360, 319 / 180));
  assert.ok(!isSameAspect(640 / 360, 300 / 180));
});

test('the scale has the colours that the server paints errors with', () => {
  // heat_map_color() of renderer/metrics/heat_map.c, at eighths.
  const painted = [
    [0, 0, 0],
    [13, 0, 22],
    [59, 0, 51],
    [116, 0, 62],
    [179, 0, 45],
    [214, 82, 0],
    [232, 143, 30],
    [229, 203, 141],
    [245, 245, 245],
  ];
  painted.forEach((color, i) => {
    const difference = heatMapColor(i / 8).map((value, c) => Math.abs(value - color[c]));
    assert.ok(Math.max(...difference) <= 1, `${i}: ${heatMapColor(i / 8)}`);
  });
});

test('numbers read well', () => {
  assert.deepEqual([0.4, 89, 90, 3600, 7200].map(durationText), [
    '1 s',
    '89 s',
    '2 min',
    '60 min',
    '2.0 h',
  ]);
  assert.equal(durationText(null), '');
  assert.deepEqual([3.14, 16.4, 1234, 45678].map(msText), ['3.1 ms', '16 ms', '1.2 s', '46 s']);
  assert.equal(percentText(0.0312), '3.1 %');
});

/** A measurement whose server answers `start` when told to, and has `files`. */
function makeMeasurement() {
  const server = { calls: [], files: new Map(), fetched: [] };
  const connection = {
    call: (method, params) => {
      server.calls.push({ method, params });
      return new Promise((resolve) => (server.reply = resolve));
    },
  };
  const getJson = async (url) => {
    server.fetched.push(url);
    return server.files.get(url) ?? null;
  };
  return { server, measurement: new Measurement(connection, 'http://host/at/', getJson) };
}

const settle = () => new Promise((done) => setTimeout(done, 5));

async function begin({ server, measurement }, id = 'a1', revision = 40) {
  const started = measurement.start({ ladder: 'quick', noise: 0.01, seconds: 60 });
  server.reply({ measurement: id, rung_count: 6, width: 64, height: 36, epoch: 1, revision });
  await started;
  await settle();
}

test('results are read after each configuration, those of the newest measurement', async () => {
  const both = makeMeasurement();
  const { server, measurement } = both;
  await begin(both);
  assert.ok(measurement.isRunning);
  server.files.set('http://host/at/accuracy/a1/results.json', { rungs: [{ name: 'live' }] });
  measurement.takeProgress({ measurement: 'a1', state: 'rungs', done: 1, rung_count: 6 });
  await settle();
  assert.equal(measurement.configuration('live').name, 'live');
  assert.ok(measurement.hasReference);
  assert.equal(measurement.url('live-error.png'), 'http://host/at/accuracy/a1/live-error.png');
  await begin(both, 'b2');
  assert.deepEqual(measurement.configurations, []);
  measurement.takeProgress({ measurement: 'a1', state: 'done', done: 6, rung_count: 6 });
  assert.equal(measurement.progress.state, 'queued');
  assert.ok(measurement.isRunning);
});

test('progress that comes before the reply counts', async () => {
  const { server, measurement } = makeMeasurement();
  const started = measurement.start({ ladder: 'quick', noise: 0.01, seconds: 60 });
  measurement.takeProgress({ measurement: 'c3', state: 'failed', message: 'no memory' });
  server.reply({ measurement: 'c3', rung_count: 6 });
  await started;
  assert.equal(measurement.progress.message, 'no memory');
  assert.ok(!measurement.isRunning);
});

test('what ends while results are on their way is read once more', async () => {
  const both = makeMeasurement();
  const { server, measurement } = both;
  await begin(both);
  const count = server.fetched.length;
  for (let done = 0; done <= 3; done++)
    measurement.takeProgress({ measurement: 'a1', state: 'rungs', done, rung_count: 6 });
  await settle();
  assert.equal(server.fetched.length - count, 2);
});

test('another scene leaves nothing', async () => {
  const both = makeMeasurement();
  await begin(both);
  both.measurement.forget();
  assert.equal(both.measurement.id, '');
  assert.ok(!both.measurement.isRunning);
});

test('says what has been edited since, by revisions', async () => {
  const both = makeMeasurement();
  const scene = new SceneDocument();
  const connection = new EventTarget();
  scene.load({ lights: [{ id: 0 }], settings: {}, animations: [], nodes: [], materials: [] });
  const watch = new EditWatch(connection, scene, both.measurement);
  const edit = (method, revision) => {
    const detail = { method: 'scene.changed', params: { edits: [{ method, revision }] } };
    connection.dispatchEvent(new CustomEvent('notification', { detail }));
  };
  edit('light.update', 39);
  assert.equal(watch.words, '');
  await begin(both);
  assert.equal(watch.words, '');
  edit('light.update', 40); // was on its way
  assert.equal(watch.words, '');
  edit('settings.update', 41);
  assert.match(watch.words, /settings/);
  edit('light.update', 42);
  assert.match(watch.words, /scene has been edited/);
  await begin(both, 'b2', 42);
  assert.equal(watch.words, '');
  scene.data.animations.push({ id: 0, playing: true });
  assert.match(watch.words, /animation/);
});
