/**
 * Everything a user can do, as functions: menus, tool bar, keys and context menu call the same.
 *
 * Actions that ask the simulator resolve to `{ok, value, issues}` and never reject; what was
 * refused is also put into the store's issues, unless a dialog that shows it itself asks for `quiet`.
 */
import {arrangeActions} from './arrange_actions.js';
import {cameraActions} from './camera_actions.js';
import {RequestError} from './connection.js';
import {fileActions} from './file_actions.js';
import {insertActions} from './insert_actions.js';
import {linkMoves, linkRemovals} from './model_edits.js';
import {NOTHING} from './nothing.js';
import type {CopiedItem, EntityRef, Mode, OverlayFlag, Store} from './store.js';
import type {Issue, RequestFunction} from './connection.js';
import type {Dropped} from './dropped_files.js';
import type {Operation, Operations, Requests} from './protocol.js';
import type {Vec3} from './pose.js';
import type {SceneView} from './view/scene_view.js';
import type {Turned} from './view/force_arrows.js';

/** What became of a request. */
export type Outcome<Value = unknown> = {ok: true, value: Value, issues: Issue[]}|{ok: false,
    value?: undefined, issues: Issue[]};

/** quiet: issues are returned only */
type AskOptions = {quiet?: boolean};

type JointFields = Operations['joint'];

export type ShownWrench = {link: string, force: Vec3, torque: Vec3, point?: Vec3|null,
    in_link_axes?: boolean};

export type DialogName = 'newWorld'|'open'|'saveAs'|'cloneWorld'|'applyForce'|'hotkeys'|'about'|'plot'|'logs'|'joints'|'topics'|'recover'|'importFiles'|
    'building'|'modelEditor'|'saveModel'|'schematic'|'togglePanels'|'find'|'rename'|'array'|'commands'|'nextRegion'|'previousRegion';

export type DialogRequest = {name: DialogName, target?: string, entries?: Dropped[], place?: Vec3};

export type Actions = ReturnType<typeof createActions>;

/** What the parts of the actions share; `view` is null until the view is there. */
export interface ActionParts {
  store: Store;
  ask: Ask;
  edit: (op: Operation, options?: AskOptions) => Promise<Outcome<Requests['edit']['reply']>>;
  dialog: (name: DialogName, fields?: Omit<DialogRequest, 'name'>) => void;
  note: (message: string) => void;
  view: () => SceneView|null;
}

type Ask = <T extends keyof Requests>(type: T, fields?: Requests[T]['fields'],
    options?: AskOptions) =>
    Promise<Outcome<Requests[T]['reply']>>;

