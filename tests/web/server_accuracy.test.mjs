// Proves that clients measure accuracy as PROTOCOL.md says. A measurement goes from the reference
// to the last configuration, reports its progress, leaves files that hold finite figures and
// nothing else, ends when it is told to, and goes with its client. Another client's images stay the
// same bits and keep coming. A configuration changes only its own client's images.
// Run: VOXCASTD=build/release/bin/voxcastd node --test tests/web/server_accuracy.test.mjs
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import net from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, describe, test } from 'node:test';

import { Client, startDaemon, stopDaemon } from './client.mjs';

const QUICK = ['live', 'none', 'draft', 'interactive', 'high', 'final'];
const OVER = ['done', 'cancelled', 'failed'];

/** A client with a small view of its own whose image has come to rest. */
async function arrive(daemon, view = {}) {
  const client = await Client.open(daemon.url);
  client.hello = (await client.call('session.hello', {})).result;
  await client.call('view.configure', { width: 64, height: 36, ...view });
  await settled(client);
  return client;
}

/** Waits for a converged frame that comes after the first `from`. */
const settled = (client, from = 0) =>
  client.until(
    () => client.frames.slice(from).find(({ converged }) => converged),
    'an image at rest',
  );

const progress = (client, id) =>
  client.notifications
    .filter(({ method, params }) => method === 'accuracy.progress' && params.measurement === id)
    .map(({ params }) => params);

/** Waits until a notification of the measurement fulfils `check`. */
const heard = (client, id, check, what) =>
  client.until(() => progress(client, id).find(check), what);

async function start(client, params) {
  const { result, error } = await client.call('accuracy.start', params);
  assert.ok(result, JSON.stringify(error));
  return result;
}

const inState = (...states) => ({ state }) => states.includes(state);

const get = (daemon, id, file) => fetch(`${daemon.http}/accuracy/${id}/${file}`);

/** The status line that answers a request whose path is sent unchanged. */
function rawStatus(port, path) {
  return new Promise((resolve, reject) => {
    const socket = net.connect(port, '127.0.0.1', () =>
      socket.write(`GET ${path} HTTP/1.1\r\nHost: x\r\n\r\n`),
    );
    let text = '';
    socket.setTimeout(5000, () => reject(new Error(`no answer to ${path}`)));
    socket.on('data', (data) => (text += data));
    socket.on('close', () => resolve(text.split('\r\n')[0]));
    socket.on('error', reject);
  });
}

/** Turns the camera and waits for the image at rest there. */
async function look(client, x, revision) {
  const from = client.frames.length;
  const { fov_y_rad: fov } = client.hello.camera;
  await client.call('camera.set', {
    eye: [x, 0.27, 1.08],
    target: [0, 0.27, 0],
    fov_y_rad: fov,
    revision,
  });
  return client.until(
    () =>
      client.frames
        .slice(from)
        .find((frame) => frame.converged && frame.cameraRevision === revision),
    'the image of a camera',
    60000,
  );
}

