import assert from 'node:assert/strict';
import {test} from 'node:test';
import {LogConnection} from '../../web/js/replay/log_connection.js';
import {seriesOf} from '../../web/js/replay/log_plot.js';
import {partsOf, pathOf, resolverOf, unpacked} from '../../web/js/replay/page_files.js';
import {between, StateLog} from '../../web/js/replay/state_log.js';
import {Store} from '../../web/js/store.js';
import {decodeTopicFrame} from '../../web/js/topics/topic_frames.js';
import {numbersOf} from '../../web/js/topics/view_numbers.js';
import {near} from './near.mjs';

const DOCUMENT = 1;
const WHOLE = 2;
const MOVED = 3;

const bytes = (text) => new TextEncoder().encode(text);

function record(kind, time, content) {
  const head = new DataView(new ArrayBuffer(13));
  head.setUint8(0, kind);
  head.setFloat64(1, time, true);
  head.setUint32(9, content.length, true);
  return [new Uint8Array(head.buffer), content];
}

function poses(...rows) {
  const view = new DataView(new ArrayBuffer(32 * rows.length));
  rows.forEach(([id, ...pose], row) => {
    view.setUint32(32 * row, id, true);
    pose.forEach((value, part) => view.setFloat32(32 * row + 4 + 4 * part, value, true));
  });
  return new Uint8Array(view.buffer);
}

function joined(parts) {
  const found = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    found.set(part, at);
    at += part.length;
  }
  return found;
}

const at = (id, x) => [id, x, 0, 0, 0, 0, 0, 1];
const link = (id) => ({id, name: 'link', pose: [0, 0, 0, 0, 0, 0, 1], visuals: [], collisions: []});
const world = (...names) => bytes(JSON.stringify({name: 'w', lights: [], models: names.map(
  (name, index) => ({name, pose: [0, 0, 0, 0, 0, 0, 1], links: [link(index + 1)], joints: []}))}));

function recording(...more) {
  return new StateLog(joined([bytes('my_simulations state log 1\n'),
    ...record(DOCUMENT, 0, world('a', 'b')), ...record(WHOLE, 0, poses(at(1, 0), at(2, 5))),
    ...record(MOVED, 0.1, poses(at(1, 1))), ...record(MOVED, 1, poses(at(1, 3))), ...more]));
}

const placeOf = (log, time, id) => log.seek(time).poses.get(id)[0];

test('a state holds until the next one, and is interpolated towards one that is near', () => {
  const log = recording();
  assert.deepEqual([log.begin, log.end], [0, 1]);
  near([0, 0.05, 0.1, 0.6, 1].map((time) => placeOf(log, time, 1)), [0, 0.5, 1, 1, 3]);
  near([placeOf(log, 0.05, 2), placeOf(log, 0, 1)], [5, 0]);
});

test('a file that was cut off is good up to its last whole record', () => {
  const cut = record(MOVED, 2, poses(at(1, 9)));
  assert.equal(recording(cut[0], cut[1].subarray(0, 20)).end, 1);
  assert.throws(() => new StateLog(bytes('something else')), /state log/);
});

test('what follows a reset of sim time comes after what was before it', () => {
  const log = recording(...record(WHOLE, 0, poses(at(1, 7), at(2, 5))),
    ...record(MOVED, 0.5, poses(at(1, 8))));
  assert.equal(log.end, 1.5);
  near([placeOf(log, 1.5, 1)], [8]);
});

test('turns are interpolated the short way and stay unit quaternions', () => {
  const half = between(Float64Array.from([0, 0, 0, 0, 0, 0, 1]),
    Float64Array.from([0, 0, 0, 0, 0, -Math.SQRT1_2, -Math.SQRT1_2]), 0.5);
  near(half.slice(3), [0, 0, Math.sin(Math.PI / 8), Math.cos(Math.PI / 8)]);
});

function player(log) {
  let now = 0;
  const calls = [];
  const connection = new LogConnection(log, 'run', {
    nextFrame: (call) => calls.push(call), now: () => now});
  const store = new Store(connection);
  connection.open();
  return {connection, store, tick: (seconds) => {
    now += 1000 * seconds;
    calls.shift()?.();
  }, waiting: () => calls.length};
}

