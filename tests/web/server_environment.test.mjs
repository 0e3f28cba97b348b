// Proves that environments can be chosen: by --environment at the start, and by environment.load,
// which is an edit like others. Starts voxcastd with a folder of small images that are written here
// and compares the bytes of frames.
// Run: VOXCASTD=build/release/bin/voxcastd node --test tests/web/server_environment.test.mjs
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, symlinkSync, truncateSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';

import { Client, startDaemon, stopDaemon } from './client.mjs';

/** A Radiance image of 4 x 2 texels of one colour, as mantissas and exponent. */
function hdr(...rgbe) {
  const header = '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n';
  return Buffer.concat([
    Buffer.from(header),
    ...Array.from({ length: 8 }, () => Buffer.from(rgbe)),
  ]);
}

/** An OpenEXR image of 4 x 2 texels of one luminance, uncompressed. */
function exr(luminance) {
  const int = (...values) => Buffer.from(new Int32Array(values).buffer);
  const float = (...values) => Buffer.from(new Float32Array(values).buffer);
  const attribute = (name, type, value) =>
    Buffer.concat([Buffer.from(`${name}\0${type}\0`), int(value.length), value]);
  const window = int(0, 0, 3, 1);
  const header = Buffer.concat([
    int(20000630, 2),
    attribute(
      'channels',
      'chlist',
      Buffer.concat([Buffer.from('Y\0'), int(2, 0, 1, 1), Buffer.from([0])]),
    ),
    attribute('compression', 'compression', Buffer.from([0])),
    attribute('dataWindow', 'box2i', window),
    attribute('displayWindow', 'box2i', window),
    attribute('lineOrder', 'lineOrder', Buffer.from([0])),
    attribute('pixelAspectRatio', 'float', float(1)),
    attribute('screenWindowCenter', 'v2f', float(0, 0)),
    attribute('screenWindowWidth', 'float', float(1)),
    Buffer.from([0]),
  ]);
  const line = (y) => Buffer.concat([int(y, 16), float(...Array(4).fill(luminance))]);
  const first = header.length + 16;
  return Buffer.concat([header, int(first, 0, first + 24, 0), line(0), line(1)]);
}

async function greet(daemon, params = {}, query = '') {
  const client = await Client.open(daemon.url + query);
  client.hello = (await client.call('session.hello', params)).result;
  return client;
}

const environmentOf = async (client) => (await client.call('scene.get')).result.environment;

/** The newest frame once images have converged, of this revision of the document or later. */
async function restingFrame(client) {
  const { revision } = (await client.call('scene.get')).result;
  await client.until(
    () => client.frames.some((f) => f.sceneRevision >= revision && f.converged),
    'a resting frame',
  );
  await client.untilAtRest(500);
  return client.frames.at(-1).jpeg;
}

