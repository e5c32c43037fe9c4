// Saving and opening buildings, and the draft that is kept of what is unsaved, without a page.
import assert from 'node:assert/strict';
import test from 'node:test';

import {installPlainDom} from './plain_dom.mjs';

installPlainDom();
const {Files} = await import('../../web/js/building/building_files.js');
const {Session} = await import('../../web/js/building/drawing_session.js');
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
