// Saving and opening buildings, and the draft that is kept of what is unsaved, without a page.
import assert from 'node:assert/strict';
import test from 'node:test';

import {installPlainDom} from './plain_dom.mjs';

installPlainDom();
const storage = new Map();
let leavePage = () => {};
globalThis.localStorage = {
  getItem: (key) => storage.get(key) ?? null, setItem: (key, value) => storage.set(key, value)};
globalThis.window = {
  addEventListener: (_, listener) => { leavePage = listener; }, removeEventListener() {}};
const forgetDrafts = () => storage.clear();
const {Files} = await import('../../web/js/building/building_files.js');
const {Session} = await import('../../web/js/building/drawing_session.js');
const {forgetDraft, keepDraft, leftDraft} = await import('../../web/js/building/unsaved_plan.js');
const plans = await import('../../web/js/building/plan.js');

const HOME = '/home/u/building_editor_models';
const ABOUT = {version: '2.0', description: 'A house', author: 'Ada', email: 'ada@example.org'};

function addWall(session, y) {
  const {plan} = plans.add(session.history.plan, session.at, 'walls', {start: [0, y], end: [4, y]});
  session.commit(plan, 'add wall');
}

const wallsOf = (plan) => plan.levels[0].walls.length;

/** Files whose server holds one building, and what they asked of it. */
function filesWith({path = `${HOME}/House`, plan = plans.emptyPlan('House'), whileSaving = () => {}} = {}) {
  const session = new Session();
  const asked = [];
  const files = new Files(session, async (kind, fields) => {
    asked.push({kind, ...fields});
    if (kind === 'building_load') return {plan, path, issues: [], about: ABOUT};
    whileSaving(session);
    return {path: `${fields.options.folder ?? HOME}/${fields.name.replaceAll(' ', '_')}`, issues: []};
  });
  return {files, session, asked};
}

test('what is drawn while the building is saved stays unsaved', async () => {
  const {files, session, asked} = filesWith({whileSaving: (drawing) => addWall(drawing, 2)});
  await files.load('House');
  addWall(session, 1);
  assert.equal(await files.save(), true);
  assert.equal(wallsOf(asked.at(-1).plan), 1);
  assert.equal(wallsOf(session.history.plan), 2);
  assert.equal(wallsOf(session.history.saved), 1);
  assert.equal(session.dirty, true);
});

test('saving under the old name of the building keeps what is drawn meanwhile', async () => {
  const {files, session} = filesWith({whileSaving: (drawing) => addWall(drawing, 2)});
  await files.load('House');
  session.commit({...session.history.plan, name: 'Villa'}, 'rename building');
  await files.save();
  assert.equal(session.history.plan.name, 'House');
  assert.equal(wallsOf(session.history.plan), 1);
  assert.equal(session.dirty, true);
});

test('a building that is saved undisturbed has no unsaved changes', async () => {
  const {files, session} = filesWith();
  await files.load('House');
  addWall(session, 1);
  await files.save();
  assert.equal(session.dirty, false);
  assert.equal(session.file.path, `${HOME}/House`);
});

test('saving a building whose folder is not named after it replaces no other building', async () => {
  const {files, session, asked} = filesWith({path: `${HOME}/House2`});
  let questions = 0;
  files.saveAs = async () => { questions += 1; return false; };
  await files.load(`${HOME}/House2`);
  addWall(session, 1);
  assert.equal(await files.save(), false);
  assert.equal(questions, 1);
  assert.deepEqual(asked.map(({kind}) => kind), ['building_load']);
});

test('saving goes to the folder that was opened, also under a name with spaces', async () => {
  const {files, session, asked} = filesWith({path: '/ws/models/Two_rooms', plan: plans.emptyPlan('Two rooms')});
  await files.load('/ws/models/Two_rooms');
  addWall(session, 1);
  assert.equal(await files.save(), true);
  assert.deepEqual(asked.at(-1).options, {...ABOUT, folder: '/ws/models', overwrite: true});
  assert.equal(session.file.path, '/ws/models/Two_rooms');
  await files.save();
  assert.equal(asked.at(-1).kind, 'building_save');
});

const SCAN = {file: 'floor_plan_1.png', resolution: 50, data: 'data:image/png;base64,AAAA'};

/** A saved building with a picture. */
function withScan() {
  const plan = plans.emptyPlan('House');
  return {...plan, levels: [{...plan.levels[0], image: SCAN}]};
}

