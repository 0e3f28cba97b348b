// Proves that the method `reference` streams as PROTOCOL.md says: samples rise and noise falls from
// frame to frame, an edit and a new camera start it anew, commands do not wait for it, and the
// daemon rests when it has converged. The furnace has little noise, so that this takes seconds.
// Run: VOXCASTD=build/release/bin/voxcastd node --test tests/web/server_reference.test.mjs
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';

import { Client, sleep, startDaemon, stopDaemon } from './client.mjs';

const TICKS_PER_SECOND = 100;

/** Seconds of processor time that the daemon has used. */
function processorSeconds({ child }) {
  const fields = readFileSync(`/proc/${child.pid}/stat`, 'latin1').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / TICKS_PER_SECOND;
}

async function hello(daemon, view) {
  const client = await Client.open(daemon.url);
  client.hello = (await client.call('session.hello', {})).result;
  await client.call('settings.update', { set: { gi_method: 'reference' } });
  await client.call('view.configure', { width: 64, height: 36, ...view });
  return client;
}

const traced = (client, from = 0) =>
  client.frames.slice(from).filter(({ referenceSamples }) => referenceSamples > 0);

describe('reference', () => {
  let daemon;
  before(async () => (daemon = await startDaemon(['--scene', 'builtin:furnace'])));
  after(() => stopDaemon(daemon));

  test('adds samples until the noise is low, then rests', async () => {
    const client = await hello(daemon);
    await client.until(
      () => client.frames.at(-1)?.converged && traced(client).length,
      'a converged reference',
    );
    const frames = traced(client).filter(({ width }) => width === 64);
    assert.ok(frames.length > 2, 'it comes in several frames');
    for (let i = 1; i < frames.length; i++) {
      assert.ok(frames[i].referenceSamples > frames[i - 1].referenceSamples);
      assert.ok(frames[i].convergence >= frames[i - 1].convergence);
    }
    const { referenceNoise, convergence } = frames.at(-1);
    assert.ok(referenceNoise > 0 && referenceNoise < 0.01, `noise ${referenceNoise}`);
    assert.equal(convergence, 1);
    const used = processorSeconds(daemon);
    await sleep(1000);
    assert.ok(processorSeconds(daemon) - used < 0.05, 'the daemon rests');
    await client.close();
  });

  test('starts anew with each edit and camera', async () => {
    const client = await hello(daemon, { width: 320, height: 180 });
    await client.until(
      () => traced(client).some((f) => f.width === 320 && f.referenceSamples > 4),
      'some samples',
    );
    const edit = await client.call('material.update', { id: 0, set: { roughness: 0.9 } });
    assert.ok(edit.result, JSON.stringify(edit.error));
    assert.ok(!client.frames.at(-1).converged, 'a command does not wait for paths');
    const edited = () =>
      client.frames.filter(({ sceneRevision }) => sceneRevision >= edit.result.revision);
    await client.until(() => edited().length, 'a frame with the edit');
    assert.equal(edited()[0].referenceSamples, 0, 'direct light shows the edit at once');
    await client.until(() => edited().some((f) => f.referenceSamples > 0), 'the edit, traced');
    client.notify('camera.set', { eye: [0.1, 0.1, 0.9], target: [0, 0, 0], revision: 1 });
    const moved = () => client.frames.filter(({ cameraRevision }) => cameraRevision === 1);
    await client.until(() => moved().length, 'the new camera');
    assert.equal(moved()[0].referenceSamples, 0);
    await client.until(() => moved().some((f) => f.referenceSamples > 0), 'the new camera, traced');
    // Back to a method of the GPU: nothing of the reference stays.
    await client.call('settings.update', { set: { gi_method: 'none' } });
    await client.until(() => client.frames.at(-1).converged, 'direct light');
    assert.equal(client.frames.at(-1).referenceSamples, 0);
    await client.close();
  });
});
