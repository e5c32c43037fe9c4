/**
 * The ROS topics: which there are, which are shown, and their messages as they come. What a
 * selected robot senses is shown by itself; the user adds and takes away.
 */
import {Emitter} from '../emitter.js';
import {decodeTopicFrame} from './topic_frames.js';
import {placeOf} from './frame_places.js';
import type {Connection} from '../connection.js';
import type {FramePlace, Transforms} from './frame_places.js';
import type {Store} from '../store.js';
import type {Topic, TopicHead} from '../protocol.js';
import type {Watches} from '../watches.js';

export type TopicView = {head: TopicHead, buffer: ArrayBuffer, start: number};

interface TopicsEvents {
  /** the list, or what is measured of it */
  list: undefined;
  /** which are shown */
  shown: undefined;
  /** a message */
  view: TopicView;
  /** tf has moved */
  transforms: undefined;
  problem: {topic: string, problem: string};
}

const PREFIX = 'ros:';
const PERIOD = 2000;
const TF = Object.freeze(['/tf', '/tf_static']);

/** What a selected robot's topics of these types show by themselves, and how many at most. */
const SENSED = Object.freeze({
  'sensor_msgs/LaserScan': 4, 'sensor_msgs/Range': 16, 'sensor_msgs/Image': 2,
  'sensor_msgs/PointCloud2': 2, 'sensor_msgs/PointCloud': 2, 'nav_msgs/Odometry': 1,
  'gazebo_msgs/ContactsState': 8,
});

/** The topics that show what a model senses. */
export function sensedBy(list: Topic[], model: string|undefined): string[] {
  if (!model) return [];
  const own = list.filter((one) => one.model === model && one.publishers > 0);
  return Object.entries(SENSED).flatMap(([type, most]) =>
    own.filter((one) => one.type === type).slice(0, most).map(({name}) => name));
}

/** Listed, shown and received topics. */
export class Topics extends Emitter<TopicsEvents> {
  /** False in a world without ROS. */
  available = true;
  list: Topic[] = [];
  /** Whether what the selected robot senses is shown. */
  sensing = true;
  /** Why nothing comes, by topic. */
  problems: Map<string, string> = new Map();
  transforms: Transforms = new Map();

  #store;
  #connection;
  #watches;
  #later;
  /** Chosen by the user (true), or put away (false) although a robot senses it. */
  #chosen: Map<string, boolean> = new Map();
  #watched: Map<string, () => void> = new Map();
  #readers = 0;
  #asking = false;
  #frames = false;
  #timer: ReturnType<typeof setTimeout>|undefined;

  /** @param parts  later: calls when the page has drawn, so a page that is not seen gets nothing */
  constructor({store, connection, watches, later = (call) =>
      requestAnimationFrame(call)}: {store: Store, connection: Connection, watches: Watches,
    later?: (call: () => void) => unknown}) {
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

  /** The topic's entry in the list. */
  topic(name: string) {
    return this.list.find((one) => one.name === name);
  }

  /** Names of the topics that are shown. */
  get shown(): string[] {
    const sensed = this.sensing ? sensedBy(this.list, this.#model()) : [];
    const chosen = [...this.#chosen].flatMap(([name, on]) => (on ? [name] : []));
    return [...new Set([...sensed, ...chosen])].filter((name) => this.#chosen.get(name) !== false);
  }

  show(name: string, on: boolean) {
    const sensed = this.sensing && sensedBy(this.list, this.#model()).includes(name);
    if (on === sensed) this.#chosen.delete(name);
    else this.#chosen.set(name, on);
    this.#follow();
  }

  /** Shows what the selected robot senses, or not. */
  sense(on: boolean) {
    this.sensing = on;
    this.#selected();
  }

  /**
   * Keeps the list up to date while it has readers.
   * @returns removes this reader
   */
  read(): () => void {
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

  /** Returns the place of a message's frame; null for an unknown frame. */
  placeOf(topic: string, frame: string): FramePlace|null {
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

  #fail(topic: string, problem: string) {
    this.problems.set(topic, problem);
    this.emit('problem', {topic, problem});
  }

  #receive(buffer: ArrayBuffer) {
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
