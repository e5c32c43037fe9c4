/**
 * Everything a user can do, as functions: menus, tool bar, keys and context menu call the same.
 *
 * Actions that ask the simulator resolve to `{ok, value, issues}` and never reject; what was
 * refused is also put into the store's issues, unless a dialog that shows it itself asks for `quiet`.
 */
import {alignMoves} from './align.js';
import {shapeModel, newLight, SHAPES, LIGHTS} from './new_entities.js';

/** @typedef {{ok: boolean, value?: any, issues: import('./connection.js').Issue[]}} Outcome */

/** @param {{store: import('./store.js').Store, connection: any}} parts */
export function createActions({store, connection}) {
  /** Set by the view once it is there; without WebGL it never is. */
  let view = null;

  /** @returns {Promise<Outcome>} */
  async function ask(type, fields = {}, {quiet = false} = {}) {
    try {
      return {ok: true, value: await connection.request(type, fields), issues: []};
    } catch (error) {
      if (!error.issues) throw error;
      if (!quiet) for (const issue of error.issues) store.addIssue(issue);
      return {ok: false, issues: error.issues};
    }
  }
  const edit = (op, options) => ask('edit', {op}, options);
  const dialog = (name, fields = {}) => store.emit('dialog', {name, ...fields});
  const note = (message) => store.addIssue({severity: 'note', code: 'editor', message});

  const actions = {
    attachView(theView) { view = theView; },
    ask,
    edit,

    // ---- files
    /** An empty world; asks first when there are unsaved changes and `discard` is not given. */
    newWorld: (options) =>
      options || !store.history.dirty ? ask('new', options ?? {}) : dialog('newWorld'),
    /** Opens a world; without a path asks which (a dialog). */
    open: (path, options = {}) =>
      path ? ask('open', {path, ...options}, {quiet: true}) : dialog('open'),
    /** Saves to the file of the world; asks for a name the first time. */
    async save() {
      if (!store.history.file) return actions.saveAs();
      const outcome = await ask('save', {}, {quiet: true});
      // A world that was launched from a file is not written over without a word.
      if (outcome.issues.some(({code}) => code === 'path-needed')) return actions.saveAs();
      outcome.issues.forEach((issue) => store.addIssue(issue));
      if (outcome.ok) note(`Saved ${outcome.value.path}`);
      return outcome;
    },
    saveAs: (path, options = {}) =>
      path ? ask('save', {path, ...options}, {quiet: true}) : dialog('saveAs'),
    folders: (path) => ask('folders', path ? {path} : {}),
    autosave: (action) => ask('autosave', {action}),

    // ---- editing
    undo: (to) => ask('undo', to === undefined ? {} : {to}),
    redo: (to) => ask('redo', to === undefined ? {} : {to}),
    remove(names = store.selection) {
      const whole = [...new Set(names.map((name) => store.entity(name)?.kind === 'link'
        ? store.entity(name).model.name : name))];
      return whole.length ? edit({kind: 'delete', names: whole}) : Promise.resolve(NOTHING);
    },
    async rename(name, to) {
      const outcome = await edit({kind: 'rename', name, to});
      if (outcome.ok) store.select([to]);
      return outcome;
    },
    /** @param {string} target  "" is the world @param {string} path  e.g. "inertial.mass" */
    setProperty: (target, path, value) => edit({kind: 'set', target, path, value}),
    /** @param {Record<string, number[]>} poses  pose7 in the world by name */
    move: (poses, label) => edit({kind: 'move', poses, ...(label ? {label} : {})}),
    scale: (name, factors) => edit({kind: 'scale', name, scale: factors}),
    group: (ops, label) => edit({kind: 'group', ops, label}),
    reset: (what) => edit({kind: 'reset', what}),
    resetPoses: () => actions.reset('poses'),
    resetWorld: () => actions.reset('world'),
    resetTime: () => actions.reset('time'),
    /** Copies models and lights (default: what is selected). */
    async copy(names = store.selection) {
      const wanted = names.filter((name) => ['model', 'light'].includes(store.entity(name)?.kind));
      if (!wanted.length) return NOTHING;
      const outcome = await ask('copy', {names: wanted});
      if (!outcome.ok) return outcome;
      store.setClipboard({
        text: outcome.value.text,
        items: wanted.map((name) => {
          const {kind, model, light} = store.entity(name);
          const document = structuredClone(model ?? light);
          document.pose = store.worldPose(name);
          return {kind, document};
        }),
      });
      return outcome;
    },
    /** Lets what was copied follow the mouse. */
    paste() {
      const {text, items} = store.clipboard ?? {};
      if (!text) return;
      const last = items[items.length - 1];
      store.setPlacing({
        kind: last.kind, document: last.document, items, keepHeight: true,
        op: (pose) => ({kind: 'paste', text, pose}),
      });
    },

    // ---- adding
    /** @param {'box'|'sphere'|'cylinder'} shape */
    insertShape(shape) {
      if (!SHAPES.includes(shape)) throw new RangeError(`no shape ${shape}`);
      store.setPlacing({
        kind: 'model', document: shapeModel(shape), shape,
        op: (pose) => ({kind: 'insert', shape, pose}),
      });
    },
    /** @param {'point'|'spot'|'directional'} type */
    insertLight(type) {
      if (!LIGHTS.includes(type)) throw new RangeError(`no light ${type}`);
      const light = newLight(type, store.document?.lights.map((one) => one.name) ?? []);
      store.setPlacing({
        kind: 'light', document: light,
        op: (pose) => ({kind: 'insert_light', light: {...light, pose}}),
      });
    },
    /** Fetches a model of the library, from afar when need be; it then follows the mouse. */
    async insertModel(uri) {
      const outcome = await ask('library_get', {uri});
      if (!outcome.ok) return outcome;
      const {model, light} = outcome.value;
      store.setPlacing({
        kind: model ? 'model' : 'light', document: model ?? light, uri,
        op: (pose) => ({kind: 'insert', uri, pose}),
      });
      return outcome;
    },
    /** Puts down what follows the mouse. @param {number[]} pose  pose7 in the world */
    async place(pose) {
      const {placing} = store;
      if (!placing) return NOTHING;
      store.setPlacing(null);
      const outcome = await edit(placing.op(pose));
      const {name, names} = outcome.value ?? {};
      if (outcome.ok && (names ?? name)) store.select(names ?? [name]);
      return outcome;
    },
    library: () => ask('library'),
    libraryAdd: (path) => ask('library_add', {path}),

    // ---- modes
    /** Esc: first what is being placed or followed, then the tool, then the selection. */
    escape() {
      if (view?.cancelDrag()) return;
      if (store.placing) store.setPlacing(null);
      else if (store.camera.following) actions.follow(null);
      else if (store.mode !== 'select') store.setMode('select');
      else store.select([]);
    },
    selectMode: () => store.setMode('select'),
    translateMode: () => manipulate('translate'),
    rotateMode: () => manipulate('rotate'),
    scaleMode: () => manipulate('scale'),
    snapMode: () => store.setMode(store.mode === 'snap' ? 'select' : 'snap'),
    selectAll: () => store.select(store.document?.models.map((model) => model.name) ?? []),

    // ---- align
    /** Shows where the models would go; `null` ends the preview. */
    alignPreview(choice) {
      view?.setPreviewPoses(choice ? alignPoses(choice) : null);
    },
    /**
     * @param {{axis: 'x'|'y'|'z', at: 'min'|'center'|'max', reverse?: boolean,
     *          relative?: 'first'|'last'}} choice
     */
    async align(choice) {
      view?.setPreviewPoses(null);
      const poses = alignPoses(choice);
      if (!Object.keys(poses).length) return NOTHING;
      return view.carry(poses, actions.move(poses, 'align'));
    },

    // ---- camera
    /** @param {'top'|'bottom'|'front'|'back'|'left'|'right'|'home'} side */
    viewFrom: (side) => view?.viewFrom(side),
    resetView: () => view?.viewFrom('home'),
    moveTo: (name = store.selection.at(-1)) => name && view?.moveTo(name),
    /** @param {string|null} name  null ends it */
    follow(name = store.selection.at(-1) ?? null) {
      if (name) store.setMode('select');
      store.setCamera({following: name});
    },
    setProjection: (projection) => store.setCamera({projection}),
    setController: (controller) => store.setCamera({controller}),
    perspective: () => actions.setProjection('perspective'),
    orthographic: () => actions.setProjection('orthographic'),
    orbitControl: () => actions.setController('orbit'),
    fpsControl: () => actions.setController('fps'),

    // ---- what is shown
    setOverlay: (flag, on, model) => store.setOverlay(flag, on, model),
    toggleOverlay: (flag, model) => store.setOverlay(flag, !store.overlay(flag, model), model),
    setLayer: (layer, shown) => store.setLayer(layer, shown),

    // ---- time
    play: () => ask('play'),
    pause: () => ask('pause'),
    togglePlay: () => store.stats.paused ? actions.play() : actions.pause(),
    step: (steps = 1) => ask('step', {steps}),

    // ---- forces and joints
    /** @param {{link: string, force: number[], torque: number[], point?: number[],
     *           in_link_axes?: boolean, steps?: number}} wrench  N, N m */
    wrench: (wrench) => edit({kind: 'wrench', in_link_axes: false, steps: 1, ...wrench}),
    /** Arrows for the force dialog; `null` takes them away. */
    showForce: (wrench, onTurned) => view?.showForce(wrench, onTurned),
    joint: (fields) => edit({kind: 'joint', ...fields}),

    // ---- pictures
    /** A PNG of the view; downloaded unless `download` is false. @returns {Promise<Blob>} */
    async screenshot({download = true} = {}) {
      if (!view) return null;
      const blob = await view.picture();
      if (download) saveBlob(blob, `${store.document?.name ?? 'world'}-${timestamp()}.png`);
      return blob;
    },

    // ---- logs and plots
    watch: (topics) => ask('watch', {topics}),
    logStart: (name) => ask('log_start', name ? {name} : {}),
    logStop: () => ask('log_stop'),
    logList: () => ask('log_list'),
    logOpen: (name) => ask('log_open', {name}),
    logSeek: (time) => ask('log_seek', {time}),
    logPlay: (rate = 1) => ask('log_play', {rate}),
    logClose: () => ask('log_close'),

    // ---- windows of the panels
    applyForce: (name = store.selection.at(-1)) => dialog('applyForce', {target: name}),
    hotkeys: () => dialog('hotkeys'),
    about: () => dialog('about'),
    plot: () => dialog('plot'),
    logs: () => dialog('logs'),
    joints: () => dialog('joints'),
    building: () => dialog('building'),
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
    previewPick: (clientX, clientY) => view?.previewPick(clientX, clientY) ?? null,
  };

  function manipulate(mode) {
    if (store.camera.following) note('Not while the camera follows a model; Esc ends that.');
    else store.setMode(mode);
  }

  function alignPoses(choice) {
    const names = [...new Set(store.selection.flatMap((name) => store.split(name)[0]?.name ?? []))];
    const boxes = names.map((name) => ({name, pose: store.worldPose(name), ...view?.bounds(name)}));
    return alignMoves(boxes.filter((box) => box.min), choice);
  }

  return actions;
}

const NOTHING = Object.freeze({ok: true, value: null, issues: []});

/** Lets the browser store a file. */
export function saveBlob(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const timestamp = () => new Date().toISOString().slice(0, 19).replaceAll(':', '-');