export function createActions({store, connection}: {store: Store,
    connection: {request: RequestFunction}}) {
  /** Set by the view once it is there; without WebGL it never is. */
  let view: SceneView|null = null;
  /** Closes the window of the force that is shown. */
  let endForce: (() => void)|null = null;

  async function ask<T extends keyof Requests>(type: T, fields?: Requests[T]['fields'],
      {quiet = false}: AskOptions = {}): Promise<Outcome<Requests[T]['reply']>> {
    try {
      return {ok: true, value: await connection.request(type, fields), issues: []};
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      if (!quiet) for (const issue of error.issues) store.addIssue(issue);
      return {ok: false, issues: error.issues};
    }
  }
  const edit = (op: Operation, options?: AskOptions) => ask('edit', {op}, options);
  const dialog = (name: DialogName, fields: Omit<DialogRequest, 'name'> = {}) =>
      { store.emit('dialog', {name, ...fields}); };
  const note = (message: string) => store.addIssue({severity: 'note', code: 'editor', message});

  const parts: ActionParts = {store, ask, edit, dialog, note, view: () => view};
  const files = fileActions(parts);
  const camera = cameraActions(parts);
  const inserts = insertActions(parts);
  const arrange = arrangeActions(parts);

  const actions = {
    attachView(theView: SceneView) { view = theView; },
    ask,
    edit,

    ...files,

    // ---- editing
    /** @param to  steps more than one */
    undo: (to?: number) => moveInHistory('undo', to),
    /** @param to  steps more than one */
    redo: (to?: number) => moveInHistory('redo', to),
    remove(names = store.selection): Promise<Outcome> {
      const parts = linkRemovals(edited(), names);
      if (parts.length) return edit(parts.length > 1 ? {kind: 'group', ops: parts, label: 'Remove links'} : parts[0]);
      const whole = [...new Set(names.map((name) => store.entity(name)?.model?.name ?? name))];
      return whole.length ? edit({kind: 'delete', names: whole}) : Promise.resolve(NOTHING);
    },
    async rename(name: string, to: string) {
      const outcome = await edit({kind: 'rename', name, to});
      if (outcome.ok) store.select([to]);
      return outcome;
    },
    /**
     * @param target  "" is the world
     * @param path  e.g. "inertial.mass"
     */
    setProperty: (target: string, path: string, value: unknown) =>
        edit({kind: 'set', target, path, value}),
    /** @param poses  pose7 in the world by name */
    move(poses: Record<string, number[]>, label?: string) {
      const model = edited();
      const ops = model ? linkMoves(model, store.worldPose(model.name) ?? model.pose, poses) : [];
      if (ops.length) return edit({kind: 'group', ops, label: `Move ${Object.keys(poses).join(', ')}`});
      return edit({kind: 'move', poses, ...(label ? {label} : {})});
    },
    scale: (name: string, factors: Vec3) => edit({kind: 'scale', name, scale: factors}),
    group: (ops: Operation[], label: string) => edit({kind: 'group', ops, label}),
    resetPoses: () => edit({kind: 'reset', what: 'poses'}),
    resetWorld: () => edit({kind: 'reset', what: 'world'}),
    resetTime: () => edit({kind: 'reset', what: 'time'}),
    /** Copies models and lights (default: the selection) to the clipboard. */
    async copy(names = store.selection): Promise<Outcome> {
      const items = names.flatMap((name) => {
        const copied = copyOf(store.entity(name));
        if (!copied) return [];
        copied.document.pose = store.worldPose(name) ?? copied.document.pose;
        return [copied];
      });
      if (!items.length) return NOTHING;
      const wanted = items.map(({document}) => document.name);
      const outcome = await ask('copy', {names: wanted});
      if (outcome.ok) store.setClipboard({text: outcome.value.text, items});
      return outcome;
    },
    /** Attaches the copied models and lights to the mouse pointer for placing. */
    paste() {
      const {text = '', items = []} = store.clipboard ?? {};
      const last = items.at(-1);
      if (!last) return;
      store.setPlacing({...last, items, keepHeight: true,
        op: (pose) => ({kind: 'paste', text, poses: [pose]})});
    },

    ...inserts,
    ...arrange,

    // ---- modes
    /** Esc: first what is being placed or followed, then the tool, then the selection. */
    escape(): void {
      if (view?.cancelDrag()) return;
      if (store.placing) store.setPlacing(null);
      else if (store.camera.following) camera.follow(null);
      else if (store.mode !== 'select') store.setMode('select');
      else if (endForce) endForce();
      else store.select([]);
    },
    selectMode: () => store.setMode('select'),
    translateMode: () => manipulate('translate'),
    rotateMode: () => manipulate('rotate'),
    scaleMode: () => manipulate('scale'),
    snapMode: () => store.setMode(store.mode === 'snap' ? 'select' : 'snap'),
    measureMode: () => store.setMode(store.mode === 'measure' ? 'select' : 'measure'),

    ...camera,

    // ---- what is shown
    setOverlay: (flag: OverlayFlag, on: boolean|null, model?: string) => store.setOverlay(flag, on,
        model),
    toggleOverlay: (flag: OverlayFlag, model?: string) => store.setOverlay(flag,
        !store.overlay(flag, model), model),
    setLayer: (layer: number, shown: boolean) => store.setLayer(layer, shown),

    // ---- time
    play: () => whileRunning(() => ask('play')),
    pause: () => ask('pause'),
    togglePlay: () => whileRunning(() => ask(store.stats.paused ? 'play' : 'pause')),
    step: (steps = 1) => whileRunning(() => ask('step', {steps})),

    // ---- forces and joints
    /** @param wrench  N, N m */
    wrench: (wrench: {link: string, force: number[], torque: number[], point?: number[],
    in_link_axes?: boolean, steps?: number}) => edit({kind: 'wrench', in_link_axes: false, steps: 1,
        ...wrench}),
    /** Arrows for the force dialog; `null` takes them away. */
    /**
     * Shows the arrows of a force; `null` takes them away.
     * @param onTurned  told while the mouse turns an arrow
     * @param onEscape  called for Escape in the view
     */
    showForce(wrench: ShownWrench|null, onTurned?: (turned: Turned) => void, onEscape?: () => void) {
      endForce = wrench ? onEscape ?? null : null;
      view?.showForce(wrench, onTurned);
    },
    joint: (fields: JointFields) => edit({kind: 'joint', ...fields}),

    // ---- pictures
    /** A PNG of the view; downloaded unless `download` is false. */
    async screenshot({download = true} = {}): Promise<Blob|null> {
      if (!view) return null;
      const blob = await view.picture();
      if (blob && download) saveBlob(blob, `${store.document?.name ?? 'world'}-${timestamp()}.png`);
      return blob;
    },

    // ---- logs and plots
    watch: (topics: string[]) => ask('watch', {topics}),
    logStart: (name?: string) => ask('log_start', name ? {name} : {}),
    logStop: () => ask('log_stop'),
    logList: () => ask('log_list'),
    logOpen: (name: string) => ask('log_open', {name}),
    logSeek: (time: number) => ask('log_seek', {time}),
    logPlay: (rate = 1) => ask('log_play', {rate}),
    logClose: () => ask('log_close'),

    // ---- robots
    /** Velocities for a robot, in its own axes; m/s, rad/s. */
    async drive(model: string, {linear, angular}: {linear: number[], angular: number[]}) {
      const outcome = await ask('drive', {model, linear, angular}, {quiet: true});
      // An arrow key beside a model that is not a robot is no error.
      for (const issue of outcome.issues) store.addIssue({...issue, severity: 'note'});
      return outcome;
    },
    topics: () => dialog('topics'),

    // ---- windows of the panels
    applyForce: (name = store.selection.at(-1)) => dialog('applyForce', name ? {target: name} : {}),
    hotkeys: () => dialog('hotkeys'),
    about: () => dialog('about'),
    plot: () => dialog('plot'),
    logs: () => dialog('logs'),
    joints: () => dialog('joints'),
    building: () => dialog('building'),
    schematic: () => dialog('schematic'),
    /**
     * Opens the model editor, or leaves it.
     * @param name  of the model to edit
     */
    modelEditor: (name?: string) => dialog('modelEditor', name ? {target: name} : {}),
    togglePanels: () => dialog('togglePanels'),
    find: () => dialog('find'),
    renameSelected: () => dialog('rename'),
    nextRegion: () => dialog('nextRegion'),
    previousRegion: () => dialog('previousRegion'),
    fullScreen() {
      if (document.fullscreenElement) return document.exitFullscreen();
      return document.documentElement.requestFullscreen();
    },
    /** What of the preview (store.preview) is under a point of the page: {link} or null. */
    previewPick: (clientX: number, clientY: number) => view?.previewPick(clientX, clientY) ?? null,
  };

  /** The model that the model editor has. */
  function edited() {
    const name = store.modelEditing?.name;
    return name ? store.model(name) : undefined;
  }

  /** Time stands still while a model is built. */
  async function whileRunning<T>(run: () => Promise<Outcome<T>>): Promise<Outcome<T|{}>> {
    if (!store.modelEditing) return run();
    note('Leave the model editor (Ctrl+M) to run the simulation.');
    return NOTHING;
  }

  /** One history for everybody: whose edit it was is said. */
  async function moveInHistory(which: 'undo'|'redo', to?: number) {
    const outcome = await ask(which, to === undefined ? {} : {to}, {quiet: true});
    if (outcome.issues.some(({message}) => message === `nothing to ${which}`)) note(`There is nothing to ${which}.`);
    else outcome.issues.forEach((issue) => store.addIssue(issue));
    const {label, by = []} = outcome.value ?? {};
    if (label && by.length) {
      const done = {undo: 'Undid', redo: 'Redid'}[which];
      note(to ? `${done} ${to + 1} edits, some of ${by.join(' and ')}`
        : `${done} an edit of ${by.join(' and ')}: ${label}`);
    }
    return outcome;
  }

  function manipulate(mode: Mode) {
    if (store.camera.following) note('Not available while following a model; press Esc to stop following.');
    else store.setMode(mode);
  }

  return actions;
}

/** A copy of a model or light; null of a link, or of nothing. */
function copyOf(entity: EntityRef|null): CopiedItem|null {
  if (entity?.kind === 'model') return {kind: 'model', document: structuredClone(entity.model)};
  if (entity?.kind === 'light') return {kind: 'light', document: structuredClone(entity.light)};
  return null;
}

/** Lets the browser store a file. */
export function saveBlob(blob: Blob, name: string) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const timestamp = () => new Date().toISOString().slice(0, 19).replaceAll(':', '-');
