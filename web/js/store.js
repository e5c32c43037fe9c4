/** What the page knows: the world as the simulator last told it, and what the user looks at. */
import {decodeFrame, LIVE} from './pose_frames.js';
import {compose, inverse} from './pose.js';
import {splitScoped} from './scoped_names.js';

/** @typedef {'select'|'translate'|'rotate'|'scale'|'snap'|'insert'} Mode */

const OVERLAY_FLAGS = Object.freeze([
  'grid', 'origin', 'transparent', 'wireframe', 'collisions', 'joints', 'com', 'inertia',
  'contacts', 'frames', 'skeleton',
]);

/** What is never mentioned in a world file: how much of it the user wants to see. */
function initialOverlays() {
  const scene = Object.fromEntries(OVERLAY_FLAGS.map((flag) => [flag, false]));
  return {scene: {...scene, grid: true, origin: true}, models: {}, hiddenLayers: new Set()};
}

/**
 * Emits: `document` (a whole new world), `entity` (detail {name, kind: model|light|world, value};
 * value null: gone), `order`, `poses` (detail: Set of link ids), `selection`, `mode`, `placing`,
 * `overlays`, `stats`, `history`, `issue` (detail: Issue), `connection`, `clipboard`, `camera`,
 * `preview`, and pushes as they come: `watch`, `log`, `autosave`, `library`, `download`,
 * `shutdown`; `dialog` and `contextmenu` are asked for by actions and view, shown by the panels.
 */
export class Store extends EventTarget {
  /** The world's document, null until the simulator has sent one. */
  document = null;
  revision = 0;
  /** World pose of each link's frame by link id, as the simulator last told. */
  poses = new Map();
  /** Names in the order they were chosen: models, lights, "model::link". @type {string[]} */
  selection = [];
  /** @type {Mode} */
  mode = 'select';
  /** What follows the mouse until it is placed: {kind, document|light, op}, or null. */
  placing = null;
  overlays = initialOverlays();
  stats = {sim_ns: 0, real_ns: 0, factor: 0, iterations: 0, paused: true};
  history = {undo: [], redo: [], dirty: false, file: ''};
  /** What was copied: SDF, and documents for the ghost. @type {{text: string, items: any[]}|null} */
  clipboard = null;
  /** @type {import('./connection.js').Issue[]} */
  issues = [];
  connected = false;
  autosave = null;
  log = null;
  /** @type {{projection: 'perspective'|'orthographic', controller: 'orbit'|'fps',
   *          following: string|null}} */
  camera = {projection: 'perspective', controller: 'orbit', following: null};
  /** A model document shown beside the world, e.g. a building being drawn. */
  preview = null;

  /** From a link's id to the document of its model. */
  #owners = new Map();

  /** @param {import('./connection.js').Connection} [connection] */
  constructor(connection) {
    super();
    if (!connection) return;
    connection.addEventListener('open', () => this.#setConnected(true));
    connection.addEventListener('close', () => this.#setConnected(false));
    connection.addEventListener('message', (event) => this.receive(event.detail));
    connection.addEventListener('frame', (event) => this.receiveFrame(event.detail));
  }

  // ---- what comes from the simulator

  /** Takes a pushed message. @param {any} message */
  receive(message) {
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
      case 'issue': this.addIssue(message.issue); break;
      case 'autosave': this.autosave = message; this.emit('autosave', message); break;
      case 'log': this.log = message; this.emit('log', message); break;
      case 'watch': case 'library': case 'download': case 'shutdown':
        this.emit(message.type, message); break;
      default: break;  // of a newer simulator
    }
  }

  /** Takes a binary pose frame. @param {ArrayBuffer} buffer */
  receiveFrame(buffer) {
    const frame = decodeFrame(buffer);
    if (!frame) return;
    const moved = new Set();
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

  #replaceWorld({revision, document}) {
    this.revision = revision;
    this.document = document;
    this.poses.clear();
    this.#owners.clear();
    for (const model of document.models) this.#index(model);
    this.emit('document');
    this.#dropGone();
  }

  #change({revision, models = {}, lights = {}, world = {}, order}) {
    if (!this.document) return;
    this.revision = revision;
    const changed = [];
    for (const [kind, list, entities] of [
      ['model', this.document.models, models], ['light', this.document.lights, lights]]) {
      for (const [name, value] of Object.entries(entities)) {
        replaceByName(list, name, value);
        if (kind === 'model') this.#reindex(name, value);
        changed.push({name, kind, value});
      }
    }
    Object.assign(this.document, world);
    if (Object.keys(world).length) changed.push({name: '', kind: 'world', value: world});
    if (order) this.#sort(order);
    for (const detail of changed) this.emit('entity', detail);
    if (order) this.emit('order');
    this.#dropGone();
  }

