/** The web socket to the simulator: requests with answers, pushes, and coming back after a loss. */

/** @typedef {{severity: string, code: string, message: string, file?: string, line?: number,
 *             xpath?: string, hint?: string}} Issue  as errors.Issue of the simulator */

/** A request that was refused or never answered. */
export class RequestError extends Error {
  /** @param {Issue[]} issues  at least one */
  constructor(issues) {
    super(issues[0].message);
    this.name = 'RequestError';
    /** @type {Issue[]} */
    this.issues = issues;
  }
}

/** Milliseconds to wait before the n-th attempt in a row to connect again, n from 0. */
export function backOff(attempt) {
  return Math.min(250 * 2 ** attempt, 4000);
}

/**
 * The web socket's address that belongs to a page's address; a token in the query goes along.
 * @param {Location|URL} location
 */
export function webSocketUrl(location) {
  const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
  const token = new URLSearchParams(location.search).get('token');
  return `${scheme}//${location.host}/ws${token ? `?token=${encodeURIComponent(token)}` : ''}`;
}

const OPEN = 1;
const PROTOCOL_VERSION = 1;

/**
 * Emits `open`, `close`, `message` (detail: a pushed object) and `frame` (detail: ArrayBuffer).
 * Requests made while the line is down fail at once: the page shows that it is, and nothing that a
 * user did long ago reaches a world that has changed since.
 */
export class Connection extends EventTarget {
  #url;
  #WebSocket;
  #setTimeout;
  #socket = null;
  #nextId = 1;
  #waiting = new Map();
  #attempt = 0;
  #timer = null;
  #closed = false;
  #session = null;

  /**
   * @param {string} url  of the web socket
   * @param {{WebSocket?: any, setTimeout?: any}} [options]  other implementations, for tests
   */
  constructor(url, options = {}) {
    super();
    this.#url = url;
    this.#WebSocket = options.WebSocket ?? globalThis.WebSocket;
    this.#setTimeout = options.setTimeout ?? globalThis.setTimeout.bind(globalThis);
  }

  /** True between the answered greeting and the loss of the line. */
  connected = false;

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

  /**
   * Sends a request.
   * @param {string} type
   * @param {object} [fields]
   * @returns {Promise<any>} the reply's value; rejects with RequestError
   */
  request(type, fields = {}) {
    if (this.#socket?.readyState !== OPEN) {
      return Promise.reject(new RequestError([{
        severity: 'error', code: 'not-connected',
        message: 'There is no connection to the simulator; nothing was changed.',
      }]));
    }
    const id = this.#nextId++;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, {resolve, reject});
      this.#socket.send(JSON.stringify({type, id, ...fields}));
    });
  }

  /** Sends what is not answered (live drags); dropped while the line is down or congested. */
  send(type, fields = {}) {
    if (this.#socket?.readyState !== OPEN || this.#socket.bufferedAmount > 65536) return;
    this.#socket.send(JSON.stringify({type, ...fields}));
  }

  #connect() {
    const socket = new this.#WebSocket(this.#url);
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    socket.onopen = () => this.#greet(socket);
    socket.onmessage = (event) => this.#receive(event.data);
    socket.onclose = () => this.#lost(socket);
  }

  async #greet() {
    const fields = {version: PROTOCOL_VERSION};
    if (this.#session) fields.session = this.#session;
    try {
      const welcome = await this.request('hello', fields);
      this.#session = welcome.session;
      this.#attempt = 0;
      this.connected = true;
      this.dispatchEvent(new CustomEvent('open', {detail: welcome}));
    } catch (error) {
      for (const issue of error.issues ?? []) {
        this.dispatchEvent(new CustomEvent('message', {detail: {type: 'issue', issue}}));
      }
    }
  }

  #receive(data) {
    if (typeof data !== 'string') {
      this.dispatchEvent(new CustomEvent('frame', {detail: data}));
      return;
    }
    const message = JSON.parse(data);
    if (message.type !== 'reply') {
      this.dispatchEvent(new CustomEvent('message', {detail: message}));
      return;
    }
    const waiting = this.#waiting.get(message.id);
    this.#waiting.delete(message.id);
    if (message.ok) waiting?.resolve(message.value);
    else waiting?.reject(new RequestError(message.issues));
  }

  #lost(socket) {
    if (socket !== this.#socket) return;
    const lost = new RequestError([{
      severity: 'error', code: 'connection-lost',
      message: 'The connection to the simulator was lost before it answered.',
    }]);
    for (const {reject} of this.#waiting.values()) reject(lost);
    this.#waiting.clear();
    if (this.connected) {
      this.connected = false;
      this.dispatchEvent(new CustomEvent('close'));
    }
    if (!this.#closed) {
      this.#timer = this.#setTimeout(() => this.#connect(), backOff(this.#attempt++));
    }
  }
}
