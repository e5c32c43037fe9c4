import assert from 'node:assert/strict';
import test from 'node:test';
import {createActions} from '../../web/js/actions.js';
import {Connection, RequestError} from '../../web/js/connection.js';
import {Store} from '../../web/js/store.js';
import {Watches} from '../../web/js/watches.js';
import {faultText} from '../../web/js/ui/dialog.js';
import {rootLabels, withEnding} from '../../web/js/panels/dialogs/world_file_dialogs.js';
import {contextMenu, keysOf, menus} from '../../web/js/panels/menu_items.js';
import {numberFault} from '../../web/js/panels/property_inputs.js';
import {HOTKEYS} from '../../web/js/hotkeys.js';
import {FakeSimulator, box, light, world} from './fake_simulator.mjs';

/** A page without elements, connected to a fake simulator. */
async function connected(document = world([box('a')], [light('sun')])) {
  const simulator = new FakeSimulator(document);
  const connection = new Connection('ws://fake', {WebSocket: simulator.socketClass()});
  const store = new Store(connection);
  const actions = createActions({store, connection});
  const watches = new Watches(connection);
  const came = new Promise((resolve) => store.addEventListener('document', resolve, {once: true}));
  connection.open();
  await came;
  return {simulator, connection, store, actions, watches};
}

const settled = () => new Promise((resolve) => setTimeout(resolve));

test('watches send the union of what is wanted, once for several changes', async () => {
  const {simulator, watches, connection} = await connected();
  const offs = [watches.add('contacts'), watches.add('plot:a.x'), watches.add('contacts')];
  await settled();
  const sent = () =>
    simulator.requests.filter(({type}) => type === 'watch').map(({topics}) => topics);
  assert.deepEqual(sent(), [['contacts', 'plot:a.x']]);
  offs[0]();
  offs[0]();
  await settled();
  assert.deepEqual(sent().at(-1), ['contacts', 'plot:a.x']);
  offs[1]();
  offs[2]();
  await settled();
  assert.deepEqual(sent().at(-1), []);
  connection.close();
});

test('watches are told again after the line was lost', async () => {
  const {simulator, watches, connection} = await connected();
  watches.add('contacts');
  await settled();
  simulator.topics = null;
  const again = new Promise((resolve) =>
    connection.addEventListener('open', resolve, {once: true}),
  );
  [...simulator.clients][0].close();
  await again;
  await settled();
  assert.deepEqual(simulator.topics, ['contacts']);
  connection.close();
});

test('a refusal is told with its place and hint', () => {
  const issue = {message: 'no such mesh', file: 'a.world', line: 3, hint: 'Look again.'};
  assert.equal(faultText(new RequestError([issue])), 'no such mesh (a.world:3) Look again.');
  assert.equal(faultText(new RequestError([{message: 'it is there', hint: 'replace it'}])),
    'it is there; replace it');
  const [odd, bad] = [{...issue, severity: 'warning'}, {message: 'mass -1', severity: 'error'}];
  assert.equal(faultText(new RequestError([odd, bad])), 'mass -1');
  assert.equal(faultText(new Error('boom')), 'boom');
});

test('worlds are saved with an ending', () => {
  assert.equal(withEnding('room'), 'room.world');
  assert.equal(withEnding('room.sdf'), 'room.sdf');
  assert.equal(withEnding('room.v2'), 'room.v2.world');
});

test('folders that end alike are told apart by the folders above them', () => {
  assert.deepEqual(rootLabels(['/home/a/my_simulations/worlds', '/a/src/x/world', '/b/src/x/world']),
    ['my_simulations/worlds', 'a/src/x/world', 'b/src/x/world']);
  assert.deepEqual(rootLabels(['/b', '/a/b']), ['/b', 'a/b']);
});

test("numbers out of a field's range are refused in words", () => {
  assert.equal(numberFault({type: 'number', above: 0}, 0), 'must be greater than 0');
  assert.equal(numberFault({type: 'number', min: 0, max: 1}, 2), 'must be at most 1');
  assert.equal(numberFault({type: 'integer'}, 1.5), 'must be an integer');
  assert.equal(numberFault({type: 'number'}, NaN), 'not a number');
  assert.equal(numberFault({type: 'number', min: 0, max: 1}, 1), '');
});

test('every entry of every menu that has a hotkey or an action exists', async () => {
  const {store, actions, connection} = await connected();
  const page = {store, actions, theme: {get: () => 'auto'}, notices: {}, topics: {sensing: true}};
  globalThis.document = {body: {classList: {contains: () => false}}};
  for (const menu of menus(page)) {
    for (const item of menu.items().filter(({separator}) => !separator)) {
      assert.equal(typeof item.run, 'function', item.title);
      item.checked?.();
      item.enabled?.();
    }
  }
  delete globalThis.document;
  for (const {action} of HOTKEYS)
    if (action) assert.equal(typeof actions[action], 'function', action);
  assert.equal(keysOf('saveAs'), 'Ctrl+Shift+S');
  connection.close();
});

test('the context menu is that of Gazebo, with Hide and Locked; a light takes no force and no overlays', async () => {
  const {store, actions, connection} = await connected();
  const page = {store, actions};
  const titles = (name) =>
    contextMenu(page, name)
      .map(({title}) => title)
      .filter(Boolean);
  assert.deepEqual(titles('a'), [
    'Move To',
    'Follow',
    'Apply Force/Torque',
    'Edit Model',
    'View',
    'Hide',
    'Locked',
    'Copy',
    'Paste',
    'Delete',
  ]);
  assert.deepEqual(titles('sun'), ['Move To', 'Follow', 'Hide', 'Locked', 'Copy', 'Paste', 'Delete']);
  assert.deepEqual(titles('nobody'), []);
  store.select(['a', 'sun']);
  assert.ok(titles('a').includes('Delete Selection (2)'));
  connection.close();
});

test('a property that the simulator refuses keeps its old value', async () => {
  const {store, actions, connection} = await connected();
  const refused = await actions.setProperty('a::link', 'inertial.mass', 666);
  assert.equal(refused.ok, false);
  assert.equal(store.document.models[0].links[0].inertial.mass, 1);
  await actions.setProperty('a::link', 'inertial.mass', 5);
  assert.equal(store.document.models[0].links[0].inertial.mass, 5);
  assert.equal(store.history.undo.length, 1);
  connection.close();
});
