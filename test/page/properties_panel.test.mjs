import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Properties} from '../../web/js/panels/properties_panel.js';
import {Store} from '../../web/js/store.js';
import {box} from './fake_simulator.mjs';
import {near} from './near.mjs';
import {elementsWhere, installPlainDom, typeInto} from './plain_dom.mjs';

const make = installPlainDom();

/** A box whose link has an id. */
function boxAt(name, id, x, inertial = {}) {
  const made = box(name, [x, 0, 0.5, 0, 0, 0, 1]);
  const [link] = made.links;
  return {...made, links: [{...link, id, inertial: {...link.inertial, ...inertial}}]};
}

/** A panel over a world of two boxes, with what it asked for. */
function panelOf() {
  const store = new Store();
  const edits = [];
  const request = async (_, {op}) => {
    edits.push(op);
    return {};
  };
  const panel = new Properties(make('div'), {store, request});
  store.receive({type: 'world', revision: 1, document: {name: 'w', lights: [], roads: [],
    plugins: [], scene: {}, models: [boxAt('a', 0, 0), boxAt('b', 1, 5)]}});
  const inputs = (path) => elementsWhere(panel.element, ({dataset}) => dataset?.path === path)
    .flatMap((field) => elementsWhere(field, ({tag}) => tag === 'input'));
  return {store, panel, edits, inputs};
}

const rowOf = (name) => ({id: `model:${name}`, kind: 'model', model: name, name, select: name});

test('a typed mass scales the inertia that the link has now', () => {
  const {store, panel, edits, inputs} = panelOf();
  store.select(['a']);
  panel.row = rowOf('a');
  panel.refresh();
  store.receive({type: 'change', revision: 2, models: {a: boxAt('a', 0, 0, {ixx: 42})}});
  typeInto(inputs('mass')[0], '2');
  const [{ops: [op]}] = edits;
  assert.equal(op.value.ixx, 84);
});

test('a pose typed for several models leaves the rest where it is now', () => {
  const {store, panel, edits, inputs} = panelOf();
  store.select(['a', 'b']);
  panel.row = rowOf('b');
  panel.refresh();
  store.poses.get(0).set([30, 0, 0.5, 0, 0, 0, 1]);
  store.poses.get(1).set([35, 7, 0.5, 0, 0, 0, 1]);
  panel.refresh();
  typeInto(inputs('pose')[2], '2');
  const [{ops: [{poses}]}] = edits;
  near(poses.a, [30, 0, 2, 0, 0, 0, 1]);
  near(poses.b, [35, 7, 2, 0, 0, 0, 1]);
});
