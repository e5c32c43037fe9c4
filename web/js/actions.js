/**
 * Everything a user can do, as functions: menus, tool bar, keys and context menu call the same.
 *
 * Actions that ask the simulator resolve to `{ok, value, issues}` and never reject; what was
 * refused is also put into the store's issues, unless a dialog that shows it itself asks for `quiet`.
 */
import {alignMoves} from './align.js';
import {arrangeActions} from './arrange_actions.js';
import {cameraActions} from './camera_actions.js';
import {RequestError} from './connection.js';
import {fileActions} from './file_actions.js';
import {insertActions} from './insert_actions.js';
import {linkMoves, linkRemovals} from './model_editor/model_edits.js';
import {NOTHING} from './nothing.js';
/** @import {AlignChoice} from './align.js' */
/** @import {CopiedItem, EntityRef, Mode, OverlayFlag, Store} from './store.js' */
/** @import {Issue, RequestFunction} from './connection.js' */
/** @import {Dropped} from './dropped_files.js' */
/** @import {Operation, Requests} from './protocol.js' */
/** @import {Pose7, Vec3} from './pose.js' */
/** @import {SceneView} from './view/view.js' */
/** @import {Turned} from './view/force_arrows.js' */

/**
 * What became of a request.
 * @template [Value=unknown]
 * @typedef {{ok: true, value: Value, issues: Issue[]}|{ok: false, value?: undefined, issues: Issue[]}} Outcome
 */

/** @typedef {{quiet?: boolean}} AskOptions  quiet: issues are returned only */

/** @typedef {Omit<import('./protocol.js').JointOperation, 'kind'>} JointFields */

/**
 * @typedef {{link: string, force: Vec3, torque: Vec3, point?: Vec3|null, in_link_axes?: boolean}}
 *   ShownWrench
 */

/** @typedef {'newWorld'|'open'|'saveAs'|'cloneWorld'|'applyForce'|'hotkeys'|'about'|'plot'|'logs'|'joints'|'topics'|'recover'|'importFiles'|
 *            'building'|'modelEditor'|'saveModel'|'schematic'|'togglePanels'|'find'|'rename'|'array'|'commands'|'nextRegion'|'previousRegion'} DialogName */

/** @typedef {{name: DialogName, target?: string, entries?: Dropped[], place?: Vec3}} DialogRequest */

/** @typedef {ReturnType<typeof createActions>} Actions */

/**
 * What the parts of the actions share; `view` is null until the view is there.
 * @typedef {object} ActionParts
 * @property {Store} store
 * @property {Ask} ask
 * @property {(op: Operation, options?: AskOptions) => Promise<Outcome<Requests['edit']['reply']>>} edit
 * @property {(name: DialogName, fields?: Omit<DialogRequest, 'name'>) => void} dialog
 * @property {(message: string) => void} note
 * @property {() => SceneView|null} view
 */

/**
 * @typedef {<T extends keyof Requests>(type: T, fields?: Requests[T]['fields'], options?: AskOptions) =>
 *   Promise<Outcome<Requests[T]['reply']>>} Ask
 */