describe('accuracy', () => {
  let daemon, folder;
  const folders = () => readdirSync(folder).filter((name) => name.startsWith('voxcast-accuracy-'));
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'voxcast-test-'));
    process.env.TMPDIR = folder;
    daemon = await startDaemon(['--scene', 'builtin:cornell']);
  });
  // A measurement left by a failed test would make the next one wait.
  afterEach(() => Client.closeAll());
  after(async () => {
    assert.equal(await stopDaemon(daemon), 0);
    assert.deepEqual(readdirSync(folder), [], 'the daemon leaves no files');
    rmSync(folder, { recursive: true });
  });

  test('refuses what it does not know', async () => {
    const client = await arrive(daemon);
    const refused = async (method, params, field, pattern) => {
      const { error } = await client.call(method, params);
      assert.equal(error?.code, -32602, `${method} ${JSON.stringify(params)}`);
      assert.equal(error.data.field, field);
      assert.match(error.message, pattern);
    };
    await refused('accuracy.start', { ladder: 'steep' }, 'ladder', /quick, full/);
    await refused('accuracy.start', { noise: 0.5 }, 'noise', /0\.0005 to 0\.1/);
    await refused('accuracy.start', { seconds: 0.5 }, 'seconds', /1 to 86400/);
    await refused('accuracy.start', { noise: 'low' }, 'noise', /number/);
    await refused('accuracy.start', { rungs: 3 }, 'rungs', /no parameter/);
    await refused('view.configure', { rung: 'draft' }, 'rung', /nothing has been measured/);
    assert.deepEqual(
      (await client.call('accuracy.cancel', {})).result,
      {},
      'nothing to end is no error',
    );
    await client.call('settings.update', { set: { gi_method: 'reference' } });
    await refused('accuracy.start', {}, 'gi_method', /choose none, clipmap or grid/);
    await client.call('settings.update', { set: { gi_method: 'clipmap' } });
    assert.deepEqual(folders(), []);
    await client.close();
  });

  test('measures the reference and every configuration', async () => {
    const client = await arrive(daemon);
    const { measurement: id, epoch, revision, ...facts } = await start(client, { noise: 0.1 });
    assert.match(id, /^[0-9a-f]{32}$/);
    assert.equal(epoch, client.hello.epoch);
    assert.deepEqual(facts, { rung_count: QUICK.length, width: 64, height: 36 });
    assert.equal((await get(daemon, id, 'results.json')).status, 404, 'nothing is there yet');
    // An edit does not change what is measured.
    await heard(client, id, inState('reference'), 'the reference');
    const edit = await client.call('light.add', { set: { type: 'point', intensity: 5 } });
    assert.ok(edit.result);
    const first = await heard(client, id, ({ done }) => done === 1, 'the first configuration');
    const early = await get(daemon, id, 'results.json');
    assert.equal(early.headers.get('cache-control'), 'no-store');
    assert.equal((await early.json()).rungs[0].name, 'live');
    assert.ok(first.seconds_left > 0);
    await heard(client, id, inState(...OVER), 'the end');
    const all = progress(client, id);
    const states = all.map(({ state }) => state).filter((state, i, list) => state !== list[i - 1]);
    assert.deepEqual(states, ['queued', 'reference', 'rungs', 'done'], JSON.stringify(all.at(-1)));
    assert.deepEqual(
      all.filter(({ state, rung }) => state === 'rungs' && rung).map(({ rung }) => rung),
      QUICK,
    );
    assert.ok(all.at(-1).noise > 0 && all.at(-1).noise <= 0.1 && all.at(-1).samples > 0);
    assert.equal(all.at(-1).done, QUICK.length);
    const results = await (await get(daemon, id, 'results.json')).json();
    assert.deepEqual(results.rungs.map(({ name }) => name), QUICK);
    for (const { name, frame_ms: time, converged, pictures } of results.rungs) {
      assert.ok(time.median > 0, `${name}: time`);
      for (const [metric, value] of Object.entries({ ...converged.metrics, ...converged.indirect }))
        assert.ok(Number.isFinite(value), `${name}: ${metric} is ${value}`);
      for (const file of Object.values(pictures)) {
        const answer = await get(daemon, id, file);
        assert.equal(answer.headers.get('content-type'), 'image/png');
        assert.equal(
          Buffer.from(await answer.arrayBuffer())
            .subarray(1, 4)
            .toString(),
          'PNG',
          file,
        );
      }
    }
    const flip = (name) =>
      results.rungs.find((configuration) => configuration.name === name).converged.metrics.ldr_flip;
    assert.ok(
      flip('live') < 0.5 * flip('none'),
      `${flip('live')} against ${flip('none')} without indirect light`,
    );
    assert.equal((await get(daemon, id, 'reference.png')).status, 200);
    const { scene, exposure } = results.setup;
    assert.deepEqual([scene.width, scene.height, scene.source], [64, 36, 'builtin:cornell']);
    assert.ok(Math.abs(scene.fov_y_rad - client.hello.camera.fov_y_rad) < 1e-6);
    assert.deepEqual([scene.revision, revision + 1], [revision, edit.result.revision]);
    assert.ok(exposure > 0);
    await client.call('light.remove', { id: edit.result.id });
    await client.close();
  });

  test('serves what it has measured and nothing else', async () => {
    const client = await arrive(daemon);
    const { measurement: id } = await start(client, { noise: 0.1 });
    await heard(client, id, ({ done }) => done >= 1, 'a configuration');
    assert.match(await rawStatus(daemon.port, `/accuracy/${id}/reference.png`), / 200/);
    const other = id.replace(/./g, (digit) => (digit === '0' ? '1' : '0'));
    for (const path of [
      `/accuracy/${id}`,
      `/accuracy/${id}/`,
      `/accuracy/${id}/results.json/`,
      `/accuracy/${id}/results.json%00.png`,
      `/accuracy/${id}/none-strip.png.new`,
      `/accuracy/${id}/../${id}/results.json.new`,
      `/accuracy/${id}/../../etc/passwd`,
      `/accuracy/${id}/%2e%2e/%2e%2e/etc/passwd`,
      `/accuracy/${id}/..%2f..%2fetc%2fpasswd`,
      `/accuracy/${id.slice(1)}/results.json`,
      `/accuracy/${id.toUpperCase().replace(/[0-9]/g, 'A')}/results.json`,
      `/accuracy/${other}/results.json`,
      '/accuracy/',
      '/accuracy',
    ])
      // A request that is no path at all closes the connection.
      assert.match(await rawStatus(daemon.port, path), /^$| 40[34] /, path);
    await client.close();
    await client.until(() => folders().length === 0, 'the folder goes with the client');
  });

  test('ends when it is told to, in every state, and when its client leaves', async () => {
    const client = await arrive(daemon);
    // The noise that is wanted here takes minutes.
    const traced = await start(client, { noise: 0.0005 });
    await heard(client, traced.measurement, ({ noise }) => noise > 0, 'noise of the reference');
    await client.call('accuracy.cancel', {});
    await heard(
      client,
      traced.measurement,
      inState('cancelled'),
      'the end while the reference is traced',
    );
    assert.equal((await get(daemon, traced.measurement, 'results.json')).status, 404);
    // A new measurement replaces the old one.
    const measured = await start(client, { noise: 0.1, ladder: 'full' });
    assert.equal(measured.rung_count, 53); // the live one and those of the sweep
    await client.until(() => folders().length === 1, 'the folder of the old one is gone');
    await heard(client, measured.measurement, ({ done }) => done === 1, 'a configuration');
    await client.call('accuracy.cancel', {});
    const end = await heard(
      client,
      measured.measurement,
      inState(...OVER),
      'the end while configurations are measured',
    );
    assert.equal(end.state, 'cancelled');
    const results = await (await get(daemon, measured.measurement, 'results.json')).json();
    assert.equal(results.rungs.length, end.done, 'what has been measured stays');
    assert.ok(results.rungs.every(({ edit }) => !edit.error), 'no configuration is there in part');
    // Where noise does not fall in time, the reference image is used as it is.
    const hasty = await start(client, { noise: 0.0005, seconds: 1 });
    const noisy = await heard(
      client,
      hasty.measurement,
      inState('rungs'),
      'configurations after a second',
    );
    assert.ok(noisy.noise > 0.0005, `noise ${noisy.noise}`);
    // Many requests at once leave one measurement.
    const replies = await Promise.all(
      Array.from({ length: 40 }, () => client.call('accuracy.start', {})),
    );
    assert.equal(new Set(replies.map(({ result }) => result.measurement)).size, 40);
    await client.until(() => folders().length === 1, 'the folders of all but the last are gone');
    // A waiting measurement ends at once; one whose client leaves leaves nothing behind.
    const second = await arrive(daemon);
    const running = await start(client, { noise: 0.0005 });
    assert.equal((await get(daemon, measured.measurement, 'results.json')).status, 404, 'replaced');
    const waiting = await start(second, { noise: 0.1 });
    await heard(client, running.measurement, inState('reference'), 'the first of two');
    assert.deepEqual(progress(second, waiting.measurement).map(({ state }) => state), ['queued']);
    await second.call('accuracy.cancel', {});
    await heard(second, waiting.measurement, inState('cancelled'), 'the end in the queue');
    const last = await start(second, { noise: 0.1 });
    await client.close();
    await heard(second, last.measurement, inState('reference'), 'the turn of the second');
    await second.until(() => folders().length === 1, 'the folder of the client that left is gone');
    await heard(
      second,
      last.measurement,
      ({ done }) => done === 1,
      'a configuration of the second',
    );
    await second.close();
    const third = await arrive(daemon);
    await third.until(() => folders().length === 0, 'no folder is left');
    await third.close();
  });

  test('leaves others alone', async () => {
    const client = await arrive(daemon);
    const other = await arrive(daemon);
    // All views share one grid, which other settings would reset.
    await client.call('settings.update', { set: { gi_method: 'grid' } });
    const times = {
      alone: [],
      'while the reference is traced': [],
      'while configurations are measured': [],
    };
    let pictures = [],
      revision = 0;
    /** Images at rest from three positions; records how long each first frame took. */
    const tour = async (when) => {
      const seen = [];
      for (const x of [0.1, -0.15, 0]) {
        const asked = performance.now(), from = other.frames.length;
        const rest = look(other, x, ++revision);
        const moved = ({ cameraRevision }) => cameraRevision === revision;
        await other.until(
          () => other.frames.slice(from).find(moved),
          'the first frame of a camera',
        );
        times[when]?.push(performance.now() - asked);
        seen.push((await rest).jpeg);
      }
      return seen;
    };
    const same = (seen) => seen.every((picture, i) => pictures[i]?.equals(picture));
    const check = async (when) =>
      assert.ok(same(await tour(when)), `${when}: the same bits as before`);
    // The cache converges where somebody first looks, so that the first images are not the last.
    for (let i = 0, seen = await tour(); !same(seen) && i < 10; i++, seen = await tour())
      pictures = seen;
    for (let i = 0; i < 3; i++) await check('alone');
    const { measurement: id } = await start(client, { noise: 0.005, ladder: 'full' });
    await heard(client, id, ({ samples }) => samples > 0, 'samples');
    for (let i = 0; i < 3; i++) await check('while the reference is traced');
    await client.call('accuracy.cancel', {});
    const second = await start(client, { noise: 0.1, ladder: 'full' });
    await heard(client, second.measurement, inState('rungs'), 'configurations');
    for (let i = 0; i < 6; i++) await check('while configurations are measured');
    assert.ok(
      !progress(client, second.measurement).some(inState(...OVER)),
      'configurations are still being measured',
    );
    await client.call('accuracy.cancel', {});
    await heard(client, second.measurement, inState('cancelled'), 'the end');
    await check('after');
    // Configurations of other rows, methods, voxels, bounces, sizes.
    for (const configuration of [
      'none',
      'draft',
      'final',
      'grid-bounces-1',
      'grid-cone_set-5',
      'clipmap-64-pixel',
      '',
    ]) {
      const from = client.frames.length;
      await client.call('view.configure', { rung: configuration });
      await check(`beside configuration ${configuration}`);
      await settled(client, from);
      await check(`after configuration ${configuration}`);
    }
    for (const [when, list] of Object.entries(times)) {
      list.sort((a, b) => a - b);
      console.log(
        `${when}: first frame after ${list[list.length >> 1].toFixed(0)} ms, ` +
          `${list.at(-1).toFixed(0)} at most`,
      );
    }
    await client.call('settings.update', { set: { gi_method: 'clipmap' } });
    await client.close();
    await other.close();
  });

  test('draws one view by a configuration', async () => {
    const client = await arrive(daemon, { quality: 'interactive' });
    const other = await arrive(daemon);
    const plain = client.frames.at(-1).jpeg, others = other.frames.length;
    const { measurement: id } = await start(client, { noise: 0.1, ladder: 'full' });
    const drawWith = async (name) => {
      const from = client.frames.length;
      const { result, error } = await client.call('view.configure', { rung: name });
      assert.equal(result?.rung, name, JSON.stringify(error));
      return settled(client, from);
    };
    await client.call('accuracy.cancel', {});
    await heard(client, id, inState('cancelled'), 'the end');
    const none = await drawWith('none');
    assert.ok(!none.jpeg.equals(plain), 'without indirect light it looks different');
    const half = await drawWith('grid-scale-0.5');
    assert.deepEqual([half.width, half.height], [32, 18]);
    assert.ok(
      (await drawWith('live')).jpeg.equals(plain),
      'the live configuration is what was there',
    );
    const bad = await client.call('view.configure', { rung: 'best', width: 32 });
    assert.equal(bad.error?.data.field, 'rung');
    assert.match(bad.error.message, /no configuration "best"; measured are live, none, draft/);
    assert.equal(
      (await client.call('view.configure', {})).result.width,
      64,
      'nothing of it was set',
    );
    // Edits of shared settings take effect if they are about how images are displayed.
    await drawWith('draft');
    let from = client.frames.length;
    await client.call('settings.update', { set: { exposure_ev: 1 } });
    await settled(client, from);
    await client.call('settings.update', { set: { exposure_ev: 0 } });
    await start(client, { noise: 0.1 });
    assert.equal(
      (await client.call('view.configure', {})).result.rung,
      '',
      'a new measurement clears it',
    );
    from = client.frames.length;
    await client.call('accuracy.cancel', {});
    await drawWith('none');
    assert.ok((await drawWith('')).jpeg.equals(plain), 'back to what was there');
    await drawWith('none');
    const loaded = await client.call('scene.load', { source: 'builtin:furnace' });
    assert.ok(loaded.result, JSON.stringify(loaded.error));
    assert.equal(
      (await client.call('view.configure', {})).result.rung,
      '',
      'a new scene clears it',
    );
    assert.ok(other.frames.length >= others);
    await client.close();
    await other.close();
  });
});
