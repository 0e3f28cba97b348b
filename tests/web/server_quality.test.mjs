// Proves that the daemon trades quality for speed as PROTOCOL.md says: starts voxcastd with a
// built-in scene, moves a camera or keeps it at rest, and reads rows and convergence from the
// frames' headers.
// Run: VOXCASTD=build/release/bin/voxcastd node --test tests/web/server_quality.test.mjs
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';

import { Client, sleep, startDaemon, stopDaemon } from './client.mjs';

const [DRAFT, INTERACTIVE, HIGH, FINAL] = [0, 1, 2, 3];
const TICKS_PER_SECOND = 100;

async function hello(daemon, view = {}) {
  const client = await Client.open(daemon.url);
  client.hello = (await client.call('session.hello', {})).result;
  // Direct light converges in one frame of the wanted row.
  await client.call('settings.update', { set: { gi_method: 'none' } });
  await client.call('view.configure', { width: 160, height: 90, ...view });
  return client;
}

/** Seconds of processor time that the daemon has used. */
function processorSeconds({ child }) {
  const fields = readFileSync(`/proc/${child.pid}/stat`, 'latin1').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / TICKS_PER_SECOND;
}

let revision = 0;

/** Moves the camera a little, `count` times, and returns the newest revision. */
async function move(client, count, pauseMs) {
  for (let i = 0; i < count; i++) {
    revision++;
    client.notify('camera.set', {
      eye: [(revision % 100) / 100, 1, 3.5],
      target: [0, 1, 0],
      revision,
    });
    await sleep(pauseMs);
  }
  return revision;
}

const converged = (client, row) =>
  client.until(
    () => client.frames.at(-1)?.converged && client.frames.at(-1).quality === row,
    'a converged frame',
  );

describe('quality', () => {
  let daemon;
  before(async () => (daemon = await startDaemon(['--scene', 'builtin:cornell'])));
  after(() => stopDaemon(daemon));

  test('climbs to the wanted row when still, then rests', async () => {
    const client = await hello(daemon);
    assert.equal(client.hello.view.quality, 'final');
    assert.equal(client.hello.view.adaptive, true);
    await converged(client, FINAL);
    const count = client.frames.length;
    assert.equal(client.frames.at(-1).convergence, 1);
    for (const frame of client.frames)
      if (frame.quality < FINAL) assert.ok(frame.convergence <= 0.5 && !frame.converged);
    await client.until(
      () => client.notifications.some((n) => n.params?.convergence === 1),
      'the last statistics',
    );
    const used = processorSeconds(daemon);
    await sleep(1500);
    assert.equal(client.frames.length, count);
    assert.ok(processorSeconds(daemon) - used < 0.05, 'the daemon rests');
    await client.close();
  });

  test('drops to the interactive row while the camera or the document moves', async () => {
    const client = await hello(daemon);
    await converged(client, FINAL);
    let at = await move(client, 1, 0);
    const moved = await client.until(
      () => client.frames.find((f) => f.cameraRevision === at),
      'the moved camera',
    );
    assert.equal(moved.quality, INTERACTIVE);
    assert.ok(moved.convergence < 1 && !moved.converged);
    await converged(client, FINAL);
    at = client.frames.at(-1).frameId;
    await client.call('settings.update', { set: { exposure_ev: 0.5 }, edit_id: 5 });
    const edited = await client.until(() => client.frames.find((f) => f.editId === 5), 'the edit');
    assert.equal(edited.quality, INTERACTIVE);
    await converged(client, FINAL);
    await client.close();
  });

  test('takes the wanted row for still images, and for all without adaption', async () => {
    const client = await hello(daemon, { quality: 'high' });
    await converged(client, HIGH);
    const before = client.frames.at(-1).frameId;
    await client.call('view.configure', { adaptive: false, quality: 'final' });
    await converged(client, FINAL);
    const at = await move(client, 5, 30);
    await client.until(
      () => client.frames.find((f) => f.cameraRevision === at),
      'the moved camera',
    );
    for (const frame of client.frames)
      if (frame.frameId > before) assert.equal(frame.quality, FINAL);
    await client.close();
  });

  test('moves with the draft row where frames take longer than the target', async () => {
    const client = await hello(daemon, { width: 960, height: 540, target_frame_ms: 5 });
    await converged(client, FINAL);
    const first = client.frames.length;
    for (let i = 0; i < 20 && client.frames.at(-1).quality !== DRAFT; i++)
      await move(client, 5, 40);
    assert.ok(client.frames.slice(first).some((f) => f.quality === DRAFT));
    await converged(client, FINAL);
    await client.close();
  });

  test('draws indirect light until it has converged, then rests', async () => {
    const client = await hello(daemon, { width: 64, height: 36, quality: 'interactive' });
    await converged(client, INTERACTIVE);
    const first = client.frames.length;
    await client.call('settings.update', { set: { gi_method: 'grid' } });
    await client.until(() => client.frames.length > first + 3, 'several frames of one state');
    await client.call('view.configure', {});
    assert.ok(!client.frames.at(-1).converged, 'a command does not wait for the image');
    await client.untilAtRest(1500);
    const frames = client.frames.slice(first);
    assert.ok(
      frames.at(-1).convergence > 0.9,
      `the last frame is ${frames.at(-1).convergence} on its way`,
    );
    assert.ok(frames[0].convergence < frames.at(-1).convergence);
    const used = processorSeconds(daemon);
    await sleep(1000);
    assert.ok(processorSeconds(daemon) - used < 0.05, 'the daemon rests');
    await client.close();
  });

  test('a client that moves does not starve one that is still', async () => {
    const mover = await hello(daemon);
    let isMoving = true;
    const moving = (async () => {
      while (isMoving) await move(mover, 1, 20);
    })();
    await sleep(300);
    const resting = await hello(daemon);
    await converged(resting, FINAL);
    isMoving = false;
    await moving;
    assert.ok(mover.frames.length > 5);
    await Promise.all([mover.close(), resting.close()]);
  });
});
