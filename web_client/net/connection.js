import { parseFrameHeader } from './frame_header.js';
import { RpcError } from './rpc_error.js';

const FIRST_WAIT_MS = 300;
const LONGEST_WAIT_MS = 8000;
const CLOSED_TOKEN_WRONG = 4401;
const ERROR_NOT_PERMITTED = -32001;

/** @typedef {'connecting' | 'open' | 'waiting' | 'unauthorized'} ConnectionState */

/**
 * The only user of sockets. Keeps a connection to the server, says session.hello, matches replies
 * with requests, and passes on notifications and frames.
 *
 * Events: `state`, `hello` (detail: the server's description), `notification` (detail: method and
 * params), `frame` (detail: header and bytes of the image).
 */
export class Connection extends EventTarget {
  /** @param {string} url @param {() => {name?: string, token?: string}} getIdentity */
  constructor(url, getIdentity) {
    super();
    this.url = url;
    this.getIdentity = getIdentity;
    /** @type {ConnectionState} */
    this.state = 'connecting';
    this.waitMs = FIRST_WAIT_MS;
    this.nextId = 1;
    /** @type {Map<number, {resolve: Function, reject: Function, sentAt: number}>} */
    this.requests = new Map();
    this.roundTripMs = 0;
    /** @type {WebSocket | null} */
    this.socket = null;
    /** @type {number | undefined} */
    this.timer = undefined;
  }

  /** Connects now; also ends the wait for the next attempt. */
  connect() {
    clearTimeout(this.timer);
    this.socket?.close();
    this.#enter('connecting');
    const socket = new WebSocket(this.url, 'voxcast.v1');
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => this.#sayHello();
    socket.onmessage = (event) => this.#receive(event.data);
    socket.onclose = (event) => {
      if (this.socket === socket) this.#closed(event.code);
    };
    this.socket = socket;
  }

  get isOpen() {
    return this.state === 'open';
  }

  /**
   * Sends a request. Rejects with an RpcError if the server refuses it or the connection ends.
   * @param {string} method @param {object} [params] @returns {Promise<any>}
   */
  call(method, params) {
    if (!this.isOpen) return Promise.reject(new RpcError({ message: 'not connected' }));
    return this.#send(method, params);
  }

  /** Sends without wanting a reply; dropped while not connected. @param {object} [params] */
  notify(/** @type {string} */ method, params) {
    if (this.isOpen) this.socket?.send(JSON.stringify({ jsonrpc: '2.0', method, params }));
  }

  #send(/** @type {string} */ method, /** @type {object | undefined} */ params) {
    const id = this.nextId++;
    return new Promise((resolve, reject) => {
      this.requests.set(id, { resolve, reject, sentAt: performance.now() });
      this.socket?.send(JSON.stringify({ jsonrpc: '2.0', id, method, params }));
    });
  }

  async #sayHello() {
    try {
      const hello = await this.#send('session.hello', { protocol: 1, ...this.getIdentity() });
      this.waitMs = FIRST_WAIT_MS;
      this.#enter('open');
      this.dispatchEvent(new CustomEvent('hello', { detail: hello }));
    } catch (error) {
      if (error instanceof RpcError && error.code === ERROR_NOT_PERMITTED)
        this.#enter('unauthorized');
    }
  }

  #receive(/** @type {string | ArrayBuffer} */ data) {
    if (typeof data === 'string') {
      this.#receiveText(JSON.parse(data));
      return;
    }
    const header = parseFrameHeader(data);
    if (!header) return;
    const bytes = data.slice(header.headerBytes, header.headerBytes + header.jpegBytes);
    this.dispatchEvent(new CustomEvent('frame', { detail: { header, bytes } }));
  }

  #receiveText(/** @type {any} */ message) {
    if (message.method) {
      this.dispatchEvent(new CustomEvent('notification', { detail: message }));
      return;
    }
    const request = this.requests.get(message.id);
    if (!request) return;
    this.requests.delete(message.id);
    this.roundTripMs = performance.now() - request.sentAt;
    if (message.error) request.reject(new RpcError(message.error));
    else request.resolve(message.result);
  }

  #closed(/** @type {number} */ code) {
    for (const request of this.requests.values())
      request.reject(new RpcError({ message: 'the connection ended' }));
    this.requests.clear();
    this.socket = null;
    if (code === CLOSED_TOKEN_WRONG || this.state === 'unauthorized') {
      this.#enter('unauthorized');
      return;
    }
    this.#enter('waiting');
    // Random, so that clients of one lost server come back at different times.
    this.timer = setTimeout(() => this.connect(), this.waitMs * (0.75 + Math.random() / 2));
    this.waitMs = Math.min(this.waitMs * 1.7, LONGEST_WAIT_MS);
  }

  #enter(/** @type {ConnectionState} */ state) {
    if (this.state === state) return;
    this.state = state;
    this.dispatchEvent(new Event('state'));
  }
}