describe('a daemon with a folder of environments', () => {
  let daemon, folder, client, other, viewer;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'voxcast-environment-'));
    mkdirSync(join(folder, 'skies'));
    writeFileSync(join(folder, 'red.hdr'), hdr(200, 20, 20, 129));
    writeFileSync(join(folder, 'skies/grey.exr'), exr(0.5));
    writeFileSync(join(folder, 'broken.exr'), exr(0.5).subarray(0, 300));
    writeFileSync(join(folder, 'one.obj'), 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n');
    symlinkSync('/etc/passwd', join(folder, 'leads_out.hdr'));
    writeFileSync(join(folder, 'token'), 'editor\n');
    writeFileSync(join(folder, 'viewer'), 'viewer\n');
    daemon = await startDaemon([
      'builtin:cornell', '--scene-dir', folder,
      '--token-file', join(folder, 'token'), '--viewer-token-file', join(folder, 'viewer'),
    ]);
    client = await greet(daemon, { name: 'Ada' }, '?token=editor');
    other = await greet(daemon, { name: 'Bob' }, '?token=editor');
    viewer = await greet(daemon, {}, '?token=viewer');
    for (const silent of [other, viewer]) await silent.call('view.configure', { paused: true });
    await client.call('view.configure', {
      width: 96,
      height: 64,
      quality: 'interactive',
      adaptive: false,
    });
    // Light in voxels converges to within a bound, not to the bit: a trace of the former light
    // stays. So indirect light is off here.
    const { result } = await client.call('settings.update', {
      set: { gi_method: 'none', exposure_mode: 'fixed' },
    });
    assert.ok(result);
  });
  after(async () => {
    await Client.closeAll();
    await stopDaemon(daemon);
    rmSync(folder, { recursive: true });
  });

  test('lists images and nothing that leads out', async () => {
    const { environments, scenes } = (await client.call('scene.list')).result;
    assert.deepEqual(environments, [
      { name: 'broken.exr' },
      { name: 'red.hdr' },
      { name: 'skies/grey.exr' },
    ]);
    assert.ok(!scenes.some((scene) => /hdr|exr/.test(scene.source)));
  });

  test('equirect without an image is refused, and the message says how to give one', async () => {
    const { error } = await client.call('environment.update', { set: { type: 'equirect' } });
    assert.equal(error.code, -32602);
    assert.match(error.message, /environment\.load.*--environment/);
  });

  test('a loaded image is seen, told to all, and taken back to the bit', async () => {
    const without = await restingFrame(client);
    const seen = other.notifications.length;
    const { result } = await client.call('environment.load', { name: 'red.hdr', edit_id: 7 });
    assert.equal(result.edit_id, 7);
    assert.deepEqual([result.width, result.height, result.warnings], [4, 2, []]);
    const red = await restingFrame(client);
    assert.notDeepEqual(red, without);
    assert.equal(client.frames.at(-1).editId, 7);
    const changed = await other.until(
      () => other.notifications.slice(seen).find((n) => n.method === 'scene.changed'),
      'scene.changed',
    );
    assert.equal(changed.params.author.name, 'Ada');
    const [edit] = changed.params.edits;
    assert.deepEqual(
      [edit.method, edit.name, edit.set],
      ['environment.load', 'red.hdr', { type: 'equirect' }],
    );
    assert.deepEqual(
      [(await environmentOf(other)).type, (await environmentOf(other)).image],
      ['equirect', 'red.hdr'],
    );

    await client.call('environment.load', { name: 'skies/grey.exr' });
    const grey = await restingFrame(client);
    assert.notDeepEqual(grey, red);
    assert.equal((await client.call('edit.undo')).result.method, 'environment.load');
    assert.equal((await environmentOf(client)).image, 'red.hdr');
    assert.deepEqual(await restingFrame(client), red);
    await client.call('edit.undo');
    const former = await environmentOf(client);
    assert.deepEqual([former.type, former.image, former.has_picture], ['none', null, false]);
    assert.deepEqual(await restingFrame(client), without);
    await client.call('edit.redo');
    await client.call('edit.redo');
    assert.deepEqual(await restingFrame(client), grey);

    // Another type keeps the image, so that people can go back to it.
    await client.call('environment.update', { set: { type: 'constant' } });
    await client.call('environment.update', { set: { type: 'equirect' } });
    assert.deepEqual(await restingFrame(client), grey);
  });

  test('a client that comes back hears of it', async () => {
    const { epoch, revision } = (await client.call('scene.get')).result;
    await client.call('environment.load', { name: 'red.hdr' });
    const late = await greet(
      daemon,
      { resume_epoch: epoch, resume_revision: revision },
      '?token=editor',
    );
    assert.equal(late.hello.resync, false);
    assert.deepEqual(
      late.hello.edits.map((edit) => [edit.method, edit.name]),
      [['environment.load', 'red.hdr']],
    );
    await late.close();
  });

  test('refuses what is not there, leads out, is broken, or is not allowed', async () => {
    const before = await environmentOf(client);
    for (const name of [
      'none.hdr',
      '../red.hdr',
      '/etc/passwd',
      'leads_out.hdr',
      'one.obj',
      `${folder}/red.hdr`,
    ]) {
      const { error } = await client.call('environment.load', { name });
      assert.equal(error.code, -32602, name);
      assert.equal(error.data.field, 'name');
      assert.match(error.message, /scene\.list/);
    }
    const broken = (await client.call('environment.load', { name: 'broken.exr' })).error;
    assert.equal(broken.code, -32004);
    assert.match(broken.message, /broken\.exr.*(truncated|damaged)/);
    assert.equal((await viewer.call('environment.load', { name: 'red.hdr' })).error.code, -32001);
    assert.equal((await client.call('environment.load', {})).error.data.field, 'name');
    assert.deepEqual(await environmentOf(client), before);
  });

  test('an image that changes on disk is shown; one that breaks is not', async () => {
    await client.call('environment.load', { name: 'red.hdr' });
    const red = await restingFrame(client);
    const seen = client.notifications.length;
    const news = (method) => () =>
      client.notifications.slice(seen).find((n) => n.method === method);
    writeFileSync(join(folder, 'red.hdr'), hdr(20, 200, 20, 129));
    const changed = await client.until(news('scene.changed'), 'the reload');
    assert.equal(changed.params.author, null);
    const green = await restingFrame(client);
    assert.notDeepEqual(green, red);
    truncateSync(join(folder, 'red.hdr'), 60);
    writeFileSync(join(folder, 'red.hdr'), hdr(20, 200, 20, 129).subarray(0, 60));
    const notice = await client.until(news('session.notice'), 'a notice');
    assert.match(notice.params.message, /environment not reloaded.*truncated/);
    assert.deepEqual(await restingFrame(client), green);
  });

  test('another scene has its own environment', async () => {
    await client.call('scene.load', { source: 'one.obj' });
    assert.deepEqual(
      [(await environmentOf(client)).type, (await environmentOf(client)).image],
      ['gradient', null],
    );
    assert.equal((await client.call('edit.undo')).result.method, null);
  });
});

test('--environment lights the first scene, a broken one ends the daemon', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'voxcast-environment-'));
  writeFileSync(join(folder, 'sky.exr'), exr(2));
  writeFileSync(join(folder, 'broken.exr'), exr(2).subarray(0, 100));
  const daemon = await startDaemon(['builtin:cornell', '--environment', join(folder, 'sky.exr')]);
  const client = await greet(daemon);
  const { type, image } = await environmentOf(client);
  assert.deepEqual([type, image], ['equirect', 'sky.exr']);
  await client.call('scene.load', { source: 'builtin:furnace' });
  assert.equal((await environmentOf(client)).image, null);
  await client.close();
  assert.equal(await stopDaemon(daemon), 0, daemon.log);
  await assert.rejects(
    startDaemon(['builtin:cornell', '--environment', join(folder, 'broken.exr')]),
    /fetch|ended/,
  );
  const render = (name) =>
    spawnSync(process.env.VOXCAST ?? daemon.child.spawnargs[3].replace(/d$/, ''), [
      ...['render', 'builtin:cornell', '--environment', join(folder, name), '--gi', 'none'],
      ...['--frames', '1', '--size', '16x16'],
      '--out', join(folder, 'out.pfm'),
    ]);
  assert.equal(render('sky.exr').status, 0);
  const refused = render('broken.exr');
  assert.equal(refused.status, 3);
  assert.match(String(refused.stderr), /broken\.exr.*OpenEXR/);
  rmSync(folder, { recursive: true });
});