test('seeking moves models, playing advances with wall time and ends at the end', async () => {
  const {connection, store, tick, waiting} = player(recording());
  near(store.worldPose('b').slice(0, 1), [5]);
  await connection.request('log_seek', {time: 0.1});
  near(store.worldPose('a').slice(0, 1), [1]);
  await connection.request('log_play', {rate: 2});
  tick(0.1);
  near([store.log.time], [0.3]);
  assert.equal(store.log.state, 'playing');
  tick(5);
  assert.deepEqual([store.log.time, store.log.state], [1, 'open']);
  near(store.worldPose('a').slice(0, 1), [3]);
  tick(1);
  assert.equal(waiting(), 0);
});

test('another document replaces the world, also backwards', async () => {
  const {connection, store} = player(recording(...record(DOCUMENT, 1.2, world('c')),
    ...record(WHOLE, 1.2, poses(at(1, 4)))));
  await connection.request('log_seek', {time: 2});
  assert.deepEqual(store.document.models.map(({name}) => name), ['c']);
  await connection.request('log_seek', {time: 0});
  assert.deepEqual(store.document.models.map(({name}) => name), ['a', 'b']);
  near(store.worldPose('a').slice(0, 1), [0]);
});

test('an edit is refused', async () => {
  const {connection} = player(recording());
  await assert.rejects(connection.request('edit', {op: {kind: 'delete', names: ['a']}}), /recording/);
});

test('the data of a page is taken apart, and addresses lead into it', async () => {
  const head = bytes(JSON.stringify({name: 'run', log: [0, 3], files: {'/resource/a b.png': [3, 2, 'image/png']},
    curves: ['/odom.twist.twist.linear.x']}));
  const size = new Uint8Array(new Uint32Array([head.length]).buffer);
  const data = joined([size, head, bytes('logPN')]);
  const packed = new Response(new Blob([data]).stream().pipeThrough(new CompressionStream('gzip')));
  const base64 = Buffer.from(await packed.arrayBuffer()).toString('base64');
  const {name, log, files, curves} = partsOf(await unpacked(`\n${base64}\n`));
  assert.deepEqual([name, new TextDecoder().decode(log), curves], ['run', 'log', ['/odom.twist.twist.linear.x']]);
  const resolve = resolverOf(files);
  assert.match(resolve('file:///resource/x/../a%20b.png'), /^blob:/);
  assert.match(resolve('/resource/other.png'), /^data:/);
  assert.equal(resolve('blob:null/1'), 'blob:null/1');
  assert.equal(pathOf('file:///C:/resource/100%.png'), '/resource/100%.png');
});

const CONTACTS = 4;
const TOPICS = 5;
const MESSAGE = 6;
const json = (value) => bytes(JSON.stringify(value));

function message(topic, stamp, view) {
  let text = JSON.stringify({topic, frame: 'odom', stamp, view});
  text += ' '.repeat((8 - (text.length + 8) % 8) % 8);
  return joined([new Uint8Array(new Uint32Array([3, text.length]).buffer), bytes(text)]);
}

const contact = (depth) => ({a: 'a::link', b: 'b::link', position: [0, 0, 0], normal: [0, 0, 1], depth, force: 1});
const odometry = (x) => ({type: 'odometry', child: 'base', pose: [x, 0, 0, 0, 0, 0, 1], linear: [0, 0, 0], angular: [0, 0, 0]});
const range = (distance) => ({type: 'range', range: distance, range_min: 0, range_max: 9, field_of_view: 0});

