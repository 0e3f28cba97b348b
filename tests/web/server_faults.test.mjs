// Proves that the daemon outlives the faults of its clients and of its machine: truncated frames
// and messages or no frames at all, clients that stop reading, a full disk, a lost GL context.
// Others are served meanwhile, and the document does not change.
// Run: VOXCASTD=build/release/bin/voxcastd node --test tests/web/server_faults.test.mjs
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import net from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, describe, test } from 'node:test';

import { Client, PATIENCE_MS, sleep, startDaemon, stopDaemon } from './client.mjs';

// How much the daemon may keep for a client that does not read: as little as possible, so that the
// queue is full before a minute of silence ends the client.
const MAX_QUEUED_BYTES = 1 << 20;
// More than Linux lets two TCP sockets hold.
const SOCKET_BYTES = 16 << 20;
const TEXT = 1, CONTINUATION = 0, PING = 9, FINAL = 0x80, MASKED = 0x80;

async function arrive(daemon, view = { width: 64, height: 36 }) {
  const client = await Client.open(daemon.url);
  client.hello = (await client.call('session.hello', {})).result;
  await client.call('view.configure', view);
  return client;
}

/** A frame as RFC 6455 defines it; `announced` is the length in its header. */
function frame(text, { opcode = TEXT, final = true, masked = true, announced } = {}) {
  const data = Buffer.from(text), length = announced ?? data.length;
  const header = [opcode | (final ? FINAL : 0)];
  const size = Buffer.alloc(8);
  if (length < 126) header.push(length);
  else if (length < 65536) {
    size.writeUInt16BE(length);
    header.push(126, ...size.subarray(0, 2));
  } else {
    size.writeBigUInt64BE(BigInt(length));
    header.push(127, ...size);
  }
  if (masked) header[1] |= MASKED;
  const mask = masked ? [1, 2, 3, 4] : [];
  return Buffer.concat([
    Buffer.from([...header, ...mask]),
    data.map((byte, i) => (masked ? byte ^ mask[i % 4] : byte)),
  ]);
}

const message = (method, params = {}, id = 1) =>
  JSON.stringify({ jsonrpc: '2.0', id, method, params });

/** A socket that has become a WebSocket, and all that it reads. */
function upgrade(port) {
  return new Promise((resolve, reject) => {
    const socket = net.connect(port, '127.0.0.1');
    const raw = {
      socket,
      read: Buffer.alloc(0),
      closed: new Promise((done) => socket.on('close', done)),
    };
    socket.on('error', () => {}); // resets are what some cases want
    socket.setTimeout(PATIENCE_MS, () => reject(new Error('no answer')));
    socket.on('data', (data) => {
      raw.read = Buffer.concat([raw.read, data]);
      if (raw.read.includes('\r\n\r\n')) resolve(raw);
    });
    socket.write(
      'GET / HTTP/1.1\r\nHost: x\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n' +
        'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n' +
        'Sec-WebSocket-Protocol: voxcast.v1\r\n\r\n',
    );
  });
}

async function readUntil(raw, text) {
  const end = Date.now() + PATIENCE_MS;
  while (!raw.read.includes(text)) {
    assert.ok(Date.now() < end, `nothing came: ${text}`);
    await sleep(10);
  }
}

