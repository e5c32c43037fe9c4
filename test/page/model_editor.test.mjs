import assert from 'node:assert/strict';
import {test} from 'node:test';
import {
  axesOf, axisOr, connection, isLinkOf, jointText, JOINT_TYPES, linkMoves, linkRemovals, pluginText,
  renamedModel, resizing, sizeOf, stepsSince,
} from '../../web/js/model_edits.js';
import {ModelEditor} from '../../web/js/model_editor/model_editor.js';
import {BOX, schematicOf} from '../../web/js/model_editor/schematic_layout.js';
import {pluginFor, PLUGIN_TITLES} from '../../web/js/model_editor/plugin_templates.js';
import {SOLID_SHAPES, solidModel} from '../../web/js/model_editor/solids.js';
import {scaledLoops} from '../../web/js/model_editor/svg_outline.js';
import {near} from './near.mjs';
import {actionsPage, model, world} from './scene.mjs';

const turned = [2, 1, 0, 0, 0, Math.SQRT1_2, Math.SQRT1_2];

test('a link dragged in the world is described in the frame of its model', () => {
  const [op] = linkMoves(model('a', 1, turned), turned, {'a::link': [2, 2, 0.5, ...turned.slice(3)]});
  assert.deepEqual([op.kind, op.target, op.path], ['set', 'a::link', 'pose']);
  near(op.value, [1, 0, 0.5, 0, 0, 0, 1], 1e-9);
});

test('models and links of other models are not moved as links', () => {
  assert.deepEqual(linkMoves(model('a', 1, turned), turned, {a: turned, 'b::link': turned}), []);
});

test('links of the edited model are removed one by one', () => {
  assert.deepEqual(linkRemovals(model('a', 1, turned), ['a::link', 'a', 'b::link']),
    [{kind: 'remove_part', target: 'a::link'}]);
  assert.deepEqual(linkRemovals(undefined, ['a::link']), []);
  assert.equal(isLinkOf(model('a', 1, turned), 'a::nix'), false);
});

test('two clicks make a joint', () => {
  assert.deepEqual(connection('m', 'revolute', 'base', 'tip'),
    {kind: 'add_joint', model: 'm', joint: {type: 'revolute', parent: 'base', child: 'tip'}});
});

test('each type of joint has its axes', () => {
  assert.deepEqual(JOINT_TYPES.map(axesOf), [1, 2, 1, 0, 2, 1, 2, 0]);
  assert.equal(axisOr(null).upper, 1e16);
  assert.equal(axisOr({...axisOr(null), upper: 2}).upper, 2);
});

test('joints and plugins are shown as text', () => {
  assert.equal(jointText({name: 'j', type: 'ball', parent: 'a', child: 'b'}), 'a → b: ball');
  assert.equal(pluginText({plugins: [{xml: '<plugin/>\n'}, {xml: '<plugin name="b"/>'}]}),
    '<plugin/>\n<plugin name="b"/>');
});

test('steps are counted from where the editor was opened, however long the history is', () => {
  for (const [depth, undoable, mark, steps] of [
    [3, 3, 1, 2], [0, 0, 1, 0], [260, 260, 250, 10], [510, 500, 505, 5], [900, 500, 100, 500],
  ]) assert.equal(stepsSince({depth, undoable}, mark), steps);
});

test('ghosts of links stand on the ground', () => {
  for (const shape of SOLID_SHAPES) {
    const {pose, links} = solidModel(shape);
    assert.equal(links[0].visuals[0].geometry.type, shape);
    assert.ok(pose[2] > 0);
  }
});

test('a shape of the tool bar becomes a link while a model is built', async () => {
  const {connection, store, actions} = actionsPage();
  connection.answers.edit = {name: 'untitled::link_0'};
  store.setModelEditing({name: null});
  actions.insertShape('box');
  await actions.place([1, 2, 0.5, 0, 0, 0, 1]);
  assert.deepEqual(connection.requests.at(-1)[1].op,
    {kind: 'add_link', model: null, shape: 'box', pose: [1, 2, 0.5, 0, 0, 0, 1]});
  assert.deepEqual(store.modelEditing, {name: 'untitled'});
  assert.deepEqual(store.selection, ['untitled::link_0']);
});

test('time stands still while a model is built', async () => {
  const {connection, store, actions} = actionsPage();
  store.setModelEditing({name: 'a'});
  await actions.togglePlay();
  assert.equal(connection.requests.length, 0);
  assert.match(store.issues.at(-1).message, /Ctrl\+M/);
});

