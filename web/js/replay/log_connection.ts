/** Stands in for the connection to a simulator: it plays a state log that the page contains. */
import {RequestError} from '../connection.js';
import {Emitter} from '../emitter.js';
import {decodeTopicFrame} from '../topics/topic_frames.js';
import {FRAME_HEAD, FRAME_HEAD_BYTES, FRAME_KINDS, FRAME_RECORD, FRAME_RECORD_BYTES} from '../protocol.js';
import type {ConnectionEvents} from '../connection.js';
import type {Requests} from '../protocol.js';
import type {Note, StateLog} from './state_log.js';

const TOPIC = 'ros:';
/** Messages of this type are drawn as a path, which needs all of them. */
const PATH = 'odometry';
const READ_ONLY = 'This is a recording: nothing in it can be changed.';

/**
 * A binary frame of a log, as the simulator sends it.
 * @param time  s
 */
function frameOf(poses: Map<number, Float64Array>, revision: number, time: number) {
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

export class LogConnection extends Emitter<ConnectionEvents> {
  connected = true;
  refused = false;
  #log;
  #name;
  #nextFrame;
  #now;
  #rate = 0;
  #time;
  #document = -2;
  /** Poses that the page has. */
  #shown: Map<number, Float64Array> = new Map();
  /** Topics that the page shows. */
  #watched: Set<string> = new Set();
  /** Number of the last state whose contacts and messages were shown. */
  #noted = -1;
  /** Wall time of the last frame, ms; null while the log stands still. */
  #before: number|null = null;

  /**
   * @param name  shown to the user
   * @param options  for tests
   */
  constructor(log: StateLog, name: string, options: {nextFrame?: (call: () => void) => unknown,
      now?: () => number} = {}) {
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

  /** Stops playback. */
  close() {
    this.#rate = 0;
  }

  request<T extends keyof Requests>(
      type: T, fields?: Requests[T]['fields']): Promise<Requests[T]['reply']> {
    const given = (fields ?? {}) as {time?: number, rate?: number};
    const reply: (value: object) => Promise<never> = (value) =>
        Promise.resolve(value) as Promise<never>;
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
      this.#watch(((fields ?? {}) as {topics?: string[]}).topics ?? []);
      return reply({});
    }
    return Promise.reject(new RequestError([{severity: 'note', code: 'replay', message: READ_ONLY}]));
  }

  /** Notices to other users: a recording has none. */
  send() {}

  #watch(topics: string[]) {
    const added = topics.some((topic) => !this.#watched.has(topic));
    this.#watched = new Set(topics);
    if (!added) return;
    this.#noted = -1;
    this.#show();
  }

  /** @param time  s */
  #seek(time: number) {
    this.#time = Math.min(Math.max(time, this.#log.begin), this.#log.end);
    this.#show();
  }

  /** @param rate  0 pauses */
  #play(rate: number) {
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
    const started = this.#noted < 0 ? this.#startPaths(notes, document) : new Set<Note>();
    this.#showPoses(poses, document);
    this.#showNotes(notes.filter((note) => !started.has(note)), document);
    this.#noted = state;
  }

  /**
   * Shows the first message of each path with the poses of its time, to which its frame refers.
   * @returns the notes that were shown
   */
  #startPaths(notes: Note[], document: number): Set<Note> {
    const found = new Set<Note>();
    const known = new Set();
    for (const note of notes) {
      const head = this.#watchedHead(note);
      if (head?.view.type !== PATH || known.has(head.topic)) continue;
      const before = this.#log.seek(this.#log.timeOf(note.state));
      if (before.document !== document) continue;
      known.add(head.topic);
      found.add(note);
      this.#showPoses(before.poses, document);
      this.emit('frame', note.frame as ArrayBuffer);
    }
    return found;
  }

  /** Shows the last contacts, the last message of each topic, and all messages of paths. */
  #showNotes(notes: Note[], document: number) {
    const last: Map<string, ArrayBuffer> = new Map();
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

  /** The head of a message that the page shows; null for other notes. */
  #watchedHead({frame}: Note) {
    const head = frame && decodeTopicFrame(frame)?.head;
    return head && this.#watched.has(TOPIC + head.topic) ? head : null;
  }

  #showPoses(poses: Map<number, Float64Array>, document: number) {
    const moved = new Map([...poses].filter(([id, pose]) => this.#hasMoved(id, pose)));
    for (const [id, pose] of moved) this.#shown.set(id, pose);
    if (moved.size) this.emit('frame', frameOf(moved, document, this.#time));
  }

  #hasMoved(id: number, pose: Float64Array) {
    const shown = this.#shown.get(id);
    return !shown || pose.some((part, index) => part !== shown[index]);
  }
}
