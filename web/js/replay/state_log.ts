/** Reads a state log: world documents and link poses by sim time (`editor/logs/state_log.py`). Pure. */
import type {Contact, Topic, World} from '../protocol.js';

const DOCUMENT = 1;
const WHOLE = 2;
const MOVED = 3;
const CONTACTS = 4;
const TOPICS = 5;
const MESSAGE = 6;
const MAGIC = 'my_simulations state log 1\n';
const HEAD_BYTES = 13;
const RECORD_BYTES = 32;
/** Longest time between two states, s, over which a pose is interpolated. */
const LONGEST_GAP = 0.5;

type LogRecord = {kind: number, time: number, at: number, size: number};

/** What belongs to a state: contacts, or a binary frame with a message of a topic. */
export interface Note {
  /** number of the state */
  state: number;
  contacts: Contact[]|null;
  frame: ArrayBuffer|null;
}

/**
 * Sim times that never decrease: after a reset of sim time they continue from the last one.
 * @param times  s
 */
function logTimes(times: number[]) {
  let offset = 0;
  let previous = times[0];
  return times.map((time) => {
    offset += Math.max(0, previous - time);
    previous = time;
    return time + offset;
  });
}

/**
 * The pose between two poses: linear in position, normalised linear in the quaternion.
 * @param share  0 is `from`, 1 is `to`
 */
export function between(from: Float64Array, to: Float64Array, share: number) {
  const found = new Float64Array(7);
  const sign = from[3] * to[3] + from[4] * to[4] + from[5] * to[5] + from[6] * to[6] < 0 ? -1 : 1;
  for (let part = 0; part < 7; part++) {
    found[part] = from[part] + ((part < 3 ? 1 : sign) * to[part] - from[part]) * share;
  }
  const length = Math.hypot(found[3], found[4], found[5], found[6]) || 1;
  for (let part = 3; part < 7; part++) found[part] /= length;
  return found;
}

export class StateLog {
  #view;
  #records: LogRecord[] = [];
  /** Records of contacts and messages, with the number of their state. */
  #notes: [number, LogRecord][] = [];
  /** The topics whose messages are recorded. */
  topics: Topic[] = [];
  /** Indices of records that hold states, and their log times, s. */
  #states: number[] = [];
  #times: number[] = [];
  /** Poses after the record `#at`. */
  #poses: Map<number, Float64Array> = new Map();
  #at = -1;

  /**
   * @param bytes  the whole file
   * @throws {Error} if it is no state log or holds no state
   */
  constructor(bytes: Uint8Array) {
    this.#view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const magic = new TextDecoder().decode(bytes.subarray(0, MAGIC.length));
    if (magic !== MAGIC) throw new Error('The recording is not a state log.');
    this.#scan();
    this.#states = this.#records.flatMap(({kind}, index) => (kind === WHOLE || kind === MOVED ? [index] : []));
    if (!this.#states.length) throw new Error('The recording contains no states.');
    this.#times = logTimes(this.#states.map((index) => this.#records[index].time));
  }

  /** First log time, s. */
  get begin() { return this.#times[0]; }

  /** Last log time, s. */
  get end() { return this.#times[this.#times.length - 1]; }

  /**
   * The world document that is valid at a time, and the poses at that time.
   * @param time  s
   * @returns number of the
   * document, -1: none; and of the last state that is not after the time
   */
  seek(time: number): {document: number, poses: Map<number, Float64Array>, state: number} {
    const position = this.#position(time);
    const target = this.#states[position];
    this.#apply(target);
    return {document: this.#documentBefore(target), poses: this.#interpolated(position, time),
      state: position};
  }

  /** The log time of a state, s. */
  timeOf(state: number) { return this.#times[state]; }

  /** Whether the log contains contacts. */
  get hasContacts() { return this.#notes.some(([, {kind}]) => kind === CONTACTS); }

  /**
   * Contacts and messages of the states after one, up to another one.
   * @param after  number of a state; -1: from the beginning
   * @param upto  number of a state
   */
  notes(after: number, upto: number): Note[] {
    return this.#notes.filter(([state]) => state > after && state <= upto).map(([state, {kind, at, size}]) => {
      const bytes = new Uint8Array(this.#view.buffer, this.#view.byteOffset + at, size);
      return {state, contacts: kind === CONTACTS ? JSON.parse(new TextDecoder().decode(bytes)) : null,
        frame: kind === MESSAGE ? bytes.slice().buffer : null};
    });
  }

  /** The world document of a number that `seek` returned. */
  document(number: number): World {
    return this.#json(this.#records[number]);
  }

  #json({at, size}: LogRecord) {
    return JSON.parse(new TextDecoder().decode(new Uint8Array(this.#view.buffer, this.#view.byteOffset + at, size)));
  }

  #scan() {
    let at = MAGIC.length;
    let state = -1;
    while (at + HEAD_BYTES <= this.#view.byteLength) {
      const kind = this.#view.getUint8(at);
      const size = this.#view.getUint32(at + 9, true);
      const end = at + HEAD_BYTES + size;
      if (kind < DOCUMENT || kind > MESSAGE || end > this.#view.byteLength) return;
      const record = {kind, time: this.#view.getFloat64(at + 1, true), at: at + HEAD_BYTES, size};
      if (kind === WHOLE || kind === MOVED) state++;
      if (kind === CONTACTS || kind === MESSAGE) this.#notes.push([Math.max(0, state), record]);
      else if (kind === TOPICS) this.topics = this.#json(record);
      else this.#records.push(record);
      at = end;
    }
  }

  /** The last state that is not after a time. */
  #position(time: number) {
    let low = 0;
    let high = this.#times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.#times[middle] <= time) low = middle + 1;
      else high = middle;
    }
    return Math.max(0, low - 1);
  }

  /** @param target  index of a record */
  #apply(target: number) {
    let start = target;
    while (start > 0 && this.#records[start].kind !== WHOLE) start--;
    if (this.#at < start || this.#at > target) this.#at = start - 1;
    for (let index = this.#at + 1; index <= target; index++) {
      if (this.#records[index].kind === WHOLE) this.#poses = new Map();
      if (this.#records[index].kind !== DOCUMENT) {
        for (const [id, pose] of this.#read(index)) this.#poses.set(id, pose);
      }
    }
    this.#at = target;
  }

  #documentBefore(target: number) {
    let index = target;
    while (index >= 0 && this.#records[index].kind !== DOCUMENT) index--;
    return index;
  }

  #interpolated(position: number, time: number) {
    const next = this.#states[position + 1];
    const gap = this.#times[position + 1] - this.#times[position];
    const share = (time - this.#times[position]) / gap;
    const follows = next === this.#states[position] + 1;
    if (!follows || !(share > 0 && share < 1) || gap > LONGEST_GAP) return this.#poses;
    const poses = new Map(this.#poses);
    for (const [id, pose] of this.#read(next)) {
      const from = poses.get(id);
      if (from) poses.set(id, between(from, pose, share));
    }
    return poses;
  }

  /** The links of a record with their poses. */
  * #read(index: number): Iterable<[number, Float64Array]> {
    const {at, size} = this.#records[index];
    for (let record = at; record + RECORD_BYTES <= at + size; record += RECORD_BYTES) {
      const pose = new Float64Array(7);
      for (let part = 0; part < 7; part++) {
        pose[part] = this.#view.getFloat32(record + 4 + 4 * part, true);
      }
      yield [this.#view.getUint32(record, true), pose];
    }
  }
}
