import assert from 'node:assert/strict';
import {test} from 'node:test';
import {placeOf} from '../../web/js/topics/frame_places.js';
import {fanOf} from '../../web/js/topics/laser_fan.js';
import {isOver} from '../../web/js/topics/marker_lives.js';
import {decodeTopicFrame} from '../../web/js/topics/topic_frames.js';
import {sensedBy, Topics} from '../../web/js/topics/topics.js';
import {commandOf, mountDriving} from '../../web/js/drive_keys.js';
import {createActions} from '../../web/js/actions.js';
import {Store} from '../../web/js/store.js';
import {Watches} from '../../web/js/watches.js';
import {near} from './near.mjs';
import {actionsPage, frameOf, model, NotingConnection, world} from './scene.mjs';

const ORIGIN = [0, 0, 0, 0, 0, 0, 1];
const at = (x, y = 0, z = 0) => [x, y, z, 0, 0, 0, 1];

/** A frame as the server makes it. */
function topicFrame(head, payload = new Uint8Array()) {
  let text = JSON.stringify(head);
  text += ' '.repeat((8 - (text.length % 8)) % 8);
  const buffer = new ArrayBuffer(8 + text.length + payload.byteLength);
  const view = new DataView(buffer);
  view.setUint32(0, 3, true);
  view.setUint32(4, text.length, true);
  new Uint8Array(buffer).set(new TextEncoder().encode(text), 8);
  new Uint8Array(buffer).set(new Uint8Array(payload.buffer), 8 + text.length);
  return buffer;
}

const scanHead = (topic = '/scan') => ({topic, frame: 'laser', stamp: 1, view: {
  type: 'scan', angle_min: 0, angle_increment: Math.PI / 2, range_min: 0, range_max: 10, count: 2}});

const robot = (name, links, id = 10) => ({...model(name, id, ORIGIN),
  links: links.map((link, index) => ({...model(name, id + index, ORIGIN).links[0], name: link,
    id: id + index}))});

// ---- frames of messages

test('a frame gives its head and numbers that lie where typed arrays can read them', () => {
  const made = topicFrame(scanHead(), new Float32Array([1, 2]));
  const {head, buffer, start} = decodeTopicFrame(made);
  assert.equal(head.topic, '/scan');
  assert.deepEqual([...new Float32Array(buffer, start, 2)], [1, 2]);
  assert.equal(decodeTopicFrame(frameOf([])), null);
});

test('a fan joins neighbouring rays that both met something', () => {
  const {corners, triangles, hits} = fanOf(
    {angle_min: 0, angle_increment: Math.PI / 2}, [1, 2, NaN, 1]);
  near([...corners.slice(3, 9)], [1, 0, 0, 0, 2, 0], 1e-6);
  assert.deepEqual(triangles, [0, 1, 2]);
  assert.equal(hits.length, 9);
});

// ---- where frames are

const models = [robot('r1', ['base_link', 'laser']), robot('r2', ['base_link', 'wheel'], 20)];

test('a frame with the name of a link is at that link', () => {
  assert.deepEqual(placeOf('laser', {models}), {link: 11, pose: ORIGIN});
  assert.deepEqual(placeOf('/laser', {models}), {link: 11, pose: ORIGIN});
});

test('of links with one name the topic or the prefix says which', () => {
  assert.equal(placeOf('base_link', {models}), null);
  assert.equal(placeOf('base_link', {models, model: 'r2'}).link, 20);
  assert.equal(placeOf('r1/base_link', {models, model: 'r2'}).link, 10);
});

test('data of a sensor is where the sensor is, whatever its frame is called', () => {
  const mount = {link: 'base_link', pose: at(0.2)};
  assert.deepEqual(placeOf('nowhere', {models, model: 'r2', mount}), {link: 20, pose: at(0.2)});
});

test('tf tells where frames are that are no links, above and below one', () => {
  const transforms = new Map([
    ['odom', {parent: 'map', pose: at(10)}],
    ['wheel', {parent: 'odom', pose: at(1)}],
    ['tip', {parent: 'wheel', pose: at(0, 3)}],
    ['lost', {parent: 'elsewhere', pose: at(0)}],
  ]);
  const known = {models, transforms};
  near(placeOf('tip', known).pose, at(0, 3));
  assert.equal(placeOf('tip', known).link, 21);
  near(placeOf('map', known).pose, at(-11));
  assert.equal(placeOf('lost', known), null);
  assert.deepEqual(placeOf('world', known), {link: null, pose: ORIGIN});
});

