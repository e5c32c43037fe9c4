/** What the page knows: the world as the simulator last told it, and what the user looks at. */
import {WorldStore} from './world_store.js';
/** @import {
 *   AutosavePush, DownloadPush, LibraryPush, Light, Link, LoadingPush, LogPush, Model, Operation,
 *   ShutdownPush, WatchPush, World
 * } from './protocol.js' */
/** @import {Issue} from './connection.js' */
/** @import {DialogRequest} from './actions.js' */
/** @import {Pose7} from './pose.js' */
/** @import {ShapeName} from './new_entities.js' */

/** @typedef {'select'|'translate'|'rotate'|'scale'|'snap'|'measure'|'insert'|'connect'} Mode */
/** @typedef {'grid'|'origin'|'transparent'|'wireframe'|'collisions'|'joints'|'com'|'inertia'|
 *            'contacts'|'frames'|'skeleton'|'hidden'|'locked'|'cameraColors'} OverlayFlag  hidden: not drawn; locked: the
 *   mouse passes through it */

/**
 * What follows the mouse until it is placed.
 * @typedef {{op: (pose: Pose7) => Operation, items?: CopiedItem[], keepHeight?: boolean,
 *            shape?: ShapeName, uri?: string} & CopiedItem} Placing
 */

/** @typedef {{kind: 'model', document: Model}|{kind: 'light', document: Light}} CopiedItem */

/**
 * What was copied: SDF, and documents for the ghost.
 * @typedef {{text: string, items: CopiedItem[]}} Clipboard
 */

/** @typedef {{projection: 'perspective'|'orthographic', controller: 'orbit'|'fps',
 *             following: string|null}} CameraChoices */

/**
 * What a name means.
 * @typedef {{kind: 'model', model: Model, link?: undefined, light?: undefined}|
 *           {kind: 'link', model: Model, link: Link, light?: undefined}|
 *           {kind: 'light', light: Light, model?: undefined, link?: undefined}} EntityRef
 */

/**
 * A changed entity; value null: it is gone.
 * @typedef {{kind: 'model', name: string, value: Model|null}|
 *           {kind: 'light', name: string, value: Light|null}|
 *           {kind: 'world', name: '', value: Partial<World>}} EntityChange
 */

/**
 * The store's events, with the types of their details.
 * @typedef {object} StoreEvents
 * @property {undefined} document  a whole new world
 * @property {EntityChange} entity
 * @property {undefined} order
 * @property {Set<number>} poses  ids of the links that moved
 * @property {undefined} selection
 * @property {undefined} mode
 * @property {undefined} placing
 * @property {{flag?: OverlayFlag, model?: string, layer?: number}} overlays
 * @property {undefined} stats
 * @property {undefined} history
 * @property {Issue} issue
 * @property {undefined} connection
 * @property {undefined} clipboard
 * @property {undefined} camera
 * @property {undefined} preview
 * @property {undefined} modelEditing
 * @property {{model: string, link: string}[]} pick  links under a click in the mode `connect`, nearest
 *   first
 * @property {undefined} plugins  whether they run
 * @property {undefined} people  who is here, what they hold and have selected
 * @property {LoadingPush} loading
 * @property {WatchPush} watch
 * @property {LogPush} log
 * @property {AutosavePush} autosave
 * @property {LibraryPush} library
 * @property {DownloadPush} download
 * @property {ShutdownPush} shutdown
 * @property {DialogRequest} dialog  a window that an action asks for; the panels open it
 * @property {{name: string|null, x: number, y: number}} contextmenu  name null: of nothing
 */

/** @type {readonly OverlayFlag[]} */
const OVERLAY_FLAGS = Object.freeze([
  'grid', 'origin', 'transparent', 'wireframe', 'collisions', 'joints', 'com', 'inertia',
  'contacts', 'frames', 'skeleton', 'hidden', 'locked', 'cameraColors',
]);

/** What is never mentioned in a world file: how much of it the user wants to see. */
function initialOverlays() {
  const off = /** @type {Record<OverlayFlag, boolean>} */ (
    Object.fromEntries(OVERLAY_FLAGS.map((flag) => [flag, false])));
  return {
    scene: {...off, grid: true, origin: true},
    /** @type {Record<string, Partial<Record<OverlayFlag, boolean>>>} */
    models: {},
    /** Of what is selected. @type {Partial<Record<OverlayFlag, boolean>>} */
    selection: {},
    /** @type {Set<number>} */
    hiddenLayers: new Set(),
  };
}