test('Delete takes the chosen link of the edited model, not the model', async () => {
  const {connection, store, actions} = actionsPage();
  store.setModelEditing({name: 'a'});
  store.select(['a::link']);
  await actions.remove();
  assert.deepEqual(connection.requests.at(-1)[1].op, {kind: 'remove_part', target: 'a::link'});
});

/** A model editor whose history has since got steps, the newest first; '' is the user's own. */
function editorAfter(undoBy) {
  const {connection, store, actions} = actionsPage();
  const said = [];
  const editor = new ModelEditor({store, actions, request: null, notices: {say: (text) => said.push(text)}});
  store.receive({type: 'history', undo: undoBy.map(() => 'a step'), undo_by: undoBy, redo: [],
    redo_by: [], undoable: undoBy.length, depth: undoBy.length, state: undoBy.length,
    dirty: true, file: ''});
  return {editor, connection, said};
}

test('the steps of a model that is discarded are undone, and none before them', async () => {
  for (const [undoBy, fields] of [[[''], {}], [['', ''], {to: 1}], [['', '', 'Ann'], {to: 1}]]) {
    const {editor, connection} = editorAfter(undoBy);
    assert.equal(await editor.discard(), true);
    assert.deepEqual(connection.requests, [['undo', fields]]);
  }
});

test('what others did after a step is not undone with it', async () => {
  const {editor, connection, said} = editorAfter(['Ann', '', 'Ann', '']);
  assert.equal(await editor.discard(), false);
  assert.deepEqual(connection.requests, []);
  assert.match(said[0], /Ann edited/);
});

test('what others did to the world is no change of the model', async () => {
  const {editor, connection} = editorAfter(['Ann', 'Ann']);
  assert.equal(editor.dirty, false);
  assert.equal(await editor.discard(), true);
  assert.deepEqual(connection.requests, []);
  assert.equal(editorAfter(['Ann', '']).editor.dirty, true);
});

test('a model that got another name is known by its links, also where nobody selected it', () => {
  const [a, b, c] = ['a', 'b', 'c'].map((name, n) => model(name, n + 1));
  const links = a.links.map(({name}) => name).join();
  assert.equal(renamedModel([b, {...a, name: 'new'}], links, new Set(['a', 'b'])).name, 'new');
  assert.equal(renamedModel([b, c], links, new Set(['a', 'b', 'c'])), undefined);
});

/** A tool that connects links of a model of two, at its first question. */
function connecting() {
  const {connection, store, actions} = actionsPage();
  const one = model('m', 7, turned);
  const two = {...one, links: ['l', 'k'].map((name, at) => ({...one.links[0], name, id: 7 + at}))};
  store.receive({type: 'world', revision: 2, document: {...world(), models: [two]}});
  store.setModelEditing({name: 'm'});
  const editor = new ModelEditor({store, actions, request: null, notices: {say() {}}});
  connection.answers.edit = {name: 'm::joint'};
  store.select(['m::l']);
  editor.connect.listen();
  editor.connect.toggle();
  return {store, connect: editor.connect, joints: () => connection.requests
    .filter(([type]) => type === 'edit').map(([, {op}]) => [op.joint.parent, op.joint.child])};
}

test('links are connected by selecting them in the tree, also the one that was selected', async () => {
  const {store, joints, connect} = connecting();
  store.select(['m::l']);
  assert.equal(connect.parent, 'l');
  store.select(['m::k']);
  assert.deepEqual(joints(), [['l', 'k']]);
  assert.equal(connect.active, false);
});

test('a second click on the parent connects the link behind it', async () => {
  const {store, joints} = connecting();
  const under = ['l', 'k'].map((link) => ({model: 'm', link}));
  store.emit('pick', [{model: 'other', link: 'x'}, ...under]);
  store.emit('pick', under);
  assert.deepEqual(joints(), [['l', 'k']]);
});

test('a size is for the collision and the shapes like it, and the inertia follows', () => {
  const rod = {type: 'cylinder', radius: 0.5, length: 1};
  const link = {collisions: [{name: 'c', geometry: rod}], visuals: [{name: 'v', geometry: {...rod}},
    {name: 'lamp', geometry: {type: 'sphere', radius: 0.5}}]};
  const size = sizeOf(link);
  assert.deepEqual(size.map(({label, value}) => [label, value]), [['Radius', 0.5], ['Length', 1]]);
  const {ops} = resizing('m::l', link, size.map((one) => ({...one, value: 2 * one.value})));
  assert.deepEqual(ops.map(({target, path, value}) => [target, path, value]), [
    ['m::l::collision:c', 'geometry.radius', 1], ['m::l::collision:c', 'geometry.length', 2],
    ['m::l::visual:v', 'geometry.radius', 1], ['m::l::visual:v', 'geometry.length', 2],
    ['m::l', undefined, undefined]]);
  assert.deepEqual(ops.at(-1), {kind: 'compute_inertial', target: 'm::l', density: null});
  assert.deepEqual(sizeOf({collisions: [{geometry: {type: 'mesh'}}]}), []);
  assert.deepEqual(sizeOf({collisions: []}), []);
});