// ---- which topics are shown

const topic = (name, type, more = {}) => ({name, type, publishers: 1, subscribers: 0, ...more});
const LIST = [
  topic('/chat', 'std_msgs/String'),
  topic('/odom', 'nav_msgs/Odometry', {model: 'a'}),
  topic('/scan', 'sensor_msgs/LaserScan', {model: 'a'}),
  topic('/other', 'sensor_msgs/LaserScan', {model: 'b'}),
  topic('/dead', 'sensor_msgs/LaserScan', {model: 'a', publishers: 0}),
];

function page() {
  const connection = new NotingConnection();
  connection.connected = true;
  connection.sent = [];
  connection.send = (type, fields) => connection.sent.push([type, fields]);
  connection.answers.topics = {available: true, topics: LIST};
  const store = new Store(connection);
  const actions = createActions({store, connection});
  const watches = new Watches(connection);
  const drawn = [];
  const topics = new Topics({store, connection, watches, later: (call) => drawn.push(call)});
  store.receive({type: 'world', revision: 1, document: world()});
  const asked = () => connection.requests.filter(([type]) => type === 'watch').at(-1)?.[1].topics;
  return {connection, store, actions, watches, topics, drawn, asked};
}

const settled = () => new Promise((resolve) => setTimeout(resolve));

test('what a selected robot senses is heard, and no longer when it is not selected', async () => {
  const {store, topics, asked} = page();
  await topics.refresh();
  assert.deepEqual(topics.list, []);  // without readers the list is not requested
  store.select(['a']);
  await settled();
  assert.deepEqual(sensedBy(LIST, 'a'), ['/scan', '/odom']);
  assert.deepEqual(asked(), ['ros:/scan', 'ros:/odom']);
  topics.show('/scan', false);
  topics.show('/chat', true);
  await settled();
  assert.deepEqual(asked(), ['ros:/odom', 'ros:/chat']);
  store.select([]);
  await settled();
  assert.deepEqual(asked(), ['ros:/chat']);
  topics.sense(false);
  store.select(['a']);
  await settled();
  assert.deepEqual(topics.shown, ['/chat']);
  topics.show('/chat', false);
  await settled();
  assert.deepEqual(asked(), []);
});

test('a message is told to the view, and asked for anew once the page has drawn', async () => {
  const {connection, topics, drawn} = page();
  topics.show('/scan', true);
  const seen = [];
  topics.listen('view', ({detail}) => seen.push(detail.head.topic));
  connection.emit('frame', topicFrame(scanHead(), new Float32Array([1, 2])));
  connection.emit('frame', topicFrame(scanHead('/unasked')));
  assert.deepEqual(seen, ['/scan']);
  assert.deepEqual(connection.sent, []);
  drawn.forEach((call) => call());
  assert.deepEqual(connection.sent[0], ['viewed', {topic: '/scan'}]);
  topics.show('/scan', false);
});

test('tf is heard when a frame is nobody s link, and not before', async () => {
  const {connection, topics, asked} = page();
  topics.show('/scan', true);
  await settled();
  assert.deepEqual(asked(), ['ros:/scan']);
  assert.equal(topics.placeOf('/scan', 'laser'), null);
  await settled();
  assert.deepEqual(asked(), ['ros:/scan', 'ros:/tf', 'ros:/tf_static']);
  connection.emit('frame', topicFrame({topic: '/tf', frame: '', stamp: 0, view: {
    type: 'transforms', transforms: [{parent: 'world', child: 'laser', pose: at(2)}]}}));
  assert.deepEqual(topics.placeOf('/scan', 'laser'), {link: null, pose: at(2)});
  topics.show('/scan', false);
  await settled();
  assert.deepEqual(asked(), []);
});

test('why nothing comes is kept until something does', () => {
  const {connection, store, topics} = page();
  topics.show('/scan', true);
  store.receive({type: 'watch', topic: 'ros:/scan', time: 0, problem: 'nobody publishes it yet'});
  assert.equal(topics.problems.get('/scan'), 'nobody publishes it yet');
  connection.emit('frame', topicFrame(scanHead(), new Float32Array([1, 2])));
  assert.equal(topics.problems.size, 0);
  topics.show('/scan', false);
});

