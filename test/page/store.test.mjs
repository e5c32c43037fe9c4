import assert from 'node:assert/strict';
import {test} from 'node:test';
import {decodeFrame} from '../../web/js/pose_frames.js';
import {Store} from '../../web/js/store.js';
import {protocol} from './protocol.mjs';
import {near} from './near.mjs';
import {frameOf, model, world} from './scene.mjs';

function opened() {
  const store = new Store();
  store.receive({type: 'world', revision: 1, document: world()});
  return store;
}

function heard(store, type) {
  const details = [];
  store.addEventListener(type, (event) => details.push(event.detail));
  return details;
}

test('a frame is read as the protocol lays it out', () => {
  assert.equal(protocol.frames.head_bytes, 40);
  assert.equal(protocol.frames.record_bytes, 32);
  const frame = decodeFrame(frameOf([[5, [1, 2, 3, 0, 0, 0, 1]], [6, [4, 5, 6, 0, 1, 0, 0]]]));
  assert.deepEqual([frame.revision, frame.step, frame.simTime, frame.realTime, frame.count],
    [7, 1234, 1.25, 2.5, 2]);
  const pose = new Array(7);
  frame.read(1, pose);
  assert.equal(frame.id(1), 6);
  assert.deepEqual(pose, [4, 5, 6, 0, 1, 0, 0]);
});

test('a frame that is cut short is refused, one of an unknown kind is left', () => {
  assert.throws(() => decodeFrame(frameOf([[5, [1, 2, 3, 0, 0, 0, 1]]], {length: 60})), RangeError);
  assert.equal(decodeFrame(frameOf([], {kind: 9})), null);
});

test('a frame moves only the links it names', () => {
  const store = opened();
  const moved = heard(store, 'poses');
  store.receiveFrame(frameOf([[2, [9, 0, 1, 0, 0, 0, 1]]]));
  near(store.worldPose('b'), [9, 0, 1, 0, 0, 0, 1], 1e-6);
  near(store.worldPose('a'), [0, 0, 0.5, 0, 0, 0, 1]);
  assert.deepEqual([...moved[0]], [2]);
});

test('a model is where its first link carries it', () => {
  const store = opened();
  const linked = model('c', 3, [1, 1, 0, 0, 0, 0, 1]);
  linked.links[0].pose = [0, 0, 2, 0, 0, 0, 1];
  store.receive({type: 'change', revision: 2, models: {c: linked}});
  near(store.worldPose('c::link'), [1, 1, 2, 0, 0, 0, 1]);
  store.receiveFrame(frameOf([[3, [5, 1, 2, 0, 0, 0, 1]]]));
  near(store.worldPose('c'), [5, 1, 0, 0, 0, 0, 1]);
});

test('models that go have left the selection before others hear of each', () => {
  const store = opened();
  store.select(['a', 'b']);
  const selected = [];
  store.listen('entity', () => selected.push([...store.selection]));
  store.receive({type: 'change', revision: 2, models: {a: null, b: null}});
  assert.deepEqual(selected, [[], []]);
});

test('a model that goes leaves the selection and its poses', () => {
  const store = opened();
  store.select(['a', 'b']);
  const selections = heard(store, 'selection');
  store.receive({type: 'change', revision: 2, models: {a: null}});
  assert.deepEqual(store.selection, ['b']);
  assert.equal(selections.length, 1);
  assert.equal(store.poses.has(1), false);
  assert.equal(store.worldPose('a'), null);
});

test('a model that is changed keeps the pose that frames gave it', () => {
  const store = opened();
  store.receiveFrame(frameOf([[1, [7, 0, 0.5, 0, 0, 0, 1]]]));
  store.receive({type: 'change', revision: 2, models: {a: model('a', 1, [0, 0, 0.5, 0, 0, 0, 1])}});
  near(store.worldPose('a'), [7, 0, 0.5, 0, 0, 0, 1], 1e-6);
});

test('an id that goes to another model of the same change keeps a pose', () => {
  const store = opened();
  const [first] = store.document.models;
  const [{id}] = first.links;
  const other = {...structuredClone(first), name: 'other', pose: [7, 8, 9, 0, 0, 0, 1]};
  for (const models of [{other, [first.name]: null}, {[first.name]: first, other: null}]) {
    store.receive({type: 'change', revision: 2, models});
    const name = models.other ? 'other' : first.name;
    assert.equal(store.poses.has(id), true);
    assert.deepEqual(store.document.models.map((one) => one.name).filter((one) => one === 'other' || one === first.name), [name]);
    assert.equal(store.model(name), models[name]);
  }
});

test('an order that comes along is taken over', () => {
  const store = opened();
  store.receive({type: 'change', revision: 2, order: ['b', 'a', 'lamp']});
  assert.deepEqual(store.document.models.map(({name}) => name), ['b', 'a']);
});

test('names mean models, lights, and links of the longest model name', () => {
  const store = opened();
  const nested = model('a::inner', 4, [0, 0, 0, 0, 0, 0, 1]);
  store.receive({type: 'change', revision: 2, models: {'a::inner': nested}});
  assert.equal(store.entity('a').kind, 'model');
  assert.equal(store.entity('lamp').kind, 'light');
  assert.equal(store.entity('a::inner::link').model.name, 'a::inner');
  assert.equal(store.entity('a::link').model.name, 'a');
  assert.equal(store.entity('nobody'), null);
});

test('choosing adds, takes away and keeps the order', () => {
  const store = opened();
  store.select(['a']);
  store.select(['b'], {toggle: true});
  assert.deepEqual(store.selection, ['a', 'b']);
  store.select(['a'], {toggle: true});
  assert.deepEqual(store.selection, ['b']);
  store.select(['a'], {add: true});
  assert.deepEqual(store.selection, ['b', 'a']);
});

test('a model\'s own view flag overrides the scene\'s until it is taken back', () => {
  const store = opened();
  store.setOverlay('wireframe', true);
  store.setOverlay('wireframe', false, 'a');
  assert.equal(store.overlay('wireframe', 'a'), false);
  assert.equal(store.overlay('wireframe', 'b'), true);
  store.setOverlay('wireframe', null, 'a');
  assert.equal(store.overlay('wireframe', 'a'), true);
});

test('another tool ends placing', () => {
  const store = opened();
  store.setPlacing({kind: 'model', document: model('g', 9, [0, 0, 0, 0, 0, 0, 1])});
  assert.equal(store.mode, 'insert');
  store.setMode('rotate');
  assert.equal(store.placing, null);
});

test('what is shown of a model goes with its name, and not to the next one of it', () => {
  const store = new Store();
  const start = (file) =>
    store.receive({type: 'world', revision: 1, document: {...world(), file}});
  const shown = () => ['a', 'c'].map((name) => store.overlay('transparent', name));
  const pose = [0, 0, 0, 0, 0, 0, 1];
  start('one.world');
  store.setOverlay('transparent', true, 'a');
  store.receive({type: 'change', revision: 2, models: {a: null, c: model('c', 7, pose)}});
  assert.deepEqual(shown(), [false, true]);
  store.receive({type: 'change', revision: 3, models: {a: model('a', 8, pose)}});
  assert.deepEqual(shown(), [false, true]);
  start('one.world');  // as after a log
  assert.deepEqual(shown(), [false, true]);
  start('two.world');
  store.setOverlay('transparent', true, 'a');
  assert.deepEqual(shown(), [true, false]);
  start('three.world');
  assert.deepEqual(shown(), [false, false]);
});
