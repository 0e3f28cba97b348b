// Proves that the running daemon keeps to PROTOCOL.md: starts voxcastd on a free port with a
// built-in scene, talks to it as browsers and hostile programs do, and checks the replies.
// Run: VOXCASTD=build/release/bin/voxcastd node --test tests/web/server.test.mjs
import assert from 'node:assert/strict';
import { mkdtempSync, writeFileSync } from 'node:fs';
import net from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';

import { Client, sleep, startDaemon, stopDaemon } from './client.mjs';

/** Sends raw bytes; resolves with all that comes until the server closes the connection. */
function raw(port, ...requests) {
  return new Promise((resolve, reject) => {
    const socket = net.connect(port, '127.0.0.1');
    let text = '';
    socket.setTimeout(3000, () => reject(new Error('the server did not close')));
    socket.on('data', (data) => (text += data));
    socket.on('close', () => resolve(text));
    socket.on('error', () => resolve(text));
    for (const request of requests) socket.write(request.replaceAll('\n', '\r\n'));
  });
}

async function hello(daemon, params = {}, options = {}) {
  const client = await Client.open(daemon.url, options);
  client.hello = (await client.call('session.hello', params)).result;
  return client;
}

describe('one daemon', () => {
  let daemon;
  before(
    async () => (daemon = await startDaemon(['--scene', 'builtin:cornell', '--max-clients', '4'])),
  );
  after(() => stopDaemon(daemon));

  test('answers operators', async () => {
    assert.equal(await (await fetch(`${daemon.http}/healthz`)).text(), 'ok\n');
    const ready = await (await fetch(`${daemon.http}/readyz`)).json();
    assert.ok(ready.ready && ready.gl_renderer && ready.scene);
    assert.match(await (await fetch(`${daemon.http}/metrics`)).text(), /voxcast_clients \d/);
  });

  test('serves files of the web client and nothing else', async () => {
    const file = await fetch(`${daemon.http}/package.json`);
    assert.equal(file.headers.get('content-type'), 'application/json');
    assert.equal(file.headers.get('cache-control'), 'no-cache');
    assert.match(file.headers.get('content-security-policy'), /img-src 'self' blob:/);
    for (const path of ['/../LICENSE', '/%2e%2e/LICENSE', '/..%2fLICENSE', '/.gitignore', '/none'])
      assert.match(
        await raw(daemon.port, `GET ${path} HTTP/1.1\nHost: x\n\n`),
        /^HTTP\/1.. 40[34]/,
      );
  });

  test('refuses a foreign origin, another subprotocol and other upgrades', async () => {
    await assert.rejects(Client.open(daemon.url, { origin: 'http://evil.example' }), {
      status: 403,
    });
    await assert.rejects(Client.open(daemon.url, { protocol: 'other' }), { status: 400 });
    const own = await Client.open(daemon.url, { origin: daemon.http });
    await own.close();
    const upgrade = 'GET / HTTP/1.1\nHost: x\nConnection: Upgrade\nUpgrade: nonsense\n\n';
    assert.match(await raw(daemon.port, upgrade), /403/);
    const get = 'GET /healthz HTTP/1.1\nHost: x\n\n';
    assert.doesNotMatch(await raw(daemon.port, get, upgrade), /101/);
    assert.equal((await fetch(`${daemon.http}/healthz`)).status, 200);
  });

  test('wants hello first, then describes itself', async () => {
    const client = await Client.open(daemon.url);
    assert.equal((await client.call('scene.get')).error.code, -32000);
    const { result } = await client.call('session.hello', { protocol: 1, name: 'Ada' });
    assert.equal(result.name, 'Ada');
    assert.equal(result.role, 'editor');
    assert.ok(result.parameters.length > 50);
    assert.ok(result.gl.renderer.length > 0);
    assert.equal((await client.call('session.hello')).error.code, -32600);
    await client.close();
  });

  test('answers garbage with the standard errors', async () => {
    const client = await hello(daemon);
    const send = async (text) => {
      const seen = client.notifications.length;
      client.socket.send(text);
      return client.until(
        () => client.notifications.slice(seen).find((n) => n.error)?.error,
        `an answer to ${text.slice(0, 60)}`,
      );
    };
    assert.equal((await send('{')).code, -32700);
    assert.equal((await send('{"a":1e999}')).code, -32700);
    assert.equal((await send('['.repeat(40) + ']'.repeat(40))).code, -32700);
    assert.equal((await send('[]')).code, -32600);
    assert.equal((await send('{"jsonrpc":"2.0","method":"pick","method":"pick"}')).code, -32600);
    assert.equal((await client.call('no.such')).error.code, -32601);
    const { error } = await client.call('settings.update', { set: { exposure_ev: 99 } });
    assert.equal(error.code, -32602);
    assert.deepEqual(error.data, { field: 'exposure_ev', value: '99', min: -16, max: 16 });
    const wrong = (await client.call('settings.update', { set: { tonemap: 'filmic' } })).error;
    assert.deepEqual(wrong.data.allowed, ['hable', 'aces', 'khronos_neutral', 'none']);
    assert.equal(
      (await client.call('light.update', { id: 999, set: { intensity: 1 } })).error.data.field,
      'id',
    );
    await client.close();
  });

  test('closes on oversize and binary messages', async () => {
    const large = await hello(daemon);
    large.socket.send(
      JSON.stringify({ jsonrpc: '2.0', method: 'x', params: { a: 'b'.repeat(70000) } }),
    );
    assert.equal((await large.closed).code, 1009);
    const binary = await hello(daemon);
    binary.socket.send(Buffer.from([1, 2, 3]));
    assert.equal((await binary.closed).code, 1003);
  });

  test('limits the number of clients', async () => {
    const clients = [];
    for (let i = 0; i < 4; i++) clients.push(await hello(daemon));
    await assert.rejects(Client.open(daemon.url), { status: 503 });
    await Promise.all(clients.map((client) => client.close()));
    await sleep(200);
    await (await hello(daemon)).close();
  });

  test('streams a frame, then nothing while nothing changes', async () => {
    const client = await hello(daemon);
    await client.call('view.configure', { width: 160, height: 90 });
    const frame = await client.until(() => client.frames.find((f) => f.width === 160), 'a frame');
    assert.equal(frame.magic, 'VXF1');
    assert.equal(frame.headerSize, 104);
    assert.equal(frame.jpegBytes, frame.jpeg.length);
    assert.equal(frame.jpeg.readUInt16BE(0), 0xffd8);
    await client.untilAtRest(1000);
    const count = client.frames.length;
    const notes = client.notifications.length;
    await sleep(1500);
    assert.equal(client.frames.length, count);
    assert.equal(client.notifications.length, notes);
    assert.ok(client.notifications.some((n) => n.method === 'stats' && n.params.passes.length > 0));
    await client.call('camera.set', { eye: [0.1, 1, 3.5], target: [0, 1, 0], revision: 7 });
    await client.until(() => client.frames.find((f) => f.cameraRevision === 7), 'the moved camera');
    await client.close();
  });

  test('tells of a camera that changes nothing, though no frame comes', async () => {
    const client = await hello(daemon);
    await client.call('view.configure', { width: 64, height: 36, quality: 'draft' });
    const pose = { eye: [0, 1, 3.2], target: [0, 1, 0] };
    await client.call('camera.set', { ...pose, revision: 1 });
    await client.until(
      () => client.frames.find((f) => f.width === 64 && f.cameraRevision === 1),
      'the camera in a frame',
    );
    await client.untilAtRest(1000);
    const count = client.frames.length;
    await client.call('camera.set', { ...pose, revision: 2 });
    const told = await client.until(
      () =>
        client.notifications.find(
          ({ method, params }) => method === 'stats' && params.camera_revision === 2,
        ),
      'the camera in the statistics',
    );
    assert.equal(told.params.frame_id, client.frames.at(-1).frameId);
    assert.equal(client.frames.length, count);
    await client.close();
  });

  test('has at most two frames under way', async () => {
    const client = await hello(daemon);
    client.acknowledge = false;
    for (let i = 0; i < 40; i++) {
      client.notify('camera.set', { eye: [i / 100, 1, 3.5], target: [0, 1, 0], revision: i + 1 });
      await sleep(25);
    }
    await client.until(() => client.frames.length >= 2, 'two frames');
    await sleep(500);
    assert.equal(client.frames.length, 2);
    client.acknowledge = true;
    client.notify('frame.ack', { frame_id: client.frames.at(-1).frameId });
    await client.until(() => client.frames.at(-1).cameraRevision === 40, 'the newest camera');
    await client.close();
  });

  test('tells edits to all, with author and newest edit id in the frame', async () => {
    const ada = await hello(daemon, { name: 'Ada' });
    const bob = await hello(daemon, { name: 'Bob' });
    const { result } = await ada.call('settings.update', {
      set: { exposure_ev: 1.5 },
      edit_id: 12,
    });
    assert.equal(result.edit_id, 12);
    for (const client of [ada, bob]) {
      const change = await client.until(
        () => client.notifications.find((n) => n.method === 'scene.changed')?.params,
        'scene.changed',
      );
      assert.equal(change.author.name, 'Ada');
      assert.equal(change.revision, result.revision);
      assert.deepEqual(change.edits[0].set, { exposure_ev: 1.5 });
    }
    await ada.until(() => ada.frames.find((f) => f.editId === 12), 'the edit in a frame');
    await Promise.all([ada.close(), bob.close()]);
  });

  test('merges drags and answers each', async () => {
    const client = await hello(daemon);
    const replies = [];
    for (let i = 1; i <= 60; i++)
      replies.push(
        client.call('settings.update', {
          set: { exposure_ev: i / 60 },
          edit_id: i,
          transient: true,
        }),
      );
    const answers = await Promise.all(replies);
    const covered = answers.flatMap((a) =>
      a.result.superseded ? [a.result.edit_id, ...a.result.superseded] : [],
    );
    assert.deepEqual(
      covered.sort((a, b) => a - b),
      Array.from({ length: 60 }, (_, i) => i + 1),
    );
    assert.equal((await client.call('scene.get')).result.settings.exposure_ev, 1);
    await client.close();
  });

  test('edits lights and materials, and takes them back', async () => {
    const client = await hello(daemon);
    const before = (await client.call('scene.get')).result;
    assert.ok(before.materials.length > 0 && before.nodes.length > 0 && before.bounds);
    const { id } = (
      await client.call('light.add', { set: { type: 'spot', intensity: 7, position: [0, 1, 0] } })
    ).result;
    let scene = (await client.call('scene.get')).result;
    const added = scene.lights.find((l) => l.id === id);
    assert.equal(added.intensity, 7);
    assert.deepEqual(added.position, [0, 1, 0]);
    await client.call('light.remove', { id });
    assert.equal((await client.call('edit.undo')).result.method, 'light.add');
    scene = (await client.call('scene.get')).result;
    assert.equal(scene.lights.find((l) => l.id === id).type, 'spot');
    assert.equal((await client.call('edit.undo')).result.method, 'light.remove');
    await client.call('material.update', {
      id: 0,
      set: { roughness: 0.25, base_color: [1, 0, 0, 1] },
    });
    assert.equal((await client.call('edit.undo')).result.method, 'material.update');
    scene = (await client.call('scene.get')).result;
    assert.deepEqual(scene.materials[0], before.materials[0]);
    assert.equal((await client.call('edit.redo')).result.method, 'material.update');
    scene = (await client.call('scene.get')).result;
    assert.equal(scene.materials[0].roughness, 0.25);
    await client.close();
  });

  test('replays missed edits after a reconnect', async () => {
    const first = await hello(daemon);
    const { epoch, revision } = first.hello;
    await first.call('settings.update', { set: { gamma: 2.25 } });
    await first.close();
    const second = await hello(daemon, { resume_epoch: epoch, resume_revision: revision });
    assert.equal(second.hello.resync, false);
    assert.deepEqual(second.hello.edits.map((e) => e.set), [{ gamma: 2.25 }]);
    const third = await hello(daemon, { resume_epoch: epoch - 1, resume_revision: revision });
    assert.equal(third.hello.resync, true);
    await Promise.all([second.close(), third.close()]);
  });

  test('picks what the view shows', async () => {
    const client = await hello(daemon);
    const { result } = await client.call('pick', { x: 320, y: 300 });
    assert.equal(result.hit, true);
    assert.equal(result.position.length, 3);
    assert.equal((await client.call('pick', { x: -1, y: 0 })).error.data.field, 'x');
    await client.close();
  });

  test('loads another scene, and keeps the old one on failure', async () => {
    const client = await hello(daemon);
    const { scenes } = (await client.call('scene.list')).result;
    assert.ok(scenes.length > 0);
    assert.equal((await client.call('scene.load', { source: '/etc/passwd' })).error.code, -32602);
    assert.equal((await client.call('scene.load', { source: 'builtin:none' })).error.code, -32602);
    const { result } = await client.call('scene.load', { source: scenes[0].source });
    assert.ok(result.epoch > client.hello.epoch);
    const loaded = client.notifications.find((n) => n.method === 'scene.loaded');
    assert.equal(loaded.params.source, scenes[0].source);
    await client.close();
  });
});

