/**
 * The ROS topics: which there are, which are shown, and their messages as they come. What a
 * selected robot senses is shown by itself; the user adds and takes away.
 */
import {Emitter} from '../emitter.js';
import {decodeTopicFrame} from './topic_frames.js';
import {placeOf} from './frame_places.js';
/** @import {Connection} from '../connection.js' */
/** @import {FramePlace, Transforms} from './frame_places.js' */
/** @import {Store} from '../store.js' */
/** @import {Topic, TopicHead} from '../protocol.js' */
/** @import {Watches} from '../watches.js' */

/** @typedef {{head: TopicHead, buffer: ArrayBuffer, start: number}} TopicView */

/**
 * @typedef {object} TopicsEvents
 * @property {undefined} list   the list, or what is measured of it
 * @property {undefined} shown  which are shown
 * @property {TopicView} view   a message
 * @property {undefined} transforms  tf has moved
 * @property {{topic: string, problem: string}} problem
 */

const PREFIX = 'ros:';
const PERIOD = 2000;
const TF = Object.freeze(['/tf', '/tf_static']);
const TRANSFORMS = ['tf2_msgs/TFMessage', 'tf/tfMessage'];

/** What a selected robot's topics of these types show by themselves, and how many at most. */
const SENSED = Object.freeze({
  'sensor_msgs/LaserScan': 4, 'sensor_msgs/Range': 16, 'sensor_msgs/Image': 2,
  'sensor_msgs/PointCloud2': 2, 'sensor_msgs/PointCloud': 2, 'nav_msgs/Odometry': 1,
  'gazebo_msgs/ContactsState': 8,
});

/**
 * The topics that show what a model senses.
 * @param {Topic[]} list
 * @param {string|undefined} model
 * @returns {string[]}
 */
export function sensedBy(list, model) {
  if (!model) return [];
  const own = list.filter((one) => one.model === model && one.publishers > 0);
  return Object.entries(SENSED).flatMap(([type, most]) =>
    own.filter((one) => one.type === type).slice(0, most).map(({name}) => name));
}

/**
 * Listed, shown and received topics.
 * @extends {Emitter<TopicsEvents>}
 */
export class Topics extends Emitter {
  /** False in a world without ROS. */
  available = true;
  /** @type {Topic[]} */
  list = [];
  /** Whether what the selected robot senses is shown. */
  sensing = true;
  /** Why nothing comes, by topic. @type {Map<string, string>} */
  problems = new Map();
  /** @type {Transforms} */
  transforms = new Map();

  #store;
  #connection;
  #watches;
  #later;
  /** Chosen by the user (true), or put away (false) although a robot senses it. @type {Map<string, boolean>} */
  #chosen = new Map();
  /** @type {Map<string, () => void>} */
  #watched = new Map();
  #readers = 0;
  #asking = false;
  #frames = false;
  /** @type {ReturnType<typeof setTimeout>|undefined} */
  #timer;

