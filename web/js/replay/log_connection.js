/** Stands in for the connection to a simulator: it plays a state log that the page contains. */
import {RequestError} from '../connection.js';
import {Emitter} from '../emitter.js';
import {FRAME_HEAD, FRAME_HEAD_BYTES, FRAME_KINDS, FRAME_RECORD, FRAME_RECORD_BYTES} from '../protocol.js';
/** @import {ConnectionEvents} from '../connection.js' */
/** @import {StateLog} from './state_log.js' */

const READ_ONLY = 'This is a recording: nothing in it can be changed.';

/**
 * A binary frame of a log, as the simulator sends it.
 * @param {Map<number, Float64Array>} poses
 * @param {number} revision
 * @param {number} time  s
 */
function frameOf(poses, revision, time) {
  const view = new DataView(new ArrayBuffer(FRAME_HEAD_BYTES + poses.size * FRAME_RECORD_BYTES));
  view.setUint32(FRAME_HEAD.kind, FRAME_KINDS.log, true);
  view.setUint32(FRAME_HEAD.revision, revision, true);
  view.setFloat64(FRAME_HEAD.sim_time, time, true);
  view.setFloat64(FRAME_HEAD.real_time, time, true);
  view.setUint32(FRAME_HEAD.count, poses.size, true);
  let at = FRAME_HEAD_BYTES;
  for (const [id, pose] of poses) {
    view.setUint32(at + FRAME_RECORD.id, id, true);
    for (let part = 0; part < 7; part++) view.setFloat32(at + FRAME_RECORD.px + 4 * part, pose[part], true);
    at += FRAME_RECORD_BYTES;
  }
  return view.buffer;
}

/** @extends {Emitter<ConnectionEvents>} */
export class LogConnection extends Emitter {
  connected = true;
  refused = false;
  #log;
  #name;
  #nextFrame;
  #now;
  #rate = 0;
  #time;
  #document = -2;
  /** Poses that the page has. @type {Map<number, Float64Array>} */
  #shown = new Map();
  /** Wall time of the last frame, ms; null while the log stands still. @type {number|null} */
  #before = null;

  /**
   * @param {StateLog} log
   * @param {string} name  shown to the user
   * @param {{nextFrame?: (call: () => void) => unknown, now?: () => number}} [options]  for tests
   */
  constructor(log, name, options = {}) {
    super();
    this.#log = log;
    this.#name = name;
    this.#time = log.begin;
    this.#nextFrame = options.nextFrame ?? ((call) => requestAnimationFrame(call));
    this.#now = options.now ?? (() => performance.now());
  }

  /** Shows the first state. */
  open() {
    this.#show();
  }

  close() {
    this.#rate = 0;
  }

  /** @type {import('../connection.js').RequestFunction} */
  request(type, fields) {
    const given = /** @type {{time?: number, rate?: number}} */ (fields ?? {});
    /** @type {(value: object) => Promise<never>} */
    const reply = (value) => /** @type {Promise<never>} */ (Promise.resolve(value));
    if (type === 'log_seek') {
      this.#seek(given.time ?? 0);
      return reply({time: this.#time});
    }
    if (type === 'log_play') {
      this.#play(given.rate ?? 1);
      return reply({});
    }
    if (type === 'watch') return reply({});
    return Promise.reject(new RequestError([{severity: 'note', code: 'replay', message: READ_ONLY}]));
  }

  /** Notices to other users: a recording has none. */
  send() {}

  /** @param {number} time  s */
  #seek(time) {
    this.#time = Math.min(Math.max(time, this.#log.begin), this.#log.end);
    this.#show();
  }

  /** @param {number} rate  0 pauses */
  #play(rate) {
    this.#rate = rate;
    if (rate > 0 && this.#time >= this.#log.end) this.#time = this.#log.begin;
    this.#show();
    if (rate && this.#before === null) {
      this.#before = this.#now();
      this.#nextFrame(() => this.#advance());
    }
  }

  #advance() {
    if (!this.#rate || this.#before === null) {
      this.#before = null;
      return;
    }
    const now = this.#now();
    const wanted = this.#time + (now - this.#before) / 1000 * this.#rate;
    this.#before = now;
    this.#time = Math.min(Math.max(wanted, this.#log.begin), this.#log.end);
    if (wanted !== this.#time) this.#rate = 0;
    this.#show();
    this.#nextFrame(() => this.#advance());
  }

  #show() {
    const {document, poses} = this.#log.seek(this.#time);
    if (document !== this.#document && document >= 0) {
      this.#document = document;
      this.#shown.clear();
      this.emit('message', {type: 'world', revision: document, document: this.#log.document(document)});
    }
    this.emit('message', {type: 'log', state: this.#rate ? 'playing' : 'open', name: this.#name,
      begin: this.#log.begin, end: this.#log.end, time: this.#time, rate: this.#rate});
    const moved = new Map([...poses].filter(([id, pose]) => this.#hasMoved(id, pose)));
    for (const [id, pose] of moved) this.#shown.set(id, pose);
    if (moved.size) this.emit('frame', frameOf(moved, document, this.#time));
  }

  /** @param {number} id @param {Float64Array} pose */
  #hasMoved(id, pose) {
    const shown = this.#shown.get(id);
    return !shown || pose.some((part, index) => part !== shown[index]);
  }
}
