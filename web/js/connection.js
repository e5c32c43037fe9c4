/** The web socket to the simulator: requests with answers, pushes, and coming back after a loss. */

import {Emitter} from './emitter.js';
import {PROTOCOL_VERSION} from './protocol.js';
/** @import {Notices, Push, Requests} from './protocol.js' */

/**
 * What is told to the user; the page's own issues name no file.
 * @typedef {Partial<import('./protocol.js').Issue> &
 *   Pick<import('./protocol.js').Issue, 'severity'|'code'|'message'>} Issue
 */

/**
 * @typedef {object} ConnectionEvents
 * @property {Requests['hello']['reply']} open  the greeting was answered
 * @property {undefined} close
 * @property {undefined} refused  the simulator that answers does not know this page's token
 * @property {Push|{type: 'issue', issue: Issue}} message  what the simulator pushed
 * @property {ArrayBuffer} frame
 */

/**
 * Sends a request; the promise is of the reply's value, and rejects with RequestError.
 * @typedef {<T extends keyof Requests>(type: T, fields?: Requests[T]['fields'])
 *   => Promise<Requests[T]['reply']>} RequestFunction
 */

/** @typedef {{resolve: (value: unknown) => void, reject: (error: Error) => void}} Waiting */

/** A request that was refused or never answered. */
export class RequestError extends Error {
  /** @param {Issue[]} issues  at least one */
  constructor(issues) {
    super(issues[0]?.message ?? 'The request was refused.');
    this.name = 'RequestError';
    /** @type {Issue[]} */
    this.issues = issues;
  }
}

/**
 * Milliseconds to wait before the n-th attempt in a row to connect again, n from 0.
 * @param {number} attempt
 */
export function backOff(attempt) {
  return Math.min(250 * 2 ** attempt, 4000);
}

/**
 * The web socket's address that belongs to a page's address; a token in the query goes along.
 * @param {{protocol: string, search: string, host: string}} location
 */
export function webSocketUrl(location) {
  const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
  const token = new URLSearchParams(location.search).get('token');
  return `${scheme}//${location.host}/ws${token ? `?token=${encodeURIComponent(token)}` : ''}`;
}

/**
 * Whether the server at this address refuses this page's token; false if none answers. A web socket
 * that cannot be opened does not tell why.
 * @param {string} url  of the web socket
 */
async function isRefused(url) {
  const address = new URL(url.replace(/^ws/, 'http'));
  address.pathname = '/protocol.json';
  try {
    return (await fetch(address, {cache: 'no-store'})).status === 403;
  } catch {
    return false;
  }
}

const OPEN = 1;

/**
 * Requests made while the line is down fail at once: the page shows that it is, and nothing that a
 * user did long ago reaches a world that has changed since.
 * @extends {Emitter<ConnectionEvents>}
 */
export class Connection extends Emitter {
  #url;
  #WebSocket;
  #setTimeout;
  #isRefused;
  /** @type {WebSocket|null} */
  #socket = null;
  #nextId = 1;
  /** @type {Map<number, Waiting>} */
  #waiting = new Map();
  #attempt = 0;
  /** @type {ReturnType<typeof setTimeout>|undefined} */
  #timer;
  #closed = false;
  /** @type {string|null} */
  #session = null;
  /** What the others know us by. @type {() => {person?: string, name?: string}} */
  #identity;

  /**
   * @param {string} url  of the web socket
   * @param {{WebSocket?: typeof globalThis.WebSocket, identity?: () => {person?: string, name?: string},
   *          setTimeout?: (call: () => void, wait: number) => ReturnType<typeof setTimeout>,
   *          isRefused?: (url: string) => Promise<boolean>}}
   *        [options]  other implementations, for tests
   */
  constructor(url, options = {}) {
    super();
    this.#url = url;
    this.#identity = options.identity ?? (() => ({}));
    this.#WebSocket = options.WebSocket ?? globalThis.WebSocket;
    this.#setTimeout = options.setTimeout ?? globalThis.setTimeout.bind(globalThis);
    this.#isRefused = options.isRefused ?? isRefused;
  }

