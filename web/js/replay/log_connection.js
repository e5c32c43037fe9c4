/** Stands in for the connection to a simulator: it plays a state log that the page contains. */
import {RequestError} from '../connection.js';
import {Emitter} from '../emitter.js';
import {decodeTopicFrame} from '../topics/topic_frames.js';
import {FRAME_HEAD, FRAME_HEAD_BYTES, FRAME_KINDS, FRAME_RECORD, FRAME_RECORD_BYTES} from '../protocol.js';
/** @import {ConnectionEvents} from '../connection.js' */
/** @import {Note, StateLog} from './state_log.js' */

const TOPIC = 'ros:';
/** Messages of this type are drawn as a path, which needs all of them. */
const PATH = 'odometry';
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
  /** Topics that the page shows. @type {Set<string>} */
  #watched = new Set();
  /** Number of the last state whose contacts and messages were shown. */
  #noted = -1;
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
    if (type === 'topics') return reply({available: true, topics: this.#log.topics});
    if (type === 'watch') {
      this.#watch(/** @type {{topics?: string[]}} */ (fields ?? {}).topics ?? []);
      return reply({});
    }
    return Promise.reject(new RequestError([{severity: 'note', code: 'replay', message: READ_ONLY}]));
  }

  /** Notices to other users: a recording has none. */
  send() {}

  /** @param {string[]} topics */
  #watch(topics) {
    const added = topics.some((topic) => !this.#watched.has(topic));
    this.#watched = new Set(topics);
    if (!added) return;
    this.#noted = -1;
    this.#show();
  }

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
    const {document, poses, state} = this.#log.seek(this.#time);
    if (document !== this.#document && document >= 0) {
      this.#document = document;
      this.#shown.clear();
      this.emit('message', {type: 'world', revision: document, document: this.#log.document(document)});
    }
    this.emit('message', {type: 'log', state: this.#rate ? 'playing' : 'open', name: this.#name,
      begin: this.#log.begin, end: this.#log.end, time: this.#time, rate: this.#rate,
      contacts: this.#log.hasContacts});
    if (state < this.#noted) this.#noted = -1;
    const notes = this.#log.notes(this.#noted, state);
    const started = this.#noted < 0 ? this.#startPaths(notes, document) : new Set();
    this.#showPoses(poses, document);
    this.#showNotes(notes.filter((note) => !started.has(note)), document);
    this.#noted = state;
  }

  /**
   * Shows the first message of each path with the poses of its time, to which its frame refers.
   * @param {Note[]} notes
   * @param {number} document
   * @returns {Set<Note>} the notes that were shown
   */
  #startPaths(notes, document) {
    const found = new Set();
    const known = new Set();
    for (const note of notes) {
      const head = this.#watchedHead(note);
      if (head?.view.type !== PATH || known.has(head.topic)) continue;
      const before = this.#log.seek(this.#log.timeOf(note.state));
      if (before.document !== document) continue;
      known.add(head.topic);
      found.add(note);
      this.#showPoses(before.poses, document);
      this.emit('frame', /** @type {ArrayBuffer} */ (note.frame));
    }
    return found;
  }

  /**
   * Shows the last contacts, the last message of each topic, and all messages of paths.
   * @param {Note[]} notes
   * @param {number} document
   */
  #showNotes(notes, document) {
    /** @type {Map<string, ArrayBuffer>} */
    const last = new Map();
    for (const note of notes) {
      const head = this.#watchedHead(note);
      if (!head || !note.frame) continue;
      if (head.view.type !== PATH) last.set(head.topic, note.frame);
      else if (this.#log.seek(this.#log.timeOf(note.state)).document === document) this.emit('frame', note.frame);
    }
    const contacts = notes.filter((note) => note.contacts).at(-1)?.contacts;
    if (contacts && this.#watched.has('contacts')) {
      this.emit('message', {type: 'watch', topic: 'contacts', time: this.#time, contacts});
    }
    for (const frame of last.values()) this.emit('frame', frame);
  }

  /** The head of a message that the page shows; null for other notes. @param {Note} note */
  #watchedHead({frame}) {
    const head = frame && decodeTopicFrame(frame)?.head;
    return head && this.#watched.has(TOPIC + head.topic) ? head : null;
  }

  /** @param {Map<number, Float64Array>} poses @param {number} document */
  #showPoses(poses, document) {
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
