import assert from 'node:assert/strict';
import {test} from 'node:test';
import {arrayOffsets, clearSpacing, distributeMoves} from '../../web/js/arrange.js';
import {groupAround, groupsOf, withGroups} from '../../web/js/model_groups.js';
import {commandsOf, matching} from '../../web/js/panels/dialogs/command_dialog.js';
import {near} from './near.mjs';
import {requestFault} from './protocol.mjs';
import {actionsPage} from './scene.mjs';

const box = (name, x, size) => ({name, pose: [x, 0, 0.5, 0, 0, 0, 1],
  min: [x - size / 2, -0.5, 0], max: [x + size / 2, 0.5, 1]});

test('an array has a place for each cell but the original', () => {
  assert.deepEqual(arrayOffsets([2, 2, 1], [1, 3, 5]), [[1, 0, 0], [0, 3, 0], [1, 3, 0]]);
  assert.deepEqual(arrayOffsets([1, 1, 1], [1, 1, 1]), []);
  assert.deepEqual(arrayOffsets([1, 1, 3], [1, 1, 0.5]), [[0, 0, 0.5], [0, 0, 1]]);
});

test('copies are as far apart as the selection is wide, and a little', () => {
  near(clearSpacing([box('a', 0, 1), box('b', 2, 2)]), [3.6, 1.1, 1.1]);
  near(clearSpacing([{min: [-50, -50, 0], max: [50, 50, 0]}]), [10.1, 10.1, 0.1]);
  near(clearSpacing([]), [1, 1, 1]);
});

test('distributed models have equal gaps between boxes of different sizes', () => {
  const boxes = [box('right', 10, 2), box('left', 0, 1), box('small', 1, 0.5), box('large', 2, 3)];
  const moves = distributeMoves(boxes, 'x');
  assert.deepEqual(Object.keys(moves), ['small', 'large']);
  // From 0.5 to 9 there are 8.5 m, of which the two in between take 3.5 m.
  near(moves.small.slice(0, 3), [0.5 + 5 / 3 + 0.25, 0, 0.5]);
  near(moves.large.slice(0, 3), [9 - 5 / 3 - 1.5, 0, 0.5]);
  assert.deepEqual(distributeMoves(boxes.slice(0, 2), 'x'), {});
  assert.deepEqual(distributeMoves([box('a', 0, 1), box('b', 2, 1), box('c', 4, 1)], 'x'), {});
});

test('duplicating and arrays are one step, and what has come is selected', async () => {
  const {connection, store, actions} = actionsPage({copy: {text: '<sdf/>'}});
  store.select(['lamp', 'a']);
  connection.answers.edit = {names: ['a_clone', 'lamp_clone']};
  await actions.duplicate();
  const [copy, edit] = connection.requests;
  assert.deepEqual(copy, ['copy', {names: ['a', 'lamp']}]);
  assert.equal(requestFault(...edit), null);
  assert.equal(edit[1].op.label, 'Duplicate a, lamp');
  assert.deepEqual(store.selection, ['a_clone', 'lamp_clone']);
  store.select(['a']);
  await actions.array([3, 2, 1], [1, 2, 0]);
  const [, {op}] = connection.requests.at(-1);
  const [x, y] = store.worldPose('a');
  const [{kind, poses}, ...others] = op.ops;
  assert.deepEqual([kind, others], ['paste', []]);
  near(poses.map((pose) => pose[0] - x), [1, 2, 0, 1, 2]);
  near(poses.map((pose) => pose[1] - y), [0, 0, 2, 2, 2]);
  assert.throws(() => actions.array([100, 100, 1], [1, 1, 1]), RangeError);
});

test('links of the edited model are copied beside themselves; others are not', async () => {
  const {connection, store, actions} = actionsPage({copy: {text: '<sdf/>'}});
  store.select(['a::link']);
  await actions.duplicate();
  assert.deepEqual(connection.requests, []);
  store.setModelEditing({name: 'a'});
  connection.answers.edit = {names: ['a::link_clone']};
  await actions.duplicate();
  const [[kind, {op}]] = connection.requests;
  assert.equal(requestFault(kind, {op}), null);
  assert.equal(op.ops[0].kind, 'copy_link');
  const [x, y] = store.worldPose('a::link');
  near(op.ops[0].pose.slice(0, 2), [x + 1, y]);
  assert.deepEqual(store.selection, ['a::link_clone']);
});