test('limits the rate of messages', async () => {
  const daemon = await startDaemon(['--scene', 'builtin:cornell', '--message-rate', '20']);
  const client = await hello(daemon);
  client.acknowledge = false;
  for (let i = 0; i < 100; i++) client.notify('view.configure', { paused: true });
  await client.until(() => client.notifications.find((n) => n.error?.code === -32003), 'the error');
  for (let i = 0; i < 500; i++) client.notify('view.configure', { paused: true });
  assert.equal((await client.closed).code, 4429);
  assert.equal(await stopDaemon(daemon), 0, daemon.log);
});

test('listens on its address alone', async () => {
  const daemon = await startDaemon();
  // All of 127.0.0.0/8 is this machine, but only 127.0.0.1 was asked for.
  const answer = await new Promise((resolve) => {
    const socket = net.connect(daemon.port, '127.0.0.2', () => {
      socket.destroy();
      resolve('connected');
    });
    socket.on('error', (error) => resolve(error.code));
  });
  assert.equal(answer, 'ECONNREFUSED');
  assert.equal(await stopDaemon(daemon), 0, daemon.log);
  await assert.rejects(
    startDaemon(['--listen', '203.0.113.1', '--port', String(daemon.port)]),
    /listen is 203\.0\.113\.1; allowed are/,
  );
});