// ---- driving

test('opposite keys cancel, Shift is faster', () => {
  const speeds = {speed: 0.5, turn: 1};
  assert.deepEqual(commandOf(['ArrowUp', 'ArrowLeft'], false, speeds),
    {linear: [0.5, 0, 0], angular: [0, 0, 1]});
  assert.deepEqual(commandOf(['ArrowUp', 'ArrowDown'], false, speeds).linear, [0, 0, 0]);
  assert.deepEqual(commandOf(['ArrowDown'], true, speeds).linear, [-1, 0, 0]);
});

/** A page whose keyboard is the test. */
function driver(selection = ['a']) {
  const {connection, store, actions} = actionsPage();
  const target = new EventTarget();
  store.select(selection);
  store.connected = true;
  mountDriving(target, {store, actions});
  const key = (type, name, more = {}) => {
    const event = Object.assign(new Event(type, {cancelable: true}), {key: name, ...more});
    target.dispatchEvent(event);
    return event;
  };
  const speeds = () => connection.requests.filter(([type]) => type === 'drive')
    .map(([, {model: name, linear, angular}]) => [name, linear[0], angular[2]]);
  return {connection, store, target, key, speeds};
}

test('a robot drives while a key is held and stops when it is released', () => {
  const {key, speeds} = driver();
  assert.equal(key('keydown', 'ArrowUp').defaultPrevented, true);
  key('keydown', 'ArrowUp', {repeat: true});
  key('keydown', 'ArrowLeft');
  key('keyup', 'ArrowUp');
  key('keyup', 'ArrowLeft');
  assert.deepEqual(speeds(), [['a', 0.3, 0], ['a', 0.3, 0.8], ['a', 0, 0.8], ['a', 0, 0]]);
});

test('it stops when the window loses the focus or something else is selected', () => {
  const first = driver();
  first.key('keydown', 'ArrowUp');
  first.target.dispatchEvent(new Event('blur'));
  assert.deepEqual(first.speeds().at(-1), ['a', 0, 0]);
  const second = driver();
  second.key('keydown', 'ArrowUp');
  second.store.select(['b']);
  assert.deepEqual(second.speeds().at(-1), ['a', 0, 0]);
});

test('a broken line ends driving: the server has stopped the robot', () => {
  const {key, speeds, store, connection} = driver();
  key('keydown', 'ArrowUp');
  connection.emit('close');
  key('keyup', 'ArrowUp');
  assert.equal(store.connected, false);
  assert.deepEqual(speeds(), [['a', 0.3, 0]]);
});

test('arrow keys mean nothing without a selected model or with other keys held', () => {
  const nothing = driver([]);
  assert.equal(nothing.key('keydown', 'ArrowUp').defaultPrevented, false);
  const lamp = driver(['lamp']);
  lamp.key('keydown', 'ArrowUp');
  const control = driver();
  control.key('keydown', 'ArrowUp', {ctrlKey: true});
  assert.deepEqual([...nothing.speeds(), ...lamp.speeds(), ...control.speeds()], []);
});

test('a marker goes when its lifetime is over or time began anew, and stays without one', () => {
  const life = {from: 10, lifetime: 0.5};
  assert.deepEqual([10, 10.4, 10.5, 9.9, 0].map((now) => isOver(life, now)),
    [false, false, true, false, true]);
  assert.equal(isOver({from: 10, lifetime: 0}, 1e6), false);
});

test('a robot that is selected before it has come shows what it senses', async () => {
  const connection = new NotingConnection();
  connection.connected = true;
  const store = new Store(connection);
  const topics = new Topics({store, connection, watches: new Watches(connection), later: (call) => call()});
  store.receive({type: 'world', revision: 1, document: world()});
  connection.answers.topics = {available: true, topics: []};
  const asked = () => connection.requests.filter(([type]) => type === 'topics').length;
  store.selection = ['taxi'];
  store.emit('selection');
  assert.equal(asked(), 0);
  store.receive({type: 'change', revision: 2, models: {taxi: robot('taxi', ['base_link'], 30)}});
  assert.equal(asked(), 1);
  store.select([]);
  await topics.refresh();
});
