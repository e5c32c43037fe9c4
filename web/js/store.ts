/** What the page knows: the world as the simulator last told it, and what the user looks at. */
import {WorldStore} from './world_store.js';
import type {Light, Link, Model, Operation, Pushes, World} from './protocol.js';
import type {Issue} from './connection.js';
import type {DialogRequest} from './actions.js';
import type {Pose7} from './pose.js';
import type {ShapeName} from './new_entities.js';

export type Mode = 'select'|'translate'|'rotate'|'scale'|'snap'|'measure'|'insert'|'connect';
/**
 * hidden: not drawn; locked: the
 *  mouse passes through it
 */
export type OverlayFlag = 'grid'|'origin'|'transparent'|'wireframe'|'collisions'|'joints'|'com'|'inertia'|
    'contacts'|'frames'|'skeleton'|'hidden'|'locked'|'cameraColors'|'simplifiedMeshes';

/** What follows the mouse until it is placed. */
type Placing = {op: (pose: Pose7) => Operation, items?: CopiedItem[], keepHeight?: boolean,
    shape?: ShapeName, uri?: string} & CopiedItem;

export type CopiedItem = {kind: 'model', document: Model}|{kind: 'light', document: Light};

/** What was copied: SDF, and documents for the ghost. */
type Clipboard = {text: string, items: CopiedItem[]};

export type CameraChoices = {projection: 'perspective'|'orthographic', controller: 'orbit'|'fps',
    following: string|null};

/** What a name means. */
export type EntityRef = {kind: 'model', model: Model, link?: undefined, light?: undefined}|
    {kind: 'link', model: Model, link: Link, light?: undefined}|
    {kind: 'light', light: Light, model?: undefined, link?: undefined};

/** A changed entity; value null: it is gone. */
export type EntityChange = {kind: 'model', name: string, value: Model|null}|
    {kind: 'light', name: string, value: Light|null}|
    {kind: 'world', name: '', value: Partial<World>};

/** The store's events, with the types of their details. */
export interface StoreEvents {
  /** a whole new world */
  document: undefined;
  entity: EntityChange;
  order: undefined;
  /** ids of the links that moved */
  poses: Set<number>;
  selection: undefined;
  mode: undefined;
  placing: undefined;
  overlays: {flag?: OverlayFlag, model?: string|undefined, layer?: number};
  stats: undefined;
  history: undefined;
  issue: Issue;
  connection: undefined;
  clipboard: undefined;
  camera: undefined;
  preview: undefined;
  modelEditing: undefined;
  /**
   * links under a click in the mode `connect`, nearest
   * first
   */
  pick: {model: string, link: string}[];
  /** whether they run */
  plugins: undefined;
  /** who is here, what they hold and have selected */
  people: undefined;
  loading: Pushes['loading'];
  watch: Pushes['watch'];
  log: Pushes['log'];
  autosave: Pushes['autosave'];
  library: Pushes['library'];
  download: Pushes['download'];
  shutdown: Pushes['shutdown'];
  /** a window that an action asks for; the panels open it */
  dialog: DialogRequest;
  /** name null: of nothing */
  contextmenu: {name: string|null, x: number, y: number};
}

const OVERLAY_FLAGS: readonly OverlayFlag[] = Object.freeze([
  'grid', 'origin', 'transparent', 'wireframe', 'collisions', 'joints', 'com', 'inertia',
  'contacts', 'frames', 'skeleton', 'hidden', 'locked', 'cameraColors', 'simplifiedMeshes',
]);

/** Returns the overlays of a new page. World files do not store them. */
function initialOverlays() {
  const off = Object.fromEntries(OVERLAY_FLAGS.map((flag) => [flag, false])) as Record<OverlayFlag,
      boolean>;
  return {
    scene: {...off, grid: true, origin: true},
    models: {} as Record<string, Partial<Record<OverlayFlag, boolean>>>,
    /** Of what is selected. */
    selection: {} as Partial<Record<OverlayFlag, boolean>>,
    hiddenLayers: new Set() as Set<number>,
  };
}

