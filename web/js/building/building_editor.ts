/** The building editor: a plan beside the 3D view. */
import {ask, faultText} from '../ui/dialog.js';
import {byId, fill, h, onceAFrame} from '../ui/dom.js';
import {mountMenuBar} from '../ui/menubar.js';
import {styled} from '../ui/stylesheet.js';
import {Canvas} from './plan_canvas.js';
import {forgetDraft, keepDraft, leftDraft} from './unsaved_plan.js';
import {MeasureTool} from './draw_tools.js';
import {Files, importImage} from './building_files.js';
import {listenToKeys, listenToMouse, listenToView} from './input_events.js';
import {inspectItem, inspectLevel, inspectRoof} from './inspector.js';
import {dropLevel, mountLevels, newLevel} from './level_bar.js';
import {mountPalette} from './palette.js';
import {planCursor} from './plan_cursor.js';
import {Preview, placingOps} from './building_preview.js';
import {mountScrollbars} from './scrollbars.js';
import {SelectTool} from './select_tool.js';
import {Session} from './drawing_session.js';
import {isEmpty, withoutImages} from './plan.js';
import type {Actions} from '../actions.js';
import type {Fault} from './plan_check.js';
import type {Plan} from '../protocol.js';
import type {Pose7} from '../pose.js';
import type {RequestFunction} from '../connection.js';
import type {Store} from '../store.js';
import type {Draft} from './unsaved_plan.js';

/** The model of a building that was opened, at its pose as drawn. */
type OpenedModel = {name: string, pose: Pose7, plan: Plan};

export interface FileCommands {
  save: () => Promise<boolean>;
  saveAs: () => Promise<boolean>;
  open: () => Promise<unknown>;
  /** an empty plan */
  fresh: () => Promise<unknown>;
}

/**
 * Opens the building editor in an element; time stands still meanwhile.
 * @returns `close` asks first, and
 * answers false when the user stays; leaving by the editor's own menu emits `exit` on the element
 */
