// Proves how the daemon behaves as a process: what it reports of its version and of a port in use,
// and that a signal ends it in time, whatever it is doing.
// Run: VOXCASTD=build/release/bin/voxcastd node --test tests/web/server_process.test.mjs
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';

import { Client, PATIENCE_MS, sleep, startDaemon, stopDaemon } from './client.mjs';

// It ends within 1 s; a busy machine may take as long again to notice.
const LIMIT_MS = 5000;

const run = (...args) =>
  spawnSync(process.env.VOXCASTD, args, { encoding: 'utf8', timeout: PATIENCE_MS });

test('tells its version', () => {
  const { status, stdout } = run('--version');
  assert.equal(status, 0);
  assert.match(stdout, /^voxcastd \d+\.\d+\.\d+\n$/);
});

test('names what it cannot listen on, and what to do', async () => {
  const daemon = await startDaemon(['--scene', 'builtin:furnace']);
  try {
    const taken = run('--port', String(daemon.port));
    assert.equal(taken.status, 1);
    assert.match(
      taken.stderr,
      new RegExp(`^voxcastd: port ${daemon.port} of 127.0.0.1 is in use.*--port 0`, 'm'),
    );
    assert.doesNotMatch(taken.stderr, /websockets|errno/);
    assert.equal(taken.stdout, '', 'no URL');
    const foreign = run('--listen', '192.0.2.1', '--port', '0');
    assert.equal(foreign.status, 1);
    assert.match(
      foreign.stderr,
      /^voxcastd: listen is 192.0.2.1; allowed are addresses of this machine/m,
    );
  } finally {
    await stopDaemon(daemon);
  }
});

describe('a signal', () => {
  let folder;
  before(() => (folder = mkdtempSync(join(tmpdir(), 'voxcast-process-'))));
  after(() => rmSync(folder, { recursive: true, force: true }));

  async function endsInTime(daemon, signal) {
    const began = performance.now();
    daemon.child.kill(signal);
    assert.equal(await daemon.exit, 0);
    assert.ok(
      performance.now() - began < LIMIT_MS,
      `${signal} took ${Math.round(performance.now() - began)} ms`,
    );
  }

  // Without compiled shaders and with so many pixels the first frame takes many times the limit on
  // a CPU.
  for (const signal of ['SIGINT', 'SIGTERM'])
    test(`${signal} ends the daemon in its first frame`, async () => {
      const env = { MESA_SHADER_CACHE_DIR: join(folder, signal) };
      const daemon = await startDaemon(['--scene', 'builtin:cornell-objects'], { env });
      const client = await Client.open(daemon.url);
      await client.call('session.hello', {});
      client.notify('view.configure', {
        width: 4096,
        height: 2160,
        quality: 'final',
        adaptive: false,
      });
      await sleep(300);
      await endsInTime(daemon, signal);
      assert.equal((await client.closed).code, 1001, 'the client has been told');
    });

  test('ends the daemon while it measures, and its files go', async () => {
    const daemon = await startDaemon(['--scene', 'builtin:cornell'], { env: { TMPDIR: folder } });
    const client = await Client.open(daemon.url);
    await client.call('session.hello', {});
    const { result } = await client.call('accuracy.start', {});
    assert.ok(result, 'a measurement runs');
    assert.ok(readdirSync(folder).some((name) => name.startsWith('voxcast-accuracy-')));
    await endsInTime(daemon, 'SIGINT');
    assert.deepEqual(
      readdirSync(folder).filter((name) => name.startsWith('voxcast-accuracy-')),
      [],
    );
  });

  test('ends the daemon while it loads a scene', async () => {
    const daemon = await startDaemon(['--scene', 'builtin:atrium-lights']);
    const client = await Client.open(daemon.url);
    await client.call('session.hello', {});
    client.notify('scene.load', { source: 'builtin:atrium' });
    await sleep(200); // loading and drawing take many times as long
    await endsInTime(daemon, 'SIGINT');
  });
});