describe('clients at fault', () => {
  let daemon, good, document, revision = 0;
  before(async () => {
    daemon = await startDaemon([
      ...['--scene', 'builtin:cornell', '--max-clients', '16', '--message-rate', '100000'],
      ...['--queue-bytes', String(MAX_QUEUED_BYTES), '--log-level', 'info'],
    ]);
    good = await arrive(daemon);
    document = (await good.call('scene.get')).result;
  });
  after(async () => {
    await good.close();
    assert.equal(await stopDaemon(daemon), 0);
  });

  /** The good client gets an image of a camera of its own, and the document has not changed. */
  async function checkOthers(what) {
    const number = ++revision;
    await good.call('camera.set', {
      eye: [number / 1000, 0.27, 1.08],
      target: [0, 0.27, 0],
      revision: number,
    });
    await good.until(
      () => good.frames.find((f) => f.cameraRevision === number),
      `a frame beside ${what}`,
    );
    assert.deepEqual((await good.call('scene.get')).result, document, what);
  }

  const hello = frame(message('session.hello'));
  for (const [what, ...parts] of [
    ['half a header', Buffer.from([FINAL | TEXT])],
    ['a header alone', frame('', { announced: 100 })],
    ['half a message', frame('{"jsonrpc":', { announced: 100 })],
    ['half a message after hello', hello, frame('{"jsonrpc":', { announced: 100 })],
    ['a first fragment alone', hello, frame('{"json', { final: false })],
    [
      'a length of 2^63 - 1',
      Buffer.from([
        FINAL | TEXT,
        MASKED | 127,
        0x7f,
        255,
        255,
        255,
        255,
        255,
        255,
        255,
        1,
        2,
        3,
        4,
      ]),
    ],
    [
      'a length of 2^64 - 1',
      Buffer.from([FINAL | TEXT, MASKED | 127, 255, 255, 255, 255, 255, 255, 255, 255, 1, 2, 3, 4]),
    ],
    ['noise', Buffer.from(Array.from({ length: 4096 }, (_, i) => (i * 167 + 13) & 255))],
  ])
    test(`hangs up in the midst of ${what}`, async () => {
      const raw = await upgrade(daemon.port);
      for (const part of parts) raw.socket.write(part);
      await sleep(50);
      raw.socket.destroy();
      await raw.closed;
      await checkOthers(what);
    });

  for (const [what, ...parts] of [
    ['a continuation of nothing', frame('{}', { opcode: CONTINUATION })],
    ['an unknown opcode', frame('{}', { opcode: 5 })],
    ['a control frame in fragments', frame('x', { opcode: PING, final: false })],
    ['a ping that is too long', frame('x'.repeat(126), { opcode: PING })],
    ['a message within another', frame('{', { final: false }), frame('{}')],
    ['text that is no UTF-8', hello, frame(Buffer.from([0x22, 0xc3, 0x28, 0x22]))],
    ['more fragments than a message may have', hello, ...Array.from({ length: 70 }, (_, i) =>
      frame(' '.repeat(1000), { final: false, opcode: i ? CONTINUATION : TEXT }))],
  ])
    test(`is closed upon ${what}`, async () => {
      const raw = await upgrade(daemon.port);
      for (const part of parts) raw.socket.write(part);
      await raw.closed;
      await checkOthers(what);
    });

  test('is understood byte by byte and in fragments', async () => {
    const raw = await upgrade(daemon.port);
    for (const byte of hello) {
      raw.socket.write(Buffer.from([byte]));
      await sleep(1);
    }
    await readUntil(raw, '"parameters"');
    const text = message('settings.update', { set: { gamma: 99 } }, 'in fragments');
    for (let i = 0; i < text.length; i += 7)
      raw.socket.write(
        frame(text.slice(i, i + 7), {
          opcode: i ? CONTINUATION : TEXT,
          final: i + 7 >= text.length,
        }),
      );
    await readUntil(raw, 'in fragments');
    raw.socket.destroy();
    await checkOthers('fragments');
  });

  test('stops reading: others go on, it is hung up on before answers fill the memory', async () => {
    const raw = await upgrade(daemon.port);
    raw.socket.write(hello);
    await readUntil(raw, '"parameters"');
    raw.socket.pause();
    const bytes = JSON.stringify(document).length;
    // Enough replies to fill the daemon's queue and the sockets. The test does not read, so it
    // learns from the daemon's log that the connection was closed.
    const maxSent = (MAX_QUEUED_BYTES + SOCKET_BYTES) / bytes;
    const before = daemon.log.length;
    const told = (what) => daemon.log.slice(before).includes(what);
    for (let sent = 0; sent < maxSent && !told('code=4413'); sent++) {
      raw.socket.write(frame(message('scene.get', {}, sent)));
      if (sent % 60 === 0) await sleep(20);
      if (sent % 300 === 0) await checkOthers('a client that does not read');
    }
    for (const what of ['code=4413', 'session_closed'])
      for (const end = Date.now() + PATIENCE_MS; !told(what); await sleep(20))
        assert.ok(Date.now() < end, `${what} is missing: ${daemon.log.slice(before)}`);
    raw.socket.destroy();
    await checkOthers('one that has gone');
  });

  test('come and go at once by the hundred', async () => {
    for (let round = 0; round < 10; round++) {
      const raws = await Promise.all(Array.from({ length: 10 }, () => upgrade(daemon.port)));
      for (const [i, raw] of raws.entries()) {
        raw.socket.write(hello);
        if (i % 2)
          raw.socket.write(frame(message('view.configure', { width: 4096, height: 2160 })));
        raw.socket.destroy();
      }
    }
    await checkOthers('clients that come and go');
  });
});