/** The world and the state of this page's user interface. Emits an event for every change. */
export class Store extends WorldStore {
  /** Names in the order they were chosen: models, lights, "model::link". */
  selection: string[] = [];
  mode: Mode = 'select';
  placing: Placing|null = null;
  overlays = initialOverlays();
  clipboard: Clipboard|null = null;
  camera: CameraChoices = {projection: 'perspective', controller: 'orbit', following: null};
  /** A model document shown beside the world, e.g. a building being drawn. */
  preview: Model|null = null;
  /** While the model editor is open: the model, null until it has a first link. */
  modelEditing: {name: string|null}|null = null;

  /** What has gone is no longer selected. */
  override dropGone() {
    const models = new Set(this.document?.models.map(({name}) => name));
    const left = this.selection.filter((name) => models.has(name) || this.entity(name));
    if (left.length !== this.selection.length) this.#setSelection(left);
  }

  /**
   * What is shown of a model or light goes with it, and is not that of the next one of its name.
   * @param to  its new name
   */
  override modelGone(name: string, to: string|null) {
    const {[name]: flags, ...others} = this.overlays.models;
    if (flags) this.overlays.models = to === null ? others : {...others, [to]: flags};
  }

  override worldGone() {
    this.overlays.models = {};
  }

  /** @param how  neither: the names replace the selection */
  select(names: string[], {add = false, toggle = false}: {add?: boolean|undefined, toggle?: boolean|undefined} = {}) {
    let next = add || toggle ? [...this.selection] : [];
    for (const name of names) {
      const present = next.includes(name);
      if (present && toggle) next = next.filter((one) => one !== name);
      else if (!present) next.push(name);
    }
    this.#setSelection(next);
  }

  #setSelection(names: string[]) {
    const same = names.length === this.selection.length &&
      names.every((name, index) => name === this.selection[index]);
    if (same) return;
    this.selection = names;
    this.emit('selection');
    if (this.others.length) this.tellPresence({selected: names});
  }

  setMode(mode: Mode) {
    if (mode !== 'insert' && this.placing) {
      this.placing = null;
      this.emit('placing');
    }
    if (mode === this.mode) return;
    this.mode = mode;
    this.emit('mode');
  }

  /** Gives the mouse something to place, or nothing. */
  setPlacing(placing: Placing|null) {
    this.placing = placing;
    this.emit('placing');
    this.setMode(placing ? 'insert' : 'select');
  }

  /** The whole scene's flag, or one model's, which then overrides it; null: as the scene. */
  setOverlay(flag: OverlayFlag, on: boolean|null, model?: string) {
    const flags = model ? (this.overlays.models[model] ??= {}) : this.overlays.scene;
    if (on === null) delete flags[flag];
    else flags[flag] = on;
    this.emit('overlays', {flag, model});
  }

  /** Whether a flag holds for a model, or for the scene. */
  overlay(flag: OverlayFlag, model?: string): boolean {
    if (model && this.overlays.selection[flag] && this.#isSelected(model)) return true;
    return (model ? this.overlays.models[model]?.[flag] : undefined) ?? this.overlays.scene[flag];
  }

  #isSelected(model: string) {
    return this.selection.some((name) => this.split(name)[0]?.name === model);
  }

  /** Shows something of the selected models, whatever the scene's flags say. */
  setOverlayOfSelection(flag: OverlayFlag, on: boolean) {
    this.overlays.selection[flag] = on;
    this.emit('overlays', {flag});
  }

  /** Shows or hides the visuals of a layer (visual/meta/layer). */
  setLayer(layer: number, shown: boolean) {
    if (shown) this.overlays.hiddenLayers.delete(layer);
    else this.overlays.hiddenLayers.add(layer);
    this.emit('overlays', {layer});
  }

  setCamera(fields: Partial<CameraChoices>) {
    Object.assign(this.camera, fields);
    this.emit('camera');
  }

  setClipboard(clipboard: Clipboard|null) {
    this.clipboard = clipboard;
    this.emit('clipboard');
  }

  setPreview(document: Model|null) {
    this.preview = document;
    this.emit('preview');
  }

  setModelEditing(editing: {name: string|null}|null) {
    this.modelEditing = editing;
    this.emit('modelEditing');
  }
}
