/** The web socket to the simulator: requests with answers, pushes, and coming back after a loss. */

import {Emitter} from './emitter.js';
import {PROTOCOL_VERSION} from './protocol.js';
import type {Notices, Push, Requests} from './protocol.js';

/** What is told to the user; the page's own issues name no file. */
export type Issue = Partial<import('./protocol.js').Issue> &
    Pick<import('./protocol.js').Issue, 'severity'|'code'|'message'> & {
      /** Unix time in s of an issue that the simulator keeps */
      time?: number|null,
    };

export interface ConnectionEvents {
  /** the greeting was answered */
  open: Requests['hello']['reply'];
  close: undefined;
  /** the simulator that answers does not know this page's token */
  refused: undefined;
  /** the line was made again, to another start of a simulator */
  replaced: undefined;
  /** what the simulator pushed */
  message: Push|{type: 'issue', issue: Issue, time?: number|null};
  frame: ArrayBuffer;
  /** a request was sent */
  asked: AskedRequest;
  /** it was answered, or its answer is lost */
  answered: {id: number};
}

export type AskedRequest = {id: number, type: keyof Requests, fields?: Requests[keyof Requests]['fields']|undefined};

/** Sends a request; the promise is of the reply's value, and rejects with RequestError. */
export type RequestFunction = <T extends keyof Requests>(type: T, fields?: Requests[T]['fields'])
    => Promise<Requests[T]['reply']>;

type Waiting = {resolve: (value: unknown) => void, reject: (error: Error) => void};

/** The first error with its place. */
function textOf(issues: Issue[]) {
  const issue = issues.find(({severity}) => severity === 'error') ?? issues[0];
  if (!issue) return 'The request was refused.';
  const place = issue.file ? ` (${issue.file}${issue.line ? `:${issue.line}` : ''})` : '';
  return `${issue.message}${place}${issue.hint ? `${place ? '' : ';'} ${issue.hint}` : ''}`;
}

/** A request that was refused or never answered. */
export class RequestError extends Error {
  override name;
  issues: Issue[];

  /** @param issues  at least one */
  constructor(issues: Issue[]) {
    super(textOf(issues));
    this.name = 'RequestError';
    this.issues = issues;
  }
}

/** Whether a request was refused with an issue of this code. */
export const hasIssue = (fault: unknown, code: string) =>
  fault instanceof RequestError && fault.issues.some((issue) => issue.code === code);

/** Milliseconds to wait before the n-th attempt in a row to connect again, n from 0. */
export function backOff(attempt: number) {
  return Math.min(250 * 2 ** attempt, 4000);
}

/** The web socket's address that belongs to a page's address; a token in the query goes along. */
export function webSocketUrl(location: {protocol: string, search: string, host: string}) {
  const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
  const token = new URLSearchParams(location.search).get('token');
  return `${scheme}//${location.host}/ws${token ? `?token=${encodeURIComponent(token)}` : ''}`;
}

/**
 * Whether the server at this address refuses this page's token; false if none answers. A web socket
 * that cannot be opened does not tell why.
 * @param url  of the web socket
 */
async function isRefused(url: string) {
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
 */
export class Connection extends Emitter<ConnectionEvents> {
  #url;
  #WebSocket;
  #setTimeout;
  #isRefused;
  #socket: WebSocket|null = null;
  #nextId = 1;
  #waiting: Map<number, Waiting> = new Map();
  #attempt = 0;
  #timer: ReturnType<typeof setTimeout>|undefined;
  #closed = false;
  #session: string|null = null;
  /** What the others know us by. */
  #identity: () => {person?: string, name?: string};

  /**
   * @param url  of the web socket
   * @param options  other implementations, for tests
   */
  constructor(url: string, options: {WebSocket?: typeof globalThis.WebSocket, identity?: () =>
      {person?: string, name?: string},
    setTimeout?: (call: () => void, wait: number) => ReturnType<typeof setTimeout>,
    isRefused?: (url: string) => Promise<boolean>} = {}) {
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

  request<T extends keyof Requests>(
      type: T, fields?: Requests[T]['fields']): Promise<Requests[T]['reply']> {
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
        resolve: resolve as (value: unknown) => void, reject,
      });
      this.emit('asked', {id, type, fields});
      socket.send(JSON.stringify({type, id, ...((fields ?? {}) as object)}));
    });
  }

  /**
   * Sends what is not answered; dropped while the line is down. On a congested line live drags are
   * dropped too: the next one says it all.
   */
  send<T extends keyof Notices>(type: T, fields?: Notices[T]) {
    if (this.#socket?.readyState !== OPEN) return;
    if (type === 'drag' && this.#socket.bufferedAmount > 65536) return;
    this.#socket.send(JSON.stringify({type, ...((fields ?? {}) as object)}));
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
      const replaced = this.#session !== null && this.#session !== welcome.session;
      this.#session = welcome.session;
      this.#attempt = 0;
      this.refused = false;
      this.connected = true;
      this.emit('open', welcome);
      if (replaced) this.emit('replaced');
    } catch (error) {
      for (const issue of error instanceof RequestError ? error.issues : []) {
        // The page says all the time that there is no line.
        if (issue.code === 'connection-lost') continue;
        this.emit('message', {type: 'issue', issue});
      }
    }
  }

  #receive(data: string|ArrayBuffer) {
    if (typeof data !== 'string') {
      this.emit('frame', data);
      return;
    }
    const message: Push = JSON.parse(data);
    if (message.type !== 'reply') {
      this.emit('message', message);
      return;
    }
    const waiting = this.#waiting.get(message.id);
    this.#waiting.delete(message.id);
    this.emit('answered', {id: message.id});
    if (message.ok) waiting?.resolve(message.value);
    else waiting?.reject(new RequestError(message.issues ?? []));
  }

  async #findOut() {
    const refused = await this.#isRefused(this.#url);
    if (refused === this.refused || this.connected) return;
    this.refused = refused;
    this.emit('refused');
  }

  #lost(socket: WebSocket) {
    if (socket !== this.#socket) return;
    const lost = new RequestError([{
      severity: 'error', code: 'connection-lost',
      message: 'Connection to the simulator lost before it replied.',
    }]);
    for (const [id, {reject}] of this.#waiting) {
      this.emit('answered', {id});
      reject(lost);
    }
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