  #sort(order) {
    const places = new Map(order.map((name, index) => [name, index]));
    const place = ({name}) => places.get(name) ?? order.length;
    this.document.models.sort((a, b) => place(a) - place(b));
    this.document.lights.sort((a, b) => place(a) - place(b));
  }

  #reindex(name, model) {
    const before = [...this.#owners].filter(([, owner]) => owner.name === name);
    for (const [id] of before) this.#owners.delete(id);
    if (model) this.#index(model);
    for (const [id] of before) if (!this.#owners.has(id)) this.poses.delete(id);
  }

  #index(model) {
    for (const link of model.links) {
      this.#owners.set(link.id, model);
      if (!this.poses.has(link.id)) {
        this.poses.set(link.id, Float64Array.from(compose(model.pose, link.pose)));
      }
    }
  }

  #dropGone() {
    const left = this.selection.filter((name) => this.entity(name));
    if (left.length !== this.selection.length) this.#setSelection(left);
  }

  #setConnected(connected) {
    this.connected = connected;
    this.emit('connection');
  }

  // ---- looking things up

  /** @returns {any} the model's document, or undefined */
  model(name) {
    return this.document?.models.find((model) => model.name === name);
  }

  /** @returns {any} the light's document, or undefined */
  light(name) {
    return this.document?.lights.find((light) => light.name === name);
  }

  /**
   * What a name means.
   * @param {string} name  "model", "model::link" or "light"
   * @returns {{kind: 'model'|'link'|'light', model?: any, link?: any, light?: any}|null}
   */
  entity(name) {
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
   * @param {string} name  `model`, `model::link`, `model::link::visual`, …
   * @returns {[Model|undefined, string]}
   */
  split(name) {
    const [model, rest] = splitScoped(name, (one) => this.model(one) !== undefined);
    return [this.model(model), rest];
  }

  /**
   * Where an entity is now, in the world: of a model, where its first link carries its frame.
   * @returns {number[]|null} pose7
   */
  worldPose(name) {
    const entity = this.entity(name);
    if (!entity) return null;
    if (entity.kind === 'light') return [...entity.light.pose];
    if (entity.kind === 'link') return [...this.poses.get(entity.link.id)];
    const first = canonicalLink(entity.model);
    if (!first) return [...entity.model.pose];
    return compose(this.poses.get(first.id), inverse(first.pose));
  }

  // ---- what the user looks at

  /**
   * @param {string[]} names
   * @param {{add?: boolean, toggle?: boolean}} [how]  neither: the names replace the selection
   */
  select(names, {add = false, toggle = false} = {}) {
    let next = add || toggle ? [...this.selection] : [];
    for (const name of names) {
      const present = next.includes(name);
      if (present && toggle) next = next.filter((one) => one !== name);
      else if (!present) next.push(name);
    }
    this.#setSelection(next);
  }

  #setSelection(names) {
    const same = names.length === this.selection.length &&
      names.every((name, index) => name === this.selection[index]);
    if (same) return;
    this.selection = names;
    this.emit('selection');
  }

  /** @param {Mode} mode */
  setMode(mode) {
    if (mode !== 'insert' && this.placing) {
      this.placing = null;
      this.emit('placing');
    }
    if (mode === this.mode) return;
    this.mode = mode;
    this.emit('mode');
  }

  /** Gives the mouse something to place, or nothing. */
  setPlacing(placing) {
    this.placing = placing;
    this.emit('placing');
    this.setMode(placing ? 'insert' : 'select');
  }

  /** The whole scene's flag, or one model's, which then overrides it; null: as the scene. */
  setOverlay(flag, on, model) {
    const flags = model ? (this.overlays.models[model] ??= {}) : this.overlays.scene;
    if (on === null) delete flags[flag];
    else flags[flag] = on;
    this.emit('overlays', {flag, model});
  }

  /** Whether a flag holds for a model. */
  overlay(flag, model) {
    return this.overlays.models[model]?.[flag] ?? this.overlays.scene[flag];
  }

  /** Shows or hides the visuals of a layer (visual/meta/layer). */
  setLayer(layer, shown) {
    if (shown) this.overlays.hiddenLayers.delete(layer);
    else this.overlays.hiddenLayers.add(layer);
    this.emit('overlays', {layer});
  }

  setCamera(fields) {
    Object.assign(this.camera, fields);
    this.emit('camera');
  }

  setClipboard(clipboard) {
    this.clipboard = clipboard;
    this.emit('clipboard');
  }

  setPreview(document) {
    this.preview = document;
    this.emit('preview');
  }

  /** @param {import('./connection.js').Issue} issue */
  addIssue(issue) {
    this.issues.push(issue);
    this.emit('issue', issue);
  }

  /** Tells listeners. @param {string} type @param {any} [detail] */
  emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, {detail}));
  }
}

/** The link that carries a model's frame: the one it names, else the first. */
export function canonicalLink(model) {
  return model.links.find((link) => link.name === model.canonical_link) ?? model.links[0];
}

function replaceByName(list, name, value) {
  const index = list.findIndex((one) => one.name === name);
  if (value === null) {
    if (index >= 0) list.splice(index, 1);
  } else if (index >= 0) list[index] = value;
  else list.push(value);
}