test('the schematic has a row for each joint above a link', () => {
  const links = ['base', 'arm', 'tool', 'loose'].map((name) => ({name}));
  const joints = [['world', 'base'], ['base', 'arm'], ['arm', 'tool'], ['base', 'tool']].map(([parent, child]) =>
    ({name: `${parent}_${child}`, type: 'revolute', parent, child}));
  const {links: placed, edges, width, height} = schematicOf({links, joints});
  const at = Object.fromEntries(placed.map(({name, x, y}) => [name, [x, y]]));
  const rows = (...names) => names.map((name) => (at[name][1] - BOX.margin) / (BOX.height + BOX.down));
  assert.deepEqual(rows('world', 'loose', 'base', 'arm', 'tool'), [0, 0, 1, 2, 2]);
  assert.equal(edges.length, 4);
  assert.ok(placed.every(({x, y}) => x >= 0 && y >= 0 && x + BOX.width <= width && y + BOX.height <= height));
  const loop = schematicOf({links: links.slice(0, 2), joints: [{name: 'a', parent: 'base', child: 'arm'},
    {name: 'b', parent: 'arm', child: 'base'}]});
  assert.deepEqual(loop.links.map(({name}) => name), ['base', 'arm']);
});

test('outlines of a drawing get a width in metres, y up, the largest first', () => {
  const square = (x, y, size) => [[x, y], [x + size, y], [x + size, y + size], [x, y + size], [x, y]];
  const [outer, hole] = scaledLoops([square(4, 2, 2), square(0, 0, 10)], 1);
  assert.deepEqual(outer, [[-0.5, 0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]]);
  near(hole.flat(), [-0.1, 0.3, 0.1, 0.3, 0.1, 0.1, -0.1, 0.1]);
  assert.throws(() => scaledLoops([[[0, 0], [1, 0]]], 1), /no closed outline/);
  const many = Array.from({length: 3000}, (_, at) => [Math.cos(at / 477) * 100, Math.sin(at / 477) * 100]);
  assert.throws(() => scaledLoops([many], 1), /3000 corners/);
});

test('a drive plugin is filled in with the wheels of a cart', () => {
  const link = (name, y, radius) => ({name, pose: [0, y, 0.5, 0, 0, 0, 1],
    collisions: radius ? [{geometry: {type: 'cylinder', radius, length: 0.2}}] : []});
  const joint = (child, type = 'revolute') => ({name: `${child}_joint`, type, parent: 'body', child,
    pose: [0, 0, 0, 0, 0, 0, 1], axis: {xyz: [0, 1, 0]}});
  const cart = {name: 'cart', links: [link('body', 0), link('r', -0.6, 0.5), link('l', 0.6, 0.5), link('arm', 0.3)],
    joints: [joint('r'), joint('l'), joint('arm', 'prismatic')]};
  const drive = pluginFor('differential drive', cart, '');
  for (const wanted of ['<leftJoint>l_joint<', '<rightJoint>r_joint<', '<wheelSeparation>1.2<', '<wheelDiameter>1<',
    '<robotBaseFrame>body<']) assert.ok(drive.includes(wanted), wanted);
  assert.match(pluginFor('differential drive', cart, drive), /name="drive_0"/);
  assert.doesNotMatch(drive, /backwards/);
  cart.joints[0].axis.xyz = [0, -1, 0];
  assert.match(pluginFor('differential drive', cart, ''), /r_joint: the axis points to the right/);
  assert.doesNotMatch(pluginFor('joint states', cart, ''), /backwards/);
  assert.match(pluginFor('skid steer drive', cart, ''), /<leftRearJoint>LEFT_REAR_JOINT</);
  assert.match(pluginFor('joint states', cart, ''), /<jointName>r_joint, l_joint, arm_joint</);
  for (const title of PLUGIN_TITLES) assert.match(pluginFor(title, {name: 'm', links: [], joints: []}, ''), /^<plugin /);
});