test('a restored draft is saved to its own folder, with author and pictures', async () => {
  const saved = {path: '/ws/models/House', plan: withScan()};
  const before = filesWith(saved);
  keepDraft(before.session);
  await before.files.load('/ws/models/House');
  addWall(before.session, 1);
  leavePage();
  assert.equal([...storage.values()].join('').includes('base64'), false);

  const {files, session, asked} = filesWith(saved);
  await files.restore(leftDraft());
  assert.equal(session.dirty, true);
  assert.deepEqual(session.level.image, SCAN);
  assert.equal(await files.save(), true);
  assert.deepEqual(asked.at(-1).options, {...ABOUT, folder: '/ws/models', overwrite: true});
  assert.equal(wallsOf(asked.at(-1).plan), 1);
  assert.deepEqual(asked.at(-1).plan.levels[0].image, SCAN);
  forgetDrafts();
});

test('a picture that was not saved is told missing when the draft is restored', async () => {
  const before = filesWith();
  keepDraft(before.session);
  before.session.commit(withScan(), 'import floor plan');
  leavePage();
  const {files, session} = filesWith();
  await files.restore(leftDraft());
  assert.equal(session.level.image, null);
  assert.match(session.hint, /floor plan of Level 1 again/);
  forgetDrafts();
});

test('a draft whose building cannot be opened asks where it is saved', async () => {
  const before = filesWith();
  keepDraft(before.session);
  await before.files.load('House');
  addWall(before.session, 1);
  leavePage();
  const session = new Session();
  const files = new Files(session, async () => { throw new Error('it was removed'); });
  await files.restore(leftDraft());
  assert.equal(wallsOf(session.history.plan), 1);
  assert.equal(session.file, null);
  assert.match(session.hint, /House cannot be opened: it was removed/);
  forgetDrafts();
});

test('a session that draws nothing forgets no draft of an earlier one', () => {
  const before = new Session();
  keepDraft(before);
  addWall(before, 1);
  leavePage();
  const session = new Session();
  const stop = keepDraft(session);
  session.commit({...session.history.plan}, 'edit');
  session.undo();
  leavePage();
  stop();
  assert.equal(wallsOf(leftDraft().plan), 1);
  forgetDrafts();
});

test('a draft is forgotten when its plan is saved', async () => {
  const {files, session} = filesWith();
  keepDraft(session);
  await files.load('House');
  addWall(session, 1);
  leavePage();
  assert.equal(wallsOf(leftDraft().plan), 1);
  await files.save();
  leavePage();
  assert.equal(leftDraft(), null);
});

/** A session of another tab with so many walls, which was left. */
function leftTab(walls) {
  const session = new Session();
  const stop = keepDraft(session);
  for (let y = 1; y <= walls; y += 1) addWall(session, y);
  const leave = leavePage;
  leave();
  return {session, stop, leave};
}

test('two tabs that draw keep a draft each', () => {
  const first = leftTab(1);
  const second = leftTab(2);
  assert.equal(wallsOf(leftDraft().plan), 2);
  second.stop();
  assert.equal(wallsOf(leftDraft().plan), 1);
  addWall(first.session, 9);
  first.leave();
  assert.equal(wallsOf(leftDraft().plan), 2);
  first.stop();
  assert.equal(leftDraft(), null);
});

test('a draft that is discarded leaves that of another tab', () => {
  leftTab(1);
  leftTab(2);
  forgetDraft(leftDraft().by);
  assert.equal(wallsOf(leftDraft().plan), 1);
  forgetDrafts();
});

test('a restored draft is kept as that of the session which goes on with it', async () => {
  leftTab(1);
  const draft = leftDraft();
  const {files, session} = filesWith();
  await files.restore(draft);
  const stop = keepDraft(session, draft);
  assert.equal(wallsOf(leftDraft().plan), 1);
  stop();
  assert.equal(leftDraft(), null);
});

test('of the drafts that nobody restores the newest are kept', () => {
  for (let number = 0; number < 30; number += 1) leftTab(1);
  leftTab(2);
  const kept = JSON.parse([...storage.values()][0]);
  assert.equal(kept.length, 10);
  assert.equal(wallsOf(kept.at(-1).plan), 2);
  forgetDrafts();
});

test('the draft of a page that knew of one only is found', () => {
  leftTab(1);
  const [{by, ...draft}] = JSON.parse([...storage.values()][0]);
  storage.set('world-editor.building-draft', JSON.stringify(draft));
  assert.equal(wallsOf(leftDraft().plan), 1);
  forgetDraft(leftDraft().by);
  assert.equal(leftDraft(), null);
  assert.ok(by);
});