test('wants the token', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'voxcast-'));
  writeFileSync(join(folder, 'token'), 'secret\n');
  writeFileSync(join(folder, 'viewer'), 'look\n');
  const daemon = await startDaemon([
    '--scene',
    'builtin:cornell',
    '--token-file', join(folder, 'token'), '--viewer-token-file', join(folder, 'viewer'),
  ]);
  await assert.rejects(Client.open(`${daemon.url}?token=wrong`), { status: 401 });
  const none = await Client.open(daemon.url);
  assert.equal((await none.call('session.hello')).error.code, -32001);
  assert.equal((await none.closed).code, 4401);
  const editor = await Client.open(`${daemon.url}?token=secret`);
  assert.equal((await editor.call('session.hello')).result.role, 'editor');
  const viewer = await Client.open(daemon.url);
  assert.equal((await viewer.call('session.hello', { token: 'look' })).result.role, 'viewer');
  assert.equal((await viewer.call('settings.update', { set: { gamma: 1 } })).error.code, -32001);
  // Measuring does not change the document.
  assert.ok((await viewer.call('accuracy.start', { noise: 0.1 })).result);
  assert.deepEqual((await viewer.call('accuracy.cancel', {})).result, {});
  assert.equal(await stopDaemon(daemon), 0, daemon.log);
  assert.equal((await editor.closed).code, 1001);
});

