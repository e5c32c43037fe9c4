import assert from 'node:assert/strict';
import {test} from 'node:test';
import {RequestError} from '../../web/js/connection.js';
import {HOTKEYS, hotkey, spelled} from '../../web/js/hotkeys.js';
import {requestFault} from './protocol.mjs';
import {actionsPage} from './scene.mjs';

const ORIGIN = [0, 0, 0, 0, 0, 0, 1];

/** Does everything that asks the simulator, once. */
async function everything({actions, store, connection}) {
  connection.answers.copy = {text: '<sdf/>'};
  connection.answers.library_get = {model: store.model('a')};
  connection.answers.edit = {name: 'b'};
  store.select(['a']);
  await actions.newWorld({discard: true});
  await actions.open('/w/a.world', {discard: true});
  await actions.saveAs('/w/a.world', {overwrite: true});
  await actions.folders();
  await actions.folders('/w');
  await actions.autosave('restore');
  await actions.recoverable();
  await actions.recoverEntry('1-2');
  await actions.undo();
  await actions.redo(2);
  await actions.rename('a', 'c');
  await actions.setProperty('a::link', 'inertial.mass', 3);
  await actions.move({a: ORIGIN}, 'align');
  await actions.scale('a', [1, 2, 3]);
  await actions.resetPoses();
  await actions.resetWorld();
  await actions.resetTime();
  await actions.copy(['a', 'lamp']);
  actions.paste();
  await actions.place(ORIGIN);
  actions.insertShape('sphere');
  await actions.place(ORIGIN);
  actions.insertLight('spot');
  await actions.place(ORIGIN);
  await actions.insertModel('model://table');
  await actions.place(ORIGIN);
  await actions.library();
  await actions.libraryAdd('/models');
  await actions.play();
  await actions.pause();
  await actions.step(5);
  await actions.wrench({link: 'a::link', force: [0, 0, 1], torque: [0, 0, 0]});
  await actions.joint({joint: 'a::hinge', mode: 'velocity', value: 1});
  await actions.watch(['contacts']);
  await actions.drive('a', {linear: [1, 0, 0], angular: [0, 0, 0]});
  await actions.logStart();
  await actions.logStop();
  await actions.logList();
  await actions.logOpen('x');
  await actions.logSeek(1.5);
  await actions.logPlay(2);
  await actions.logClose();
  await actions.group([{kind: 'delete', names: ['a']}], 'clear');
  await actions.remove(['b::link']);
}

test('everything the page asks is in the protocol', async () => {
  const parts = actionsPage();
  await everything(parts);
  assert.ok(parts.connection.requests.length > 35);
  for (const [type, fields] of parts.connection.requests) {
    assert.equal(requestFault(type, fields), null);
  }
});

test('the check of the protocol finds what is wrong', () => {
  assert.match(requestFault('step', {steps: 1.5}), /steps/);
  assert.match(requestFault('step', {}), /steps/);
  assert.match(requestFault('edit', {op: {kind: 'move', poses: {a: [1, 2]}}}), /in place of 7/);
  assert.match(requestFault('edit', {op: {kind: 'explode'}}), /explode/);
  assert.match(requestFault('play', {fast: true}), /unknown/);
});

test('a link that is deleted takes its model along', async () => {
  const {actions, connection} = actionsPage();
  await actions.remove(['a::link', 'a']);
  assert.deepEqual(connection.requests[0][1].op, {kind: 'delete', names: ['a']});
});

test('what is refused becomes an issue, and the action says so', async () => {
  const {actions, connection, store} = actionsPage();
  const issue = {severity: 'error', code: 'taken', message: 'the name is taken'};
  connection.answers.edit = new RequestError([issue]);
  const outcome = await actions.rename('a', 'b');
  assert.equal(outcome.ok, false);
  assert.deepEqual(store.issues, [issue]);
});

test('nothing to undo is a note, and other refusals are errors', async () => {
  const {actions, connection, store} = actionsPage();
  const refused = (message) => new RequestError([{severity: 'error', code: 'unusable', message}]);
  connection.answers.undo = refused('nothing to undo');
  assert.equal((await actions.undo()).ok, false);
  connection.answers.redo = refused('nothing to redo');
  await actions.redo();
  connection.answers.undo = refused("cannot undo 'Insert a': no model");
  await actions.undo();
  assert.deepEqual(store.issues.map(({severity, message}) => [severity, message]), [
    ['note', 'There is nothing to undo.'], ['note', 'There is nothing to redo.'],
    ['error', "cannot undo 'Insert a': no model"]]);
});

test('saving asks for a name only when the world has none', async () => {
  const {actions, connection, store} = actionsPage();
  const dialogs = [];
  store.addEventListener('dialog', ({detail}) => dialogs.push(detail.name));
  await actions.save();
  assert.deepEqual(dialogs, ['saveAs']);
  store.receive({type: 'history', undo: [], redo: [], dirty: true, file: '/w/a.world'});
  await actions.save();
  assert.equal(connection.requests.at(-1)[0], 'save');
});

test('a new world is not made over unsaved changes', async () => {
  const {actions, connection, store} = actionsPage();
  store.receive({type: 'history', undo: ['move [a]'], redo: [], dirty: true, file: ''});
  await actions.newWorld();
  assert.equal(connection.requests.length, 0);
});

test('what is placed is selected', async () => {
  const {actions, connection, store} = actionsPage();
  connection.answers.edit = {name: 'b'};
  actions.insertShape('box');
  assert.equal(store.mode, 'insert');
  await actions.place(ORIGIN);
  assert.deepEqual(store.selection, ['b']);
  assert.equal(store.mode, 'select');
});

test('Esc undoes one thing at a time', () => {
  const {actions, store} = actionsPage();
  store.select(['a']);
  actions.translateMode();
  actions.insertShape('box');
  actions.escape();
  assert.equal(store.placing, null);
  actions.translateMode();
  actions.escape();
  assert.deepEqual([store.mode, store.selection], ['select', ['a']]);
  actions.escape();
  assert.deepEqual(store.selection, []);
});

test('a followed model keeps its handles away', () => {
  const {actions, store} = actionsPage();
  actions.follow('a');
  actions.translateMode();
  assert.equal(store.mode, 'select');
  actions.escape();
  assert.equal(store.camera.following, null);
});

test('every hotkey has an action, and no two are the same', () => {
  const {actions} = actionsPage();
  const seen = new Set();
  for (const {keys, action} of HOTKEYS.filter((row) => row.action)) {
    assert.equal(typeof actions[action], 'function', keys);
    assert.ok(!seen.has(keys), keys);
    seen.add(keys);
  }
});

test('keys are spelled as in the table', () => {
  assert.equal(spelled({key: 'z', ctrlKey: true, shiftKey: true}), 'Ctrl+Shift+Z');
  assert.equal(hotkey({key: ' '}).action, 'togglePlay');
  assert.equal(hotkey({key: 's'}).action, 'scaleMode');
  assert.equal(hotkey({key: 's', ctrlKey: true}).action, 'save');
  assert.equal(hotkey({key: 'j'}), undefined);
});