/** A log with contacts and two topics, and everything that a page receives of it. */
function noted() {
  const topics = ['/odom', '/range'].map((name) => ({name, type: 't', publishers: 1, subscribers: 0}));
  const log = new StateLog(joined([bytes('my_simulations state log 1\n'), ...record(DOCUMENT, 0, world('a')),
    ...record(WHOLE, 0, poses(at(1, 0))), ...record(TOPICS, 0, json(topics)),
    ...record(CONTACTS, 0, json([contact(0)])), ...record(MESSAGE, 0, message('/odom', 0, odometry(0))),
    ...record(MOVED, 0.1, poses(at(1, 1))), ...record(MESSAGE, 0.1, message('/odom', 0.1, odometry(1))),
    ...record(MESSAGE, 0.1, message('/range', 0.1, range(5))), ...record(MOVED, 0.2, poses(at(1, 2))),
    ...record(CONTACTS, 0.2, json([contact(1), contact(2)])),
    ...record(MESSAGE, 0.2, message('/range', 0.2, range(4)))]));
  const {connection, store} = player(log);
  const got = [];
  connection.listen('frame', ({detail}) => {
    const head = decodeTopicFrame(detail)?.head;
    if (head) got.push([head.topic, head.stamp, store.worldPose('a')[0]]);
  });
  store.listen('watch', ({detail}) => got.push(['contacts', detail.contacts.length]));
  return {log, connection, take: () => got.splice(0)};
}

test('contacts and messages of topics are shown only if they are watched', async () => {
  const {log, connection, take} = noted();
  assert.ok(log.hasContacts);
  assert.deepEqual((await connection.request('topics', {})).topics.map(({name}) => name), ['/odom', '/range']);
  await connection.request('log_seek', {time: 0.2});
  assert.deepEqual(take(), []);
  await connection.request('watch', {topics: ['contacts', 'ros:/range']});
  assert.deepEqual(take(), [['contacts', 2], ['/range', 0.2, 2]]);
});

test('a path is shown from its beginning, where the robot was then, also after a way back', async () => {
  const {connection, take} = noted();
  await connection.request('log_seek', {time: 0.2});
  await connection.request('watch', {topics: ['ros:/odom', 'contacts']});
  assert.deepEqual(take(), [['/odom', 0, 0], ['/odom', 0.1, 2], ['contacts', 2]]);
  await connection.request('log_seek', {time: 0.1});
  assert.deepEqual(take().filter(([name]) => name === '/odom'), [['/odom', 0, 0], ['/odom', 0.1, 1]]);
});

test('numbers of recorded messages are curves over the time of the log', () => {
  const curves = seriesOf(noted().log);
  assert.deepEqual([...curves.keys()].filter((name) => /position|range/.test(name)), [
    '/odom.pose.pose.position.x', '/odom.pose.pose.position.y', '/odom.pose.pose.position.z', '/range.range']);
  const {times, values} = curves.get('/odom.pose.pose.position.x');
  near(times, [0, 0.1]);
  near(values, [0, 1]);
  near(curves.get('/range.range').values, [5, 4]);
});

test('numbers of a message as text have the path of their field', () => {
  const text = ['header:', '  seq: 5', '  stamp: 1.500', 'linear:', '  x: 0.3', '  y: -1e-05', 'on: True', 'name: a',
    'data: [1, nan, 3, ... (30)]', 'empty: []', 'status: (2)', '  -', '    level: 1', '    values: (1)', '      -',
    '        key: 2', '  -', '    level: 4', 'covariance: [1, 2]', 'last:', '  z: 7', '      lost: 1'].join('\n');
  assert.deepEqual([...numbersOf({type: 'text', text}, new ArrayBuffer(0))], [['linear.x', 0.3], ['linear.y', -1e-5],
    ['on', 1], ['data[0]', 1], ['data[2]', 3], ['status[0].level', 1], ['status[0].values[0].key', 2],
    ['status[1].level', 4], ['last.z', 7]]);
});

test('a laser scan has the distance of the nearest object, others have none', () => {
  const scan = (ranges) => numbersOf({type: 'scan', count: ranges.length}, new Float32Array(ranges).buffer);
  assert.deepEqual([...scan([NaN, 2, 0.5, NaN])], [['nearest', 0.5]]);
  assert.equal(scan([NaN]).size + scan([]).size, 0);
  assert.equal(numbersOf({...range(null)}, new ArrayBuffer(0)).size, 0);
  assert.equal(numbersOf({type: 'contacts', positions: [], normals: []}, new ArrayBuffer(0)).size, 0);
});