export async function mount(element: HTMLElement, {store, request, actions}: {store: Store,
    request: RequestFunction, actions: Actions}): Promise<{close: () => Promise<boolean>,
    session: Session, canvas: Canvas}> {
  await styled('building.css');
  const session = new Session();
  const draft = leftDraft();
  session.endTool = () => { session.tool = new SelectTool(session); };
  const canvas = new Canvas(session);
  const files = new Files(session, request);
  const sheet = h('div', {class: 'building-sheet'}, canvas.element);
  const hint = h('div', {class: 'building-hint', role: 'status'});
  const faults = h('ul', {class: 'building-faults', 'aria-label': 'Plan errors'});
  const scale = h('div', {class: 'building-scale'}, h('span'));
  const palette = h('div', {class: 'building-palette'});
  const levels = h('div', {class: 'building-levels', role: 'toolbar', 'aria-label': 'Levels'});
  const menu = h('nav', {class: 'building-menu', 'aria-label': 'Building menu'});
  const done = h('button', {class: 'primary', text: 'Done', onclick: () => leave(),
    title: 'Put the building into the world and leave the building editor (Ctrl+X)'});
  sheet.append(hint, faults, scale);
  fill(element, h('div', {class: 'building-editor'}, h('div', {class: 'building-head'}, menu, levels, done),
    palette, sheet));

  const scrolled = mountScrollbars(sheet, {session, canvas});
  let issues: Fault[] = [];
  const draw = () => {
    canvas.draw();
    hint.textContent = session.hint;
    showFaults(faults, session, issues);
    scrolled();
  };
  const drawSoon = onceAFrame(() => element.contains(canvas.element) && draw());
  canvas.onplace = () => {
    showScale(scale, canvas.view.zoom);
    scrolled();
  };
  const unlisten = session.listen('change', drawSoon);
  session.endTool();

  /** The world's model of the opened building, or null. `place` replaces it if its plan has changed. */
  let opened: OpenedModel|null = null;
  const open = async (load: () => Promise<boolean>) => {
    if (!await load()) return;
    canvas.fit();
    opened = session.file ? await modelOf(session, store, request) : null;
    if (opened) actions.setOverlay('transparent', true, opened.name);
    canvas.showAround(actions.footprints(opened?.name));
  };
  const importPlan = () => importImage(session, (done) => {
    session.tool = new MeasureTool(session, (drawn) => {
      session.endTool();
      done(drawn);
    });
  });
  const leave = async () => {
    if (await close()) element.dispatchEvent(new CustomEvent('exit'));
  };
  const opening = {...bound(files), open: () => open(() => files.open()), fresh: () => open(() => files.fresh())};
  mountMenuBar(menu, menus(session, opening, {importPlan, leave}));
  mountLevels(levels, {session, canvas});
  mountPalette(palette, {session, importPlan, draw: () => canvas.element.focus()});
  listenToMouse({session, canvas, draw: drawSoon});
  const preview = new Preview({store, session, request, onIssues: (found) => { issues = found; drawSoon(); }});
  const around = onceAFrame(() => canvas.showAround(actions.footprints(opened?.name)));
  around();
  const ended = new AbortController();
  const {signal} = ended;
  listenToKeys(element, {session, files: opening, exit: leave, draw: drawSoon, cursor: planCursor({session, canvas}), signal});
  listenToView(byId('view'), {session, actions, signal});
  window.addEventListener('beforeunload', (event) => { if (session.dirty) event.preventDefault(); }, {signal});
  const ends = [
    ...(['document', 'entity', 'poses'] as const).map((event) => store.listen(event, around)),
    () => ended.abort(), () => preview.end(), watchSize(sheet, canvas), unlisten,
  ];
  const wasRunning = !store.stats.paused;
  if (wasRunning) await actions.pause();
  canvas.fit();
  canvas.element.focus();
  let left = false;
  // Kept from the answer on: until then the earlier draft is the only one there is.
  let restored = false;
  const offered = draft
    ? open(async () => { restored = await offer(files, draft); return restored; })
    : Promise.resolve();
  offered.then(() => { if (!left) ends.push(keepDraft(session, restored ? draft : null)); });

  let closing: Promise<boolean>|null = null;
  const close = () => closing ??= finish().finally(() => { closing = null; });

  async function finish() {
    const how = await files.leave();
    if (how === 'cancel') return false;
    if (how === 'saved' && !await place()) return false;
    left = true;
    for (const end of ends.splice(0)) end();
    if (opened) actions.setOverlay('transparent', false, opened.name);
    element.replaceChildren();
    if (wasRunning) await actions.play();
    return true;
  }

  /** Shows the inside of the new house as soon as it is there. */
  function lookAt(name: string) {
    if (store.model(name)) {
      actions.lookInto(name);
      return;
    }
    const end = store.listen('entity', ({detail}) => {
      if (detail.name !== name) return;
      end();
      actions.lookInto(name);
    });
  }

  /** Inserts the saved plan into the world, unless the world already holds this plan. */
  async function place() {
    const plan = session.history.saved;
    if (isEmpty(plan) || (opened && opened.plan === plan && store.model(opened.name))) return true;
    try {
      const building = await request('building_sdf', {plan: withoutImages(plan)});
      const ops = placingOps(store, building, opened);
      await request('edit', {op: {kind: 'group', ops, label: `Insert building ${plan.name}`}});
      lookAt(building.model.name);
      return true;
    } catch (fault) {
      session.say(`The building was saved, but could not be added to the world: ${faultText(fault)}`);
      return false;
    }
  }

  return {close, session, canvas};
}

const bound = (files: Files) => ({
  save: () => files.save(), saveAs: () => files.saveAs(), open: () => files.open(),
  fresh: () => files.fresh(),
});

