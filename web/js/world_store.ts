/** The world as the simulator last told it: document, poses, time, history, people. */
import {Emitter} from './emitter.js';
import {decodeFrame, LIVE} from './pose_frames.js';
import {linkNames, renamedModel} from './model_edits.js';
import {compose, inverse} from './pose.js';
import {splitScoped} from './scoped_names.js';
import type {Link, Model, Notices, Person, PluginState, Push, Pushes, World} from './protocol.js';
import type {Connection, Issue} from './connection.js';
import type {EntityChange, EntityRef, StoreEvents} from './store.js';

/** The world as last received from the simulator. Emits an event for every change. */
export class WorldStore extends Emitter<StoreEvents> {
  /** The world's document, null until the simulator has sent one. */
  document: World|null = null;
  revision = 0;
  /** World pose of each link's frame by link id, as last received from the simulator. */
  poses: Map<number, Float64Array> = new Map();
  stats = {sim_ns: 0, real_ns: 0, factor: 0, iterations: 0, paused: true};
  history: Pushes['history'] = {
    undo: [], redo: [], undoable: 0, depth: 0, state: 0, undo_by: [], redo_by: [],
    dirty: false, file: '',
  };
  /** Everybody who has this world open, this page too. */
  people: Person[] = [];
  /** This page's number among them. */
  me = 0;
  issues: Issue[] = [];
  /** Of the plugins of models, their sensors and the world. */
  pluginStates: PluginState[] = [];
  connected = false;
  /** Whether the simulator refuses edits, and control of time and logs. */
  readOnly = false;
  autosave: Pushes['autosave']|null = null;
  log: Pushes['log']|null = null;
  /** Whether the poses are those of a log. */
  replaying = false;

  /** From a link's id to the document of its model. */
  #owners: Map<number, Model> = new Map();
  /** The models of a list by name; each change makes another list. */
  #models: {of: Model[], byName: Map<string, Model>} = {of: [], byName: new Map()};
  #connection: Connection|undefined;

  constructor(connection?: Connection) {
    super();
    if (!connection) return;
    this.#connection = connection;
    connection.listen('open', ({detail}) => {
      this.me = detail.number;
      this.readOnly = detail.read_only;
      this.#setConnected(true);
      this.emit('people');
    });
    connection.listen('close', () => this.#setConnected(false));
    connection.listen('message', (event) => this.receive(event.detail));
    connection.listen('frame', (event) => this.receiveFrame(event.detail));
  }

  // ---- messages from the simulator

  /** Takes a pushed message. */
  receive(message: Push|{type: 'issue', issue: Issue, time?: number|null}) {
    switch (message.type) {
      case 'world': this.#replaceWorld(message); break;
      case 'change': this.#change(message); break;
      case 'stats': {
        const {type: _, ...stats} = message;
        this.stats = stats;
        this.emit('stats');
        break;
      }
      case 'history': {
        const {type: _, ...history} = message;
        this.history = history;
        this.emit('history');
        break;
      }
      case 'issue': this.addIssue({...message.issue, ...(message.time ? {time: message.time} : {})}); break;
      case 'autosave': this.autosave = message; this.emit('autosave', message); break;
      case 'log': this.log = message; this.emit('log', message); break;
      case 'people': this.people = message.people; this.emit('people'); break;
      case 'plugins': this.#setPluginStates(message.states); break;
      case 'loading': this.emit('loading', message); break;
      case 'watch': this.emit('watch', message); break;
      case 'library': this.emit('library', message); break;
      case 'download': this.emit('download', message); break;
      case 'shutdown': this.emit('shutdown', message); break;
      default: break;  // of a newer simulator
    }
  }

  /** Takes a binary pose frame. */
  receiveFrame(buffer: ArrayBuffer) {
    const frame = decodeFrame(buffer);
    if (!frame) return;
    const moved: Set<number> = new Set();
    for (let index = 0; index < frame.count; index++) {
      const id = frame.id(index);
      let pose = this.poses.get(id);
      if (!pose) this.poses.set(id, pose = new Float64Array(7));
      frame.read(index, pose);
      moved.add(id);
    }
    this.replaying = frame.kind !== LIVE;
    if (moved.size) this.emit('poses', moved);
  }

  /** A plugin that starts again has read nothing yet: what it has read before is still of use. */
  #setPluginStates(states: PluginState[]) {
    this.pluginStates = states.map((state) => {
      const before = state.state === 'waiting' && this.pluginStates.find((one) =>
        one.model === state.model && one.name === state.name && one.filename === state.filename);
      return before ? {...state, parameters: before.parameters} : state;
    });
    this.emit('plugins');
  }

