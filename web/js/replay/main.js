/** Puts a replay page together: the view, a time bar, and the recording that the page contains. */
import {createActions} from '../actions.js';
import {faultText} from '../panels/dialog.js';
import {byId} from '../panels/dom.js';
import {Notices} from '../panels/notices.js';
import {mountTheme} from '../panels/theme.js';
import {TimeBar} from '../panels/timebar.js';
import {Store} from '../store.js';
import {Topics} from '../topics/topics.js';
import {mountView} from '../view/view.js';
import {Watches} from '../watches.js';
import {LogConnection} from './log_connection.js';
import {partsOf, resolverOf, unpacked} from './page_files.js';
import {StateLog} from './state_log.js';
/** @import {Connection} from '../connection.js' */
/** @import {Page} from '../panels/panels.js' */

const STEP_S = 0.05;

/** @param {KeyboardEvent} event @param {Page} page */
function onKey(event, {store, actions}) {
  if (event.target instanceof Element && event.target.closest('input, select, button')) return;
  const {log} = store;
  if (!log) return;
  const step = {ArrowLeft: -STEP_S, ArrowRight: STEP_S}[event.key];
  if (event.key === ' ') actions.logPlay(log.state === 'playing' ? 0 : 1);
  else if (step) actions.logSeek(log.time + step);
  else return;
  event.preventDefault();
}

async function start() {
  const data = byId('data');
  const {name, log, files} = partsOf(await unpacked(data.textContent ?? ''));
  data.remove();
  const player = new LogConnection(new StateLog(log), name);
  // It has all that the page uses of a connection to a simulator.
  const connection = /** @type {Connection} */ (/** @type {unknown} */ (player));
  const store = new Store(connection);
  store.connected = true;
  const actions = createActions({store, connection});
  const watches = new Watches(connection);
  const topics = new Topics({store, connection, watches});
  const notices = new Notices(byId('notices'));
  /** @type {Page} */
  const page = {store, actions, connection, watches, topics, notices, view: null, theme: mountTheme(),
    request: (type, fields) => connection.request(type, fields), driving: {speeds: {speed: 0, turn: 0}}};
  new TimeBar(byId('timebar'), page);
  store.listen('issue', ({detail}) => notices.add(detail));
  page.view = mountView(byId('view'), {store, actions, connection, watches, topics,
    resolveUrl: resolverOf(files)});
  document.addEventListener('keydown', (event) => onKey(event, page));
  player.open();
  document.title = `${name} – replay`;
  Object.assign(window, {editor: page});
}

start().catch((fault) => {
  byId('view').textContent = `The recording cannot be shown: ${faultText(fault)}`;
  throw fault;
});