/**
 * Offers what an earlier page left unsaved; without an answer it is offered again the next time.
 * @returns whether it was restored
 */
async function offer(files: Files, draft: Draft): Promise<boolean> {
  const answer = await ask('Restore unsaved building?', `The building ${draft.plan.name} has unsaved changes from an earlier session or another tab.`,
    [{title: 'Discard', value: 'drop', danger: true},
      {title: 'Restore', value: 'restore', primary: true, run: () => files.restore(draft)}]);
  if (answer === 'drop') forgetDraft(draft.by);
  return answer === 'restore';
}

/** The model of an opened building: {name, pose as drawn, plan}, null where the world has none. */
async function modelOf(session: Session, store: Store, request: RequestFunction) {
  // A restored draft differs from what the world was given.
  const plan = session.history.saved;
  try {
    const {model} = await request('building_sdf', {plan: withoutImages(plan), text: false});
    return store.model(model.name) ? {name: model.name, pose: model.pose, plan} : null;
  } catch (fault) {
    session.say(faultText(fault));
    return null;
  }
}

function menus(session: Session, files: FileCommands, {importPlan, leave}: {importPlan: () => void,
    leave: () => void}) {
  const item = (title: string, keys: string, run: () => void, more = {}) =>
      ({title, keys, run, ...more});
  return [
    {title: 'File', items: () => [
      item('New', 'Alt+N', files.fresh), item('Open', 'Ctrl+O', files.open),
      item('Save', 'Ctrl+S', files.save), item('Save As', 'Ctrl+Shift+S', files.saveAs),
      item('Exit Building Editor', 'Ctrl+X', leave)]},
    {title: 'Edit', items: () => [
      item(`Undo ${session.history.undoLabel ?? ''}`, 'Ctrl+Z', () => session.undo(),
        {enabled: () => session.history.undoLabel !== null}),
      item(`Redo ${session.history.redoLabel ?? ''}`, 'Ctrl+Y', () => session.redo(),
        {enabled: () => session.history.redoLabel !== null}),
      item('Copy', 'Ctrl+C', () => session.copy(), {enabled: () => session.selection.length > 0}),
      item('Paste', 'Ctrl+V', () => session.paste(), {enabled: () => session.clipboard.length > 0}),
      item('Delete', 'Delete', () => session.removeSelected(), {enabled: () => session.selection.length > 0}),
      item('Select All', 'Ctrl+A', () => session.selectAll()),
      item('Inspector', 'double-click', () => inspectItem(session, session.selection[0]),
        {enabled: () => session.selection.length === 1})]},
    {title: 'Building', items: () => [
      item('Add Level', '', () => newLevel(session)), item('Delete Level', '', () => dropLevel(session)),
      item('Level Inspector', '', () => inspectLevel(session)), item('Roof', '', () => inspectRoof(session)),
      item('Import Floor Plan', '', importPlan)]},
  ];
}

function showFaults(element: HTMLElement, session: Session, issues: Fault[]) {
  const own = session.faults();
  const told = own.length ? own : issues;
  const rows = told.slice(0, 4).map((fault) => h('li', {
    class: fault.severity, text: fault.message,
    onclick: () => {
      if (fault.at === undefined) return;
      session.showLevel(fault.at);
      session.select(fault.refs ?? []);
    },
  }));
  if (told.length > 4) rows.push(h('li', {text: `and ${told.length - 4} more`}));
  fill(element, ...rows);
}

/** A bar as long as a round number of metres. */
function showScale(element: HTMLElement, zoom: number) {
  const round = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50].find((value) => value * 100 * zoom >= 60) ?? 100;
  element.style.width = `${round * 100 * zoom}px`;
  if (element.firstChild) element.firstChild.textContent = `${round} m`;
}

function watchSize(sheet: HTMLElement, canvas: Canvas) {
  const observer = new ResizeObserver(() => canvas.place());
  observer.observe(sheet);
  return () => observer.disconnect();
}