describe('a full disk', () => {
  afterEach(() => Client.closeAll());

  async function measure(daemon, pattern) {
    const client = await arrive(daemon);
    const { result, error } = await client.call('accuracy.start', { noise: 0.1 });
    const end = result && (await client.until(
      () => client.notifications.find(({ method, params }) =>
        method === 'accuracy.progress' && ['done', 'failed'].includes(params.state)),
      'the end of a measurement'));
    assert.match(error?.message ?? end.params.message ?? JSON.stringify(end.params), pattern);
    assert.notEqual(end?.params.state, 'done');
    // Everything else goes on.
    const from = client.frames.length;
    await client.call('camera.set', { eye: [0.1, 0.27, 1.08], target: [0, 0.27, 0], revision: 3 });
    await client.until(
      () => client.frames.slice(from).find((f) => f.cameraRevision === 3),
      'a frame',
    );
    await client.close();
  }

  test('ends a measurement with a reason, and nothing else', async () => {
    const folder = mkdtempSync(join(tmpdir(), 'voxcast-test-'));
    // Files end after 512 bytes; the daemon ignores the signal that comes with that.
    const daemon = await startDaemon(['--scene', 'builtin:cornell'], {
      env: { TMPDIR: folder, MESA_SHADER_CACHE_DISABLE: 'true' },
      before: "trap '' XFSZ; ulimit -f 1",
    });
    await measure(daemon, /disk full|cannot write/);
    assert.equal(await stopDaemon(daemon), 0);
    assert.deepEqual(readdirSync(folder), [], 'the daemon leaves no files');
    rmSync(folder, { recursive: true });
  });

  test('that takes no folder refuses measurements alone', async () => {
    const daemon = await startDaemon(['--scene', 'builtin:cornell'], {
      env: { TMPDIR: '/proc/no-such-folder' },
    });
    await measure(daemon, /folder|directory/);
    assert.equal(await stopDaemon(daemon), 0);
  });
});

test('a lost context costs images, but neither clients nor edits', async () => {
  const daemon = await startDaemon(['--scene', 'builtin:cornell'], {
    env: { VOXCAST_LOSE_CONTEXT: '12' },
  });
  const clients = [await arrive(daemon), await arrive(daemon)];
  await clients[0].call('settings.update', { set: { exposure_ev: 1.5 } });
  const reset = () =>
    clients.every((client) =>
      client.notifications.some(
        ({ method, params }) => method === 'session.notice' && /reset/.test(params.message),
      ),
    );
  for (let i = 1; i < 400 && !reset(); i++) {
    await clients[i % 2].call('camera.set', {
      eye: [i / 1000, 0.27, 1.08],
      target: [0, 0.27, 0],
      revision: i,
    });
    await sleep(50);
  }
  assert.ok(reset(), 'the context was not lost');
  for (const client of clients) {
    const from = client.frames.length;
    await client.call('camera.set', {
      eye: [0.2, 0.27, 1.08],
      target: [0, 0.27, 0],
      revision: 1000,
    });
    await client.until(
      () => client.frames.slice(from).find((f) => f.cameraRevision === 1000),
      'a frame',
    );
  }
  assert.equal((await clients[1].call('scene.get')).result.settings.exposure_ev, 1.5);
  await clients[0].call('pick', { x: 32, y: 30 });
  await Promise.all(clients.map((client) => client.close()));
  assert.equal(await stopDaemon(daemon), 0);
});