test('keeps the last good texture while its file is broken', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'voxcast-'));
  const path = join(folder, 'textured.obj');
  // A TGA image of one pixel: the format that is easiest to write by hand.
  const header = [0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0];
  const picture = (blue) => Buffer.from([...header, blue, 20, 30]);
  writeFileSync(join(folder, 'colour.tga'), picture(10));
  writeFileSync(join(folder, 'm.mtl'), 'newmtl m\nmap_Kd colour.tga\n');
  writeFileSync(path, 'mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n');
  const daemon = await startDaemon([path]);
  const client = await hello(daemon);
  const textures = async () => {
    const { materials } = (await client.call('scene.get')).result;
    return Object.keys(materials.find((m) => m.name === 'm').textures).length;
  };
  assert.equal(await textures(), 1);
  writeFileSync(join(folder, 'colour.tga'), 'no image');
  const notice = await client.until(
    () => client.notifications.find((n) => n.method === 'session.notice'), 'a notice');
  assert.match(notice.params.message, /colour\.tga/);
  assert.equal(await textures(), 1);
  writeFileSync(join(folder, 'colour.tga'), picture(200));
  await client.until(
    () => client.notifications.find((n) => n.method === 'scene.loaded'),
    'scene.loaded',
  );
  assert.equal(await textures(), 1);
  assert.equal(await stopDaemon(daemon), 0, daemon.log);
});

test('reloads a changed scene file and keeps the last good one', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'voxcast-'));
  const path = join(folder, 'one.obj');
  const triangle = 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n';
  writeFileSync(path, triangle);
  const daemon = await startDaemon([path, '--scene-dir', folder]);
  const client = await hello(daemon);
  assert.equal((await client.call('scene.get')).result.counts.triangles, 1);
  writeFileSync(path, triangle + 'v 1 1 0\nf 2 4 3\n');
  await client.until(
    () => client.notifications.find((n) => n.method === 'scene.loaded'),
    'scene.loaded',
  );
  assert.equal((await client.call('scene.get')).result.counts.triangles, 2);
  writeFileSync(path, 'f 1 2 900\n');
  const notice = await client.until(
    () => client.notifications.find((n) => n.method === 'session.notice'), 'a notice');
  assert.equal(notice.params.level, 'error');
  assert.equal((await client.call('scene.get')).result.counts.triangles, 2);
  const { scenes } = (await client.call('scene.list')).result;
  assert.ok(scenes.some((s) => s.source === 'one.obj'));
  assert.equal(await stopDaemon(daemon), 0, daemon.log);
});
