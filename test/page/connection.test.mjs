import assert from 'node:assert/strict';
import {once} from 'node:events';
import {test} from 'node:test';
import {backOff, Connection, webSocketUrl} from '../../web/js/connection.js';

/** A web socket whose other end is the test. */
class Socket {
  static made = [];
  static session = 's1';
  readyState = 0;
  bufferedAmount = 0;
  sent = [];

  constructor(url) {
    this.url = url;
    Socket.made.push(this);
  }

  send(text) {
    const message = JSON.parse(text);
    this.sent.push(message);
    if (message.type === 'hello') {
      this.push({type: 'reply', id: message.id, ok: true,
        value: {session: Socket.session, version: 1, app: 'test'}});
    }
  }

  push(message) { this.onmessage({data: JSON.stringify(message)}); }

  accept() {
    this.readyState = 1;
    this.onopen();
  }

  drop() {
    this.readyState = 3;
    this.onclose();
  }

  close() { this.drop(); }
}

async function connected() {
  Socket.made = [];
  Socket.session = 's1';
  const timers = [];
  const connection = new Connection('ws://here/ws',
    {WebSocket: Socket, setTimeout: (what, wait) => timers.push({what, wait})});
  connection.open();
  const opened = once(connection, 'open');
  Socket.made[0].accept();
  await opened;
  return {connection, socket: Socket.made[0], timers};
}

test('the page greets first, and is connected when it is answered', async () => {
  const {connection, socket} = await connected();
  assert.equal(socket.sent[0].type, 'hello');
  assert.equal(connection.connected, true);
});

test('what is asked and what is answered or lost is told', async () => {
  const {connection, socket} = await connected();
  const told = [];
  for (const event of ['asked', 'answered']) {
    connection.addEventListener(event, ({detail: {id, type = ''}}) => told.push(`${event} ${id} ${type}`.trim()));
  }
  const first = connection.request('save', {});
  const second = connection.request('undo', {});
  const [, {id: one}, {id: two}] = socket.sent;
  socket.push({type: 'reply', id: one, ok: true, value: 1});
  await first;
  socket.drop();
  await assert.rejects(second);
  assert.deepEqual(told, [`asked ${one} save`, `asked ${two} undo`, `answered ${one}`, `answered ${two}`]);
});

test('answers find their requests in any order', async () => {
  const {connection, socket} = await connected();
  const first = connection.request('step', {steps: 1});
  const second = connection.request('play');
  const [, {id: one}, {id: two}] = socket.sent;
  socket.push({type: 'reply', id: two, ok: true, value: 'second'});
  socket.push({type: 'reply', id: one, ok: false, issues: [{message: 'no', code: 'x'}]});
  assert.equal(await second, 'second');
  await assert.rejects(first, /no/);
});

test('what is asked without a line fails at once', async () => {
  const connection = new Connection('ws://here/ws', {WebSocket: Socket});
  await assert.rejects(connection.request('play'), /Not connected/);
});

test('a lost line fails what waits, and is made again with the session', async () => {
  const {connection, socket, timers} = await connected();
  const waiting = connection.request('play');
  const closed = once(connection, 'close');
  socket.drop();
  await closed;
  await assert.rejects(waiting, /lost/);
  assert.equal(connection.connected, false);
  assert.equal(timers[0].wait, backOff(0));
  timers[0].what();
  const again = once(connection, 'open');
  Socket.made[1].accept();
  await again;
  assert.equal(Socket.made[1].sent[0].session, 's1');
});

test('a line to another start of a simulator is told from one to the same', async () => {
  const {connection, socket, timers} = await connected();
  let replaced = 0;
  connection.listen('replaced', () => { replaced += 1; });
  for (const [at, session] of ['s1', 's2', 's2'].entries()) {
    Socket.session = session;
    (Socket.made.at(-1) ?? socket).drop();
    timers[at].what();
    const again = once(connection, 'open');
    Socket.made.at(-1).accept();
    await again;
    assert.equal(replaced, at === 0 ? 0 : 1);
  }
  assert.equal(Socket.made.at(-1).sent[0].session, 's2');
});

test('a line that was closed on purpose stays closed', async () => {
  const {connection, timers} = await connected();
  connection.close();
  assert.equal(timers.length, 0);
});

test('drags are dropped on a congested line', async () => {
  const {connection, socket} = await connected();
  socket.bufferedAmount = 1e6;
  connection.send('drag', {names: [], poses: []});
  assert.equal(socket.sent.length, 1);
  socket.bufferedAmount = 0;
  connection.send('drag', {names: [], poses: []});
  assert.equal(socket.sent.length, 2);
});

test('what ends a drag or asks for the next picture is sent on a congested line too', async () => {
  const {connection, socket} = await connected();
  socket.bufferedAmount = 1e6;
  connection.send('drag_end');
  connection.send('viewed', {topic: '/camera'});
  assert.deepEqual(socket.sent.slice(1).map(({type}) => type), ['drag_end', 'viewed']);
});

test('waiting doubles up to four seconds', () => {
  assert.deepEqual([0, 1, 2, 9].map(backOff), [250, 500, 1000, 4000]);
});

test('the web socket is where the page is, and the token goes along', () => {
  assert.equal(webSocketUrl(new URL('http://127.0.0.1:11346/')), 'ws://127.0.0.1:11346/ws');
  assert.equal(webSocketUrl(new URL('https://lab:1/?token=a%26b')), 'wss://lab:1/ws?token=a%26b');
});

test('a page whose token is refused says so until it is connected again', async () => {
  Socket.made = [];
  const timers = [];
  let answer = true;
  const connection = new Connection('ws://here/ws', {WebSocket: Socket,
    setTimeout: (what) => timers.push(what), isRefused: async () => answer});
  connection.open();
  const told = once(connection, 'refused');
  Socket.made[0].drop();
  await told;
  assert.equal(connection.refused, true);
  const gone = once(connection, 'refused');
  answer = false; // no server listens there any longer
  timers.pop()();
  Socket.made[1].drop();
  await gone;
  assert.equal(connection.refused, false);
  answer = true;
  timers.pop()();
  const again = once(connection, 'refused');
  Socket.made[2].drop();
  await again;
  timers.pop()();
  const opened = once(connection, 'open');
  Socket.made[3].accept();
  await opened;
  assert.equal(connection.refused, false);
});