/** @param {{store: Store, connection: {request: RequestFunction}}} parts */
export function createActions({store, connection}) {
  /** Set by the view once it is there; without WebGL it never is. @type {SceneView|null} */
  let view = null;

  /**
   * @template {keyof Requests} T
   * @param {T} type
   * @param {Requests[T]['fields']} [fields]
   * @param {AskOptions} [options]
   * @returns {Promise<Outcome<Requests[T]['reply']>>}
   */
  async function ask(type, fields, {quiet = false} = {}) {
    try {
      return {ok: true, value: await connection.request(type, fields), issues: []};
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      if (!quiet) for (const issue of error.issues) store.addIssue(issue);
      return {ok: false, issues: error.issues};
    }
  }
  /**
   * @param {Operation} op
   * @param {AskOptions} [options]
   */
  const edit = (op, options) => ask('edit', {op}, options);
  /** @param {DialogName} name @param {Omit<DialogRequest, 'name'>} [fields] */
  const dialog = (name, fields = {}) => { store.emit('dialog', {name, ...fields}); };
  /** @param {string} message */
  const note = (message) => store.addIssue({severity: 'note', code: 'editor', message});

  /** @type {ActionParts} */
  const parts = {store, ask, edit, dialog, note, view: () => view};
  const files = fileActions(parts);
  const camera = cameraActions(parts);
  const inserts = insertActions(parts);
  const arrange = arrangeActions(parts);

  const actions = {
    /** @param {SceneView} theView */
    attachView(theView) { view = theView; },
    ask,
    edit,

    ...files,

    // ---- editing
    /** @param {number} [to]  steps more than one */
    undo: (to) => moveInHistory('undo', to),
    /** @param {number} [to]  steps more than one */
    redo: (to) => moveInHistory('redo', to),
    /** @returns {Promise<Outcome>} */
    remove(names = store.selection) {
      const parts = linkRemovals(edited(), names);
      if (parts.length) return edit(parts.length > 1 ? {kind: 'group', ops: parts, label: 'Remove links'} : parts[0]);
      const whole = [...new Set(names.map((name) => store.entity(name)?.model?.name ?? name))];
      return whole.length ? edit({kind: 'delete', names: whole}) : Promise.resolve(NOTHING);
    },
    /** @param {string} name @param {string} to */
    async rename(name, to) {
      const outcome = await edit({kind: 'rename', name, to});
      if (outcome.ok) store.select([to]);
      return outcome;
    },
    /**
     * @param {string} target  "" is the world
     * @param {string} path  e.g. "inertial.mass"
     * @param {unknown} value
     */
    setProperty: (target, path, value) => edit({kind: 'set', target, path, value}),
    /**
     * @param {Record<string, number[]>} poses  pose7 in the world by name
     * @param {string} [label]
     */
    move(poses, label) {
      const model = edited();
      const ops = model ? linkMoves(model, store.worldPose(model.name) ?? model.pose, poses) : [];
      if (ops.length) return edit({kind: 'group', ops, label: `Move ${Object.keys(poses).join(', ')}`});
      return edit({kind: 'move', poses, ...(label ? {label} : {})});
    },
    /** @param {string} name @param {Vec3} factors */
    scale: (name, factors) => edit({kind: 'scale', name, scale: factors}),
    /** @param {Operation[]} ops @param {string} label */
    group: (ops, label) => edit({kind: 'group', ops, label}),
    /** @param {'time'|'poses'|'world'} what */
    reset: (what) => edit({kind: 'reset', what}),
    resetPoses: () => edit({kind: 'reset', what: 'poses'}),
    resetWorld: () => edit({kind: 'reset', what: 'world'}),
    resetTime: () => edit({kind: 'reset', what: 'time'}),
    /** Copies models and lights (default: the selection). @returns {Promise<Outcome>} */
    async copy(names = store.selection) {
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
        op: (pose) => ({kind: 'paste', text, pose})});
    },

    ...inserts,
    ...arrange,

    // ---- modes
    /**
     * Esc: first what is being placed or followed, then the tool, then the selection.
     * @returns {void}
     */
    escape() {
      if (view?.cancelDrag()) return;
      if (store.placing) store.setPlacing(null);
      else if (store.camera.following) camera.follow(null);
      else if (store.mode !== 'select') store.setMode('select');
      else store.select([]);
    },
    selectMode: () => store.setMode('select'),
    translateMode: () => manipulate('translate'),
    rotateMode: () => manipulate('rotate'),
    scaleMode: () => manipulate('scale'),
    snapMode: () => store.setMode(store.mode === 'snap' ? 'select' : 'snap'),
    measureMode: () => store.setMode(store.mode === 'measure' ? 'select' : 'measure'),

    // ---- align
    /**
     * Shows where the models would go; `null` ends the preview.
     * @param {AlignChoice|null} choice
     */
    alignPreview(choice) {
      view?.setPreviewPoses(choice ? alignPoses(choice) : null);
    },
    /** @param {AlignChoice} choice @returns {Promise<Outcome>} */
    async align(choice) {
      view?.setPreviewPoses(null);
      const poses = alignPoses(choice);
      if (!view || !Object.keys(poses).length) return NOTHING;
      return view.carry(poses, edit({kind: 'move', poses, label: 'align'}));
    },

    ...camera,

    // ---- what is shown
    /**
     * @param {OverlayFlag} flag
     * @param {boolean|null} on
     * @param {string} [model]
     */
    setOverlay: (flag, on, model) => store.setOverlay(flag, on, model),
    /** @param {OverlayFlag} flag @param {string} [model] */
    toggleOverlay: (flag, model) => store.setOverlay(flag, !store.overlay(flag, model), model),
    /** @param {number} layer @param {boolean} shown */
    setLayer: (layer, shown) => store.setLayer(layer, shown),

    // ---- time
    play: () => whileRunning(() => ask('play')),
    pause: () => ask('pause'),
    togglePlay: () => whileRunning(() => ask(store.stats.paused ? 'play' : 'pause')),
    step: (steps = 1) => whileRunning(() => ask('step', {steps})),

    // ---- forces and joints
    /** @param {{link: string, force: number[], torque: number[], point?: number[],
     *           in_link_axes?: boolean, steps?: number}} wrench  N, N m */
    wrench: (wrench) => edit({kind: 'wrench', in_link_axes: false, steps: 1, ...wrench}),
    /**
     * Arrows for the force dialog; `null` takes them away.
     * @param {ShownWrench|null} wrench
     * @param {(turned: Turned) => void} [onTurned]
     */
    showForce: (wrench, onTurned) => view?.showForce(wrench, onTurned),
    /** @param {JointFields} fields */
    joint: (fields) => edit({kind: 'joint', ...fields}),

    // ---- pictures
    /** A PNG of the view; downloaded unless `download` is false. @returns {Promise<Blob|null>} */
    async screenshot({download = true} = {}) {
      if (!view) return null;
      const blob = await view.picture();
      if (blob && download) saveBlob(blob, `${store.document?.name ?? 'world'}-${timestamp()}.png`);
      return blob;
    },

    // ---- logs and plots
    /** @param {string[]} topics */
    watch: (topics) => ask('watch', {topics}),
    /** @param {string} [name] */
    logStart: (name) => ask('log_start', name ? {name} : {}),
    logStop: () => ask('log_stop'),
    logList: () => ask('log_list'),
    /** @param {string} name */
    logOpen: (name) => ask('log_open', {name}),
    /** @param {number} time */
    logSeek: (time) => ask('log_seek', {time}),
    logPlay: (rate = 1) => ask('log_play', {rate}),
    logClose: () => ask('log_close'),

    // ---- robots
    /**
     * Velocities for a robot, in its own axes; m/s, rad/s.
     * @param {string} model
     * @param {{linear: number[], angular: number[]}} velocity
     */
    async drive(model, {linear, angular}) {
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
    /** Opens the model editor, or leaves it. @param {string} [name]  of the model to edit */
    modelEditor: (name) => dialog('modelEditor', name ? {target: name} : {}),
    togglePanels: () => dialog('togglePanels'),
    find: () => dialog('find'),
    renameSelected: () => dialog('rename'),
    nextRegion: () => dialog('nextRegion'),
    previousRegion: () => dialog('previousRegion'),
    fullScreen() {
      if (document.fullscreenElement) return document.exitFullscreen();
      return document.documentElement.requestFullscreen();
    },
    /**
     * What of the preview (store.preview) is under a point of the page: {link} or null.
     * @param {number} clientX
     * @param {number} clientY
     */
    previewPick: (clientX, clientY) => view?.previewPick(clientX, clientY) ?? null,
  };

  /** The model that the model editor has. */
  function edited() {
    const name = store.modelEditing?.name;
    return name ? store.model(name) : undefined;
  }

  /**
   * Time stands still while a model is built.
   * @template T
   * @param {() => Promise<Outcome<T>>} run
   * @returns {Promise<Outcome<T|{}>>}
   */
  async function whileRunning(run) {
    if (!store.modelEditing) return run();
    note('Leave the model editor (Ctrl+M) to run the simulation.');
    return NOTHING;
  }

  /**
   * One history for everybody: whose edit it was is said.
   * @param {'undo'|'redo'} which
   * @param {number} [to]
   */
  async function moveInHistory(which, to) {
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

  /** @param {Mode} mode */
  function manipulate(mode) {
    if (store.camera.following) note('Not available while following a model; press Esc to stop following.');
    else store.setMode(mode);
  }

  /** @param {AlignChoice} choice */
  function alignPoses(choice) {
    const names = [...new Set(store.selection.flatMap((name) => store.split(name)[0]?.name ?? []))];
    const boxes = names.flatMap((name) => {
      const [pose, bounds] = [store.worldPose(name), view?.bounds(name)];
      return pose && bounds ? [{name, pose, ...bounds}] : [];
    });
    return alignMoves(boxes, choice);
  }

  return actions;
}

/**
 * A copy of a model or light; null of a link, or of nothing.
 * @param {EntityRef|null} entity
 * @returns {CopiedItem|null}
 */
function copyOf(entity) {
  if (entity?.kind === 'model') return {kind: 'model', document: structuredClone(entity.model)};
  if (entity?.kind === 'light') return {kind: 'light', document: structuredClone(entity.light)};
  return null;
}

/**
 * Lets the browser store a file.
 * @param {Blob} blob
 * @param {string} name
 */
export function saveBlob(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const timestamp = () => new Date().toISOString().slice(0, 19).replaceAll(':', '-');