/** The world and the state of this page's user interface. Emits an event for every change. */
export class Store extends WorldStore {
  /** Names in the order they were chosen: models, lights, "model::link". @type {string[]} */
  selection = [];
  /** @type {Mode} */
  mode = 'select';
  /** @type {Placing|null} */
  placing = null;
  overlays = initialOverlays();
  /** @type {Clipboard|null} */
  clipboard = null;
  /** @type {CameraChoices} */
  camera = {projection: 'perspective', controller: 'orbit', following: null};
  /** A model document shown beside the world, e.g. a building being drawn. @type {Model|null} */
  preview = null;
  /**
   * While the model editor is open: the model, null until it has a first link.
   * @type {{name: string|null}|null}
   */
  modelEditing = null;

  /** What has gone is no longer selected. */
  dropGone() {
    const left = this.selection.filter((name) => this.entity(name));
    if (left.length !== this.selection.length) this.#setSelection(left);
  }

  /**
   * What is shown of a model goes with it, and is not that of the next one of its name.
   * @param {string} name
   * @param {string|null} to  its new name
   */
  modelGone(name, to) {
    const {[name]: flags, ...others} = this.overlays.models;
    if (flags) this.overlays.models = to === null ? others : {...others, [to]: flags};
  }

  worldGone() {
    this.overlays.models = {};
  }

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

  /** @param {string[]} names */
  #setSelection(names) {
    const same = names.length === this.selection.length &&
      names.every((name, index) => name === this.selection[index]);
    if (same) return;
    this.selection = names;
    this.emit('selection');
    if (this.others.length) this.tellPresence({selected: names});
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

  /** Gives the mouse something to place, or nothing. @param {Placing|null} placing */
  setPlacing(placing) {
    this.placing = placing;
    this.emit('placing');
    this.setMode(placing ? 'insert' : 'select');
  }

  /**
   * The whole scene's flag, or one model's, which then overrides it; null: as the scene.
   * @param {OverlayFlag} flag
   * @param {boolean|null} on
   * @param {string} [model]
   */
  setOverlay(flag, on, model) {
    const flags = model ? (this.overlays.models[model] ??= {}) : this.overlays.scene;
    if (on === null) delete flags[flag];
    else flags[flag] = on;
    this.emit('overlays', {flag, model});
  }

  /**
   * Whether a flag holds for a model, or for the scene.
   * @param {OverlayFlag} flag
   * @param {string} [model]
   * @returns {boolean}
   */
  overlay(flag, model) {
    if (model && this.overlays.selection[flag] && this.#isSelected(model)) return true;
    return (model ? this.overlays.models[model]?.[flag] : undefined) ?? this.overlays.scene[flag];
  }

  /** @param {string} model */
  #isSelected(model) {
    return this.selection.some((name) => this.split(name)[0]?.name === model);
  }

  /**
   * Shows something of the selected models, whatever the scene's flags say.
   * @param {OverlayFlag} flag
   * @param {boolean} on
   */
  setOverlayOfSelection(flag, on) {
    this.overlays.selection[flag] = on;
    this.emit('overlays', {flag});
  }

  /**
   * Shows or hides the visuals of a layer (visual/meta/layer).
   * @param {number} layer
   * @param {boolean} shown
   */
  setLayer(layer, shown) {
    if (shown) this.overlays.hiddenLayers.delete(layer);
    else this.overlays.hiddenLayers.add(layer);
    this.emit('overlays', {layer});
  }

  /** @param {Partial<CameraChoices>} fields */
  setCamera(fields) {
    Object.assign(this.camera, fields);
    this.emit('camera');
  }

  /** @param {Clipboard|null} clipboard */
  setClipboard(clipboard) {
    this.clipboard = clipboard;
    this.emit('clipboard');
  }

  /** @param {Model|null} document */
  setPreview(document) {
    this.preview = document;
    this.emit('preview');
  }

  /** @param {{name: string|null}|null} editing */
  setModelEditing(editing) {
    this.modelEditing = editing;
    this.emit('modelEditing');
  }
}