test('hidden and locked models are left out of what all means', () => {
  const {store, actions} = actionsPage({copy: {text: '<sdf/>'}});
  const names = store.document.models.map(({name}) => name);
  actions.selectAll();
  assert.deepEqual(store.selection, names);
  actions.hide(['a']);
  assert.ok(!store.selection.includes('a'));
  actions.selectAll();
  assert.ok(!store.selection.includes('a'));
  actions.showHidden();
  store.select(['a']);
  actions.lock();
  actions.selectAll();
  assert.ok(!store.selection.includes('a'));
  actions.lock(['a']);
  actions.selectAll();
  assert.deepEqual(store.selection, names);
});

test('the command search knows menus, tools and keys, each once', () => {
  const {store, actions} = actionsPage({copy: {text: '<sdf/>'}});
  const theme = {get: () => 'auto', set: () => {}};
  const commands = commandsOf({store, actions, theme, topics: {sensing: false}, notices: {}});
  const titles = commands.map(({title}) => title);
  for (const title of ['Screenshot', 'Grid', 'Insert box', 'Insert spot light', 'Translate', 'Hotkey Chart']) {
    assert.equal(titles.filter((one) => one === title).length, 1, title);
  }
  assert.ok(!titles.includes('Duplicate'), 'nothing is selected');
  assert.equal(matching(commands, 'spot ins')[0].title, 'Insert spot light');
  assert.equal(matching(commands, 'pl')[0].title, 'Plot');
  const undo = {title: 'Undo: Insert unit_box', group: 'Edit', keys: '', run() {}};
  assert.equal(matching([undo, ...commands], 'box')[0].title, 'Insert box');
  assert.equal(matching([undo, ...commands], 'undo')[0], undo);
  assert.deepEqual(matching(commands, 'no such thing'), []);
});

test('groups name their models, and a name stands for its group', () => {
  const {store} = actionsPage({copy: {text: '<sdf/>'}});
  const models = [['a', 'shelf'], ['b', ''], ['c', 'shelf']].map(([name, group]) => ({...store.model('a'), name, group}));
  assert.deepEqual([...groupsOf(models)], [['shelf', ['a', 'c']]]);
  assert.deepEqual(withGroups(models, ['b', 'a', 'lamp']), ['b', 'a', 'c', 'lamp']);
  assert.deepEqual(groupAround(models, 'a'), ['c', 'a']);
});

test('lights are members of groups, are hidden and locked with them', async () => {
  const {connection, store, actions} = actionsPage({copy: {text: '<sdf/>'}});
  const [name] = store.document.lights.map((one) => one.name);
  store.select(['a', name]);
  await actions.groupSelection();
  assert.deepEqual(connection.requests.at(-1), ['edit', {op: {kind: 'set_group', names: ['a', name]}}]);
  actions.lock();
  assert.ok(store.overlay('locked', name) && store.overlay('locked', 'a'));
  actions.unlockAll();
  assert.ok(!store.overlay('locked', name));
  actions.hide();
  assert.ok(store.overlay('hidden', name));
  assert.deepEqual(store.selection, []);
  store.receive({type: 'change', revision: 9, lights: {[name]: null}});
  assert.ok(!store.overlay('hidden', name), 'the next light of the name is shown');
});

test('grouping asks for a new group, ungrouping for all models of the groups', async () => {
  const {connection, store, actions} = actionsPage({copy: {text: '<sdf/>'}});
  store.select(['a']);
  await actions.groupSelection();
  assert.deepEqual(connection.requests, []);
  store.select(['b', 'a']);
  await actions.groupSelection();
  assert.deepEqual(connection.requests.at(-1), ['edit', {op: {kind: 'set_group', names: ['b', 'a']}}]);
  assert.equal(requestFault(...connection.requests.at(-1)), null);
  for (const model of store.document.models) model.group = 'shelf';
  store.select(['a']);
  await actions.ungroupSelection();
  assert.deepEqual(connection.requests.at(-1), ['edit', {op: {kind: 'set_group', names: ['a', 'b'], group: ''}}]);
});