  #replaceWorld({revision, document}: Pushes['world']) {
    const before = this.document;
    if (before && (before.name !== document.name || before.file !== document.file)) this.worldGone();
    this.revision = revision;
    this.document = document;
    this.poses.clear();
    this.#owners.clear();
    for (const model of document.models) this.#index(model);
    this.emit('document');
    this.dropGone();
  }

  #change({revision, models, lights, world, order}: Pushes['change']) {
    if (!this.document) return;
    this.revision = revision;
    const gone = this.document.models.filter(({name}) => models?.[name] === null);
    const before = new Set(gone.length ? this.document.models.map(({name}) => name) : []);
    const changed: EntityChange[] = [];
    for (const [name, value] of Object.entries(models ?? {})) {
      this.#reindex(this.model(name), value);
      changed.push({name, kind: 'model', value});
    }
    for (const [name, value] of Object.entries(lights ?? {})) {
      if (value === null) this.modelGone(name, null);
      changed.push({name, kind: 'light', value});
    }
    this.document.models = replacedByName(this.document.models, models ?? {});
    this.document.lights = replacedByName(this.document.lights, lights ?? {});
    Object.assign(this.document, world);
    if (world && Object.keys(world).length) changed.push({name: '', kind: 'world', value: world});
    if (order) this.#sort(order);
    for (const model of gone) {
      const renamed = renamedModel(this.document.models, linkNames(model), before);
      this.modelGone(model.name, renamed?.name ?? null);
    }
    // First: with thousands of them selected, each change would look at all of these.
    this.dropGone();
    for (const detail of changed) this.emit('entity', detail);
    if (order) this.emit('order');
  }

  #sort(order: string[]) {
    const places = new Map(order.map((name, index) => [name, index]));
    const place = ({name}: {name: string}) => places.get(name) ?? order.length;
    this.document?.models.sort((a, b) => place(a) - place(b));
    this.document?.lights.sort((a, b) => place(a) - place(b));
  }

  #reindex(former: Model|undefined, model: Model|null) {
    // Another model of the same change may have got the id of a link by now.
    const before = (former?.links ?? []).flatMap(({id}) => (this.#owners.get(id) === former ? [id] : []));
    for (const id of before) this.#owners.delete(id);
    if (model) this.#index(model);
    for (const id of before) if (!this.#owners.has(id)) this.poses.delete(id);
  }

  #index(model: Model) {
    for (const link of model.links) {
      this.#owners.set(link.id, model);
      if (!this.poses.has(link.id)) {
        this.poses.set(link.id, Float64Array.from(compose(model.pose, link.pose)));
      }
    }
  }

  /** Called when entities may have gone. */
  dropGone() {}

  /**
   * Called when there is no model or light of a name any more, before others are told.
   * @param _to  its new name, where it got one
   */
  modelGone(_name: string, _to: string|null) {}

  /** Called when another world was opened, before others are told. */
  worldGone() {}

  #setConnected(connected: boolean) {
    this.connected = connected;
    this.emit('connection');
  }

  // ---- looking things up

  /** The model's document, or undefined. */
  model(name: string) {
    const {models = []} = this.document ?? {};
    if (this.#models.of !== models) {
      this.#models = {of: models, byName: new Map(models.map((model) => [model.name, model]))};
    }
    return this.#models.byName.get(name);
  }

  /** The light's document, or undefined. */
  light(name: string) {
    return this.document?.lights.find((light) => light.name === name);
  }

  /**
   * What a name means.
   * @param name  "model", "model::link" or "light"
   */
  entity(name: string): EntityRef|null {
    const model = this.model(name);
    if (model) return {kind: 'model', model};
    const light = this.light(name);
    if (light) return {kind: 'light', light};
    const [owner, rest] = this.split(name);
    const link = owner?.links.find((one) => one.name === rest);
    return owner && link ? {kind: 'link', model: owner, link} : null;
  }

  /**
   * The model that a scoped name begins with, and the rest of the name within it.
   * @param name  `model`, `model::link`, `model::link::visual`, …
   */
  split(name: string): [Model|undefined, string] {
    const [model, rest] = splitScoped(name, (one) => this.model(one) !== undefined);
    return [this.model(model), rest];
  }

  /** The name of the model or light that a name belongs to; undefined where there is none. */
  wholeOf(name: string): string|undefined {
    return this.split(name)[0]?.name ?? this.light(name)?.name;
  }

  /**
   * Where an entity is now, in the world: of a model, where its first link carries its frame.
   * @returns pose7
   */
  worldPose(name: string): number[]|null {
    return this.poseWith(name, (id) => this.poses.get(id));
  }

  /** As `worldPose`, for links at other places. @param linkPose  pose7 in the world by id of a link */
  poseWith(name: string, linkPose: (id: number) => ArrayLike<number>|null|undefined): number[]|null {
    const entity = this.entity(name);
    if (!entity) return null;
    if (entity.kind === 'light') return [...entity.light.pose];
    const link = entity.kind === 'link' ? entity.link : canonicalLink(entity.model);
    const pose = link && linkPose(link.id);
    if (!link || !pose) return [...entity.model.pose];
    return entity.kind === 'link' ? Array.from(pose) : compose(pose, inverse(link.pose));
  }

  /** Whether this page shows a log instead of the running world. */
  get showsLog() {
    return this.log?.state === 'open' || this.log?.state === 'playing';
  }

  /** The others who have this world open. */
  get others() {
    return this.people.filter(({number}) => number !== this.me);
  }

  /**
   * Returns the name of the other user who did a step of the history; '' for this page's user and
   * for an unknown user.
   */
  authorOf(which: 'undo'|'redo', at = 0) {
    const by = this.history[`${which}_by`]?.[at] ?? '';
    return by === this.people.find(({number}) => number === this.me)?.name ? '' : by;
  }

  /** Sends the selection or the user's name to the other users. */
  tellPresence(fields: Notices['presence']) {
    this.#connection?.send('presence', fields);
  }

  addIssue(issue: Issue) {
    this.issues.push(issue);
    this.emit('issue', issue);
  }
}

/** The link that carries a model's frame: the one it names, else the first; undefined without links. */
function canonicalLink(model: Model): Link|undefined {
  return model.links.find((link) => link.name === model.canonical_link) ?? model.links[0];
}

/** Those of a list with changes by name: null where one has gone. New ones are last. */
function replacedByName<T extends {name: string}>(list: T[], changes: Record<string, T|null>): T[] {
  const left = new Map(Object.entries(changes));
  if (!left.size) return list;
  const kept = list.flatMap((one) => {
    const change = left.get(one.name);
    left.delete(one.name);
    return change === undefined ? [one] : change ?? [];
  });
  return [...kept, ...[...left.values()].flatMap((one) => one ?? [])];
}
