import assert from 'node:assert/strict';
import {test} from 'node:test';
import {JointsPanel} from '../../web/js/panels/joints_panel.js';
import {Store} from '../../web/js/store.js';
import {box} from './fake_simulator.mjs';
import {elementsWhere, installPlainDom, typeInto} from './plain_dom.mjs';

const make = installPlainDom();
const OLD = {mode: 'velocity', value: 1, gains: {p: 5, i: 1, d: 0}};

/** The panel of a model with a hinge that is driven, and what it asked for. */
function drivenHinge() {
  const store = new Store();
  const edits = [];
  const page = {store, watches: {add: () => () => {}}, actions: {
    edit: async (op) => {
      edits.push(op);
      return {ok: true, issues: []};
    }}};
  const element = make('div');
  const panel = new JointsPanel(element, page);
  store.receive({type: 'world', revision: 1, document: {name: 'w', lights: [], roads: [],
    plugins: [], scene: {}, models: [{...box('gate'), joints: [
      {name: 'hinge', type: 'revolute', axis: {xyz: [0, 0, 1]}}]}]}});
  store.select(['gate']);
  panel.show(true);
  const [tab] = elementsWhere(element, ({dataset}) => dataset?.mode === 'velocity');
  tab.dispatchEvent(new Event('click'));
  const push = (drive) => store.receive({type: 'watch', topic: 'joints:gate', time: 0, joints: [
    {name: 'hinge', axis: 0, position: 0, rate: 0, drive}]});
  const [, , p, i] = elementsWhere(element, ({tag}) => tag === 'input');  // degrees and rate first
  return {push, p, i, edits};
}

const settled = () => new Promise((done) => setTimeout(done));

test('a push of before an edit that arrives after its reply does not undo it', async () => {
  const {push, p, i, edits} = drivenHinge();
  push(OLD);
  typeInto(p, '0');
  await settled();
  push(OLD);
  typeInto(i, '0');
  assert.deepEqual(edits.map(({gains}) => gains), [{p: 0, i: 1, d: 0}, {p: 0, i: 0, d: 0}]);
});

test('a second push of the drive before an edit shows the edit of another user', async () => {
  const {push, p} = drivenHinge();
  push(OLD);
  typeInto(p, '0');
  await settled();
  assert.equal(p.value, '0');
  push(OLD);
  assert.equal(p.value, '0');
  push(OLD);
  assert.equal(p.value, '5');
});