  /**
   * @param {{store: Store, connection: Connection, watches: Watches,
   *          later?: (call: () => void) => unknown}} parts
   *   later: calls when the page has drawn, so a page that is not seen gets nothing
   */
  constructor({store, connection, watches, later = (call) => requestAnimationFrame(call)}) {
    super();
    this.#store = store;
    this.#connection = connection;
    this.#watches = watches;
    this.#later = later;
    connection.listen('frame', ({detail}) => this.#receive(detail));
    connection.listen('open', () => this.refresh());
    connection.listen('close', () => this.#stop());
    store.listen('selection', () => this.#selected());
    // What was just inserted may be selected before it has come.
    store.listen('entity', ({detail: {kind, name, value}}) => {
      if (kind === 'model' && value && name === this.#model()) this.refresh();
    });
    store.listen('watch', ({detail: {topic, problem}}) => {
      if (topic.startsWith(PREFIX) && problem) this.#fail(topic.slice(PREFIX.length), problem);
    });
  }

  /** The topic's entry in the list. @param {string} name */
  topic(name) {
    return this.list.find((one) => one.name === name);
  }

  /** Names of the topics that are shown. @returns {string[]} */
  get shown() {
    const sensed = this.sensing ? sensedBy(this.list, this.#model()) : [];
    const chosen = [...this.#chosen].flatMap(([name, on]) => (on ? [name] : []));
    return [...new Set([...sensed, ...chosen])].filter((name) => this.#chosen.get(name) !== false);
  }

  /** @param {string} name @param {boolean} on */
  show(name, on) {
    const sensed = this.sensing && sensedBy(this.list, this.#model()).includes(name);
    if (on === sensed) this.#chosen.delete(name);
    else this.#chosen.set(name, on);
    this.#follow();
  }

  /** Shows what the selected robot senses, or not. @param {boolean} on */
  sense(on) {
    this.sensing = on;
    this.#selected();
  }

  /**
   * Keeps the list up to date while it has readers.
   * @returns {() => void} removes this reader
   */
  read() {
    this.#readers += 1;
    this.refresh();
    return () => { this.#readers -= 1; };
  }

  /** Requests the list now and then every `PERIOD` while it is needed. */
  async refresh() {
    clearTimeout(this.#timer);
    if (this.#asking || !this.#connection.connected || !this.#wanted()) return;
    this.#asking = true;
    try {
      const {available, topics} = await this.#connection.request('topics', {});
      this.available = available;
      this.list = topics;
      this.#follow();
      this.emit('list');
    } catch {
      // The line was lost, or the master is away: the next look may tell.
    }
    this.#asking = false;
    if (this.available && this.#wanted()) this.#timer = setTimeout(() => this.refresh(), PERIOD);
  }

  /**
   * Returns the place of a message's frame; null for an unknown frame.
   * @param {string} topic
   * @param {string} frame
   * @returns {FramePlace|null}
   */
  placeOf(topic, frame) {
    const {model, mount} = this.topic(topic) ?? {};
    const known = {models: this.#store.document?.models ?? [], model: model ?? this.#model(), mount};
    const place = placeOf(frame, {...known, transforms: this.transforms});
    if (!place) this.#watchFrames();
    return place;
  }

  #wanted() {
    return this.#readers > 0 || this.#watched.size > 0 || (this.sensing && Boolean(this.#model()));
  }

  #model() {
    const last = this.#store.selection.at(-1);
    const model = last ? this.#store.split(last)[0] : undefined;
    return model?.name;
  }

  #selected() {
    for (const [name, on] of this.#chosen) if (!on) this.#chosen.delete(name);
    this.#follow();
    this.refresh();
  }

  /** Hears what is shown and nothing else. */
  #follow() {
    const wanted = new Set(this.shown);
    const before = [...this.#watched.keys()].join();
    if (!wanted.size) this.#frames = false;
    if (this.#frames) for (const name of TF) wanted.add(name);
    for (const [name, off] of this.#watched) {
      if (wanted.has(name)) continue;
      off();
      this.#watched.delete(name);
      this.problems.delete(name);
    }
    for (const name of wanted) {
      if (!this.#watched.has(name)) this.#watched.set(name, this.#watches.add(PREFIX + name));
    }
    if ([...this.#watched.keys()].join() !== before) this.emit('shown');
  }

  /** Subscribes to tf for frames that are not links. */
  #watchFrames() {
    if (this.#frames || !this.#watched.size) return;
    this.#frames = true;
    // Not while a message is being shown.
    queueMicrotask(() => this.#follow());
  }

  #stop() {
    clearTimeout(this.#timer);
    this.transforms.clear();
  }

  /** @param {string} topic @param {string} problem */
  #fail(topic, problem) {
    this.problems.set(topic, problem);
    this.emit('problem', {topic, problem});
  }

  /** @param {ArrayBuffer} buffer */
  #receive(buffer) {
    const view = decodeTopicFrame(buffer);
    if (!view) return;
    const {topic} = view.head;
    this.#later(() => this.#connection.send('viewed', {topic}));
    if (!this.#watched.has(topic)) return;
    this.problems.delete(topic);
    if (view.head.view.type === 'transforms') {
      for (const {parent, child, pose} of view.head.view.transforms) {
        this.transforms.set(child, {parent, pose});
      }
      this.emit('transforms');
    }
    this.emit('view', view);
  }
}

/** Whether a topic tells tf. @param {Topic|undefined} topic */
export const tellsTransforms = (topic) => TRANSFORMS.includes(topic?.type ?? '');
