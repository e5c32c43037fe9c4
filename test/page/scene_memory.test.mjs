import assert from 'node:assert/strict';
import {test} from 'node:test';
import {newLight} from '../../web/js/new_entities.js';
import {Store} from '../../web/js/store.js';
import {world} from './scene.mjs';
import {elementsWhere, installPlainDom} from './plain_dom.mjs';
import './with_plain_three.mjs';

installPlainDom();
const {Group, Scene} = await import('three');
const {Surroundings} = await import('../../web/js/view/environment.js');
const {label} = await import('../../web/js/view/label_sprite.js');
const {Lights} = await import('../../web/js/view/light_views.js');
const {empty, segments, triad} = await import('../../web/js/view/markers.js');
const {Overlays} = await import('../../web/js/view/overlays.js');

/** Returns a store, a stage with a scene, and functions that send a world and its changes. */
function begun() {
  const store = new Store();
  const scene = new Scene();
  const stage = {scene, invalidate() {}, shadowsChanged() {}};
  const start = (fields = {}) => store.receive({type: 'world', revision: 1,
    document: {...world(), scene: {ambient: [1, 1, 1, 1], background: [1, 1, 1, 1]}, ...fields}});
  const change = (revision, fields) => store.receive({type: 'change', revision, ...fields});
  return {store, stage, start, change};
}

/** All geometries below an object that belong to one thing alone. */
const ownOf = (root) => elementsWhere(root, ({geometry}) => geometry?.userData.single)
  .map(({geometry}) => geometry);
const freed = (geometries) => geometries.map(({disposed}) => disposed);

test('icons of lights are freed when lights change', () => {
  const {store, stage, start, change} = begun();
  new Lights({stage, store});
  start();
  const before = ownOf(stage.scene);
  assert.equal(before.length, 1);
  change(2, {lights: {lamp: {...newLight('spot', []), name: 'lamp'}}});
  assert.deepEqual([freed(before), freed(ownOf(stage.scene))], [[1], [0]]);
});

test('marks of links are freed when they are drawn anew', () => {
  const {store, stage, start, change} = begun();
  const models = {bounds: () => null, shownPose: () => null, linkMatrix: () => null};
  new Overlays({store, models, stage, stock: {}, watches: {add: () => () => {}}});
  start();
  for (const flag of ['frames', 'com']) store.setOverlay(flag, true, 'a');
  const before = ownOf(stage.scene);
  assert.equal(before.length, 2);
  change(2, {models: {a: world().models[0]}});
  assert.deepEqual([freed(before), freed(ownOf(stage.scene))], [[1, 1], [0, 0]]);
});

test('roads are laid once for a world, and freed with it', () => {
  const {store, stage, start, change} = begun();
  new Surroundings({stage, store, materials: {get: () => null, setDistance() {}}});
  const roads = [{name: 'r', width: 2, points: [[0, 0, 0], [10, 0, 0]], material: null}];
  start({roads});
  const laid = ownOf(stage.scene);
  assert.equal(laid.length, 1);
  change(2, {world: {gravity: [0, 0, -1]}});
  assert.deepEqual(ownOf(stage.scene), laid);
  start();
  assert.deepEqual(freed(laid), [1]);
});

test('what is taken out of a group is freed, and what others share is not', () => {
  const group = new Group().add(segments([[0, 0, 0], [1, 0, 0]], null), triad(1));
  const own = ownOf(group);
  empty(group);
  assert.deepEqual([group.children.length, freed(own)], [0, [1, 1]]);
});

test('of many labels the ones that were not used for longest are freed', () => {
  const first = label('first').material;
  const used = label('used').material;
  for (let count = 0; count < 299; count++) {
    label(`${count}`);
    label('used');
  }
  assert.deepEqual([first.disposed, first.map.disposed, used.disposed], [1, 1, 0]);
});