  /** True between the answered greeting and the loss of the line. */
  connected = false;

  /** True while a simulator answers that does not know this page's token: another was started. */
  refused = false;

  /** Connects, and connects again whenever the line is lost, until `close`. */
  open() {
    this.#closed = false;
    this.#connect();
  }

  /** Ends the connection for good. */
  close() {
    this.#closed = true;
    clearTimeout(this.#timer);
    this.#socket?.close();
  }

  /** @type {RequestFunction} */
  request(type, fields) {
    const socket = this.#socket;
    if (socket?.readyState !== OPEN) {
      return Promise.reject(new RequestError([{
        severity: 'error', code: 'not-connected',
        message: 'Not connected to the simulator; the request was not sent.',
      }]));
    }
    const id = this.#nextId++;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, {
        // The server's replies are checked against the protocol in its tests.
        resolve: /** @type {(value: unknown) => void} */ (resolve), reject,
      });
      socket.send(JSON.stringify({type, id, .../** @type {object} */ (fields ?? {})}));
    });
  }

  /**
   * Sends what is not answered; dropped while the line is down. On a congested line live drags are
   * dropped too: the next one says it all.
   * @template {keyof Notices} T
   * @param {T} type
   * @param {Notices[T]} [fields]
   */
  send(type, fields) {
    if (this.#socket?.readyState !== OPEN) return;
    if (type === 'drag' && this.#socket.bufferedAmount > 65536) return;
    this.#socket.send(JSON.stringify({type, .../** @type {object} */ (fields ?? {})}));
  }

  #connect() {
    const socket = new this.#WebSocket(this.#url);
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    socket.onopen = () => this.#greet();
    socket.onmessage = (event) => this.#receive(event.data);
    socket.onclose = () => this.#lost(socket);
  }

  async #greet() {
    const session = this.#session ? {session: this.#session} : {};
    try {
      const welcome = await this.request('hello', {version: PROTOCOL_VERSION, ...session,
        ...this.#identity()});
      this.#session = welcome.session;
      this.#attempt = 0;
      this.refused = false;
      this.connected = true;
      this.emit('open', welcome);
    } catch (error) {
      for (const issue of error instanceof RequestError ? error.issues : []) {
        // The page says all the time that there is no line.
        if (issue.code === 'connection-lost') continue;
        this.emit('message', {type: 'issue', issue});
      }
    }
  }

  /** @param {string|ArrayBuffer} data */
  #receive(data) {
    if (typeof data !== 'string') {
      this.emit('frame', data);
      return;
    }
    /** @type {Push} */
    const message = JSON.parse(data);
    if (message.type !== 'reply') {
      this.emit('message', message);
      return;
    }
    const waiting = this.#waiting.get(message.id);
    this.#waiting.delete(message.id);
    if (message.ok) waiting?.resolve(message.value);
    else waiting?.reject(new RequestError(message.issues ?? []));
  }

  async #findOut() {
    const refused = await this.#isRefused(this.#url);
    if (refused === this.refused || this.connected) return;
    this.refused = refused;
    this.emit('refused');
  }

  /** @param {WebSocket} socket */
  #lost(socket) {
    if (socket !== this.#socket) return;
    const lost = new RequestError([{
      severity: 'error', code: 'connection-lost',
      message: 'Connection to the simulator lost before it replied.',
    }]);
    for (const {reject} of this.#waiting.values()) reject(lost);
    this.#waiting.clear();
    if (this.connected) {
      this.connected = false;
      this.emit('close');
    } else if (!this.#closed) {
      this.#findOut();
    }
    if (!this.#closed) {
      this.#timer = this.#setTimeout(() => this.#connect(), backOff(this.#attempt++));
    }
  }
}
