// A small client of the voxcast.v1 protocol for tests, and a way to start the daemon.
import { spawn } from 'node:child_process';
import { createRequire } from 'node:module';

const require = createRequire(new URL('../../web_client/package.json', import.meta.url));
const WebSocket = require('ws');

/**
 * No test waits longer. What tests wait for takes less than a tenth of it on two slow cores without
 * a GPU, under sanitizers. The limit ends tests that hang; it does not judge speed.
 */
export const PATIENCE_MS = 600000;

/**
 * Starts voxcastd on a free port. VOXCASTD names the program. `env` is added to its environment;
 * `before` is what a shell does before it becomes the program, such as setting limits.
 */
export async function startDaemon(args = [], { env = {}, before = ':' } = {}) {
  const program = process.env.VOXCASTD;
  if (!program) throw new Error('VOXCASTD must name the program to test');
  const start = [
    '-c',
    `${before}; exec "$0" "$@"`,
    program,
    '--port',
    '0',
    '--log-level',
    'warn',
    ...args,
  ];
  const child = spawn('/bin/sh', start, {
    stdio: ['ignore', 'pipe', 'pipe'],
    env: { ...process.env, ...env },
  });
  const daemon = { child, log: '', exit: new Promise((done) => child.on('exit', done)) };
  child.stderr.on('data', (data) => (daemon.log += data));
  const line = await new Promise((resolve, reject) => {
    let text = '';
    child.stdout.on('data', (data) => {
      text += data;
      if (text.includes('\n')) resolve(text);
    });
    child.on('exit', (code) => reject(new Error(`voxcastd ended with ${code}: ${daemon.log}`)));
  });
  daemon.port = Number(/:(\d+)\//.exec(line)[1]);
  daemon.http = `http://127.0.0.1:${daemon.port}`;
  daemon.url = `ws://127.0.0.1:${daemon.port}/`;
  for (const end = Date.now() + PATIENCE_MS; Date.now() < end; ) {
    if ((await fetch(`${daemon.http}/readyz`)).status === 200) return daemon;
    await sleep(100);
  }
  throw new Error(`voxcastd is not ready: ${daemon.log}`);
}

export async function stopDaemon(daemon) {
  daemon.child.kill('SIGTERM');
  return daemon.exit;
}

export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

/** Reads the header of a binary message: see PROTOCOL.md. */
export function decodeHeader(data) {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const u64 = (at) => Number(view.getBigUint64(at, true));
  return {
    magic: data.subarray(0, 4).toString('latin1'),
    headerSize: view.getUint16(4, true),
    converged: (view.getUint8(6) & 1) !== 0,
    codec: view.getUint8(7),
    viewId: view.getUint32(8, true),
    jpegBytes: view.getUint32(12, true),
    frameId: u64(16),
    sceneRevision: u64(24),
    editId: u64(32),
    cameraRevision: u64(40),
    width: view.getUint16(48, true),
    height: view.getUint16(50, true),
    quality: view.getUint8(52),
    convergence: view.getFloat32(56, true),
    sentAtUs: u64(88),
    referenceSamples: view.getUint32(96, true),
    referenceNoise: view.getFloat32(100, true),
    drawAtUs: u64(80),
  };
}

export class Client {
  /** Clients that are open. */
  static #open = new Set();

  /** Closes the clients that a failed test has left open. */
  static closeAll() {
    return Promise.all([...Client.#open].map((client) => client.close()));
  }

  /** Opens a connection; rejects with {status} when the upgrade is refused. */
  static open(url, options = {}) {
    return new Promise((resolve, reject) => {
      const { protocol = 'voxcast.v1', ...rest } = options;
      const socket = new WebSocket(url, protocol, { perMessageDeflate: false, ...rest });
      const client = new Client(socket);
      socket.on('open', () => resolve(client));
      socket.on('unexpected-response', (request, response) => {
        request.destroy();
        reject(Object.assign(new Error('refused'), { status: response.statusCode }));
      });
      socket.on('error', reject);
    });
  }

  constructor(socket) {
    this.socket = socket;
    this.nextId = 1;
    this.waiting = new Map();
    this.notifications = [];
    this.frames = [];
    this.acknowledge = true;
    this.closed = new Promise((done) =>
      socket.on('close', (code, reason) => {
        Client.#open.delete(this);
        done({ code, reason: String(reason) });
      }),
    );
    Client.#open.add(this);
    socket.on('message', (data, binary) => (binary ? this.takeFrame(data) : this.takeText(data)));
  }

  takeFrame(data) {
    const header = decodeHeader(data);
    this.frames.push({ ...header, jpeg: data.subarray(header.headerSize) });
    if (this.acknowledge) this.notify('frame.ack', { frame_id: header.frameId });
  }

  takeText(data) {
    const message = JSON.parse(data);
    if (message.method) this.notifications.push(message);
    else if (this.waiting.has(message.id)) {
      this.waiting.get(message.id)(message);
      this.waiting.delete(message.id);
    } else this.notifications.push(message);
  }

  /** Sends a request; resolves with the whole reply. */
  call(method, params) {
    const id = this.nextId++;
    const reply = new Promise((done) => this.waiting.set(id, done));
    this.socket.send(JSON.stringify({ jsonrpc: '2.0', id, method, params }));
    return reply;
  }

  notify(method, params) {
    if (this.socket.readyState === WebSocket.OPEN)
      this.socket.send(JSON.stringify({ jsonrpc: '2.0', method, params }));
  }

  /** Resolves when `check` returns something true. */
  async until(check, what, ms = PATIENCE_MS) {
    const end = Date.now() + ms;
    while (Date.now() < end) {
      const found = check();
      if (found) return found;
      await sleep(10);
    }
    throw new Error(`nothing came in ${ms} ms: ${what}`);
  }

  /** Waits until the image has converged and no frame has come for `ms` since. */
  async untilAtRest(ms = 600) {
    let count = -1;
    while (count !== this.frames.length || !this.frames.at(-1)?.converged) {
      count = this.frames.length;
      await sleep(ms);
    }
  }

  close() {
    this.socket.close();
    return this.closed;
  }
}
