/** Puts a replay page together: the view, a time bar, and the recording that the page contains. */
import {createActions} from '../actions.js';
import {faultText} from '../ui/dialog.js';
import {byId, h} from '../ui/dom.js';
import {Notices} from '../panels/notices.js';
import {mountTheme} from '../ui/theme.js';
import {TimeBar} from '../panels/timebar.js';
import {Store} from '../store.js';
import {Topics} from '../topics/topics.js';
import {mountView} from '../view/view.js';
import {Watches} from '../watches.js';
import {LogConnection} from './log_connection.js';
import {LogPlot} from './log_plot.js';
import {partsOf, resolverOf, unpacked} from './page_files.js';
import {StateLog} from './state_log.js';
import type {Connection} from '../connection.js';
import type {Page} from '../panels/panels.js';

const STEP_S = 0.05;
/** Messages of other types are shown in windows of the editor only. */
const DRAWN = Object.freeze([
  'sensor_msgs/LaserScan', 'sensor_msgs/Range', 'sensor_msgs/PointCloud', 'sensor_msgs/PointCloud2',
  'nav_msgs/Odometry', 'nav_msgs/Path', 'nav_msgs/OccupancyGrid', 'geometry_msgs/PoseArray',
  'geometry_msgs/PoseStamped', 'geometry_msgs/PoseWithCovarianceStamped', 'gazebo_msgs/ContactsState',
  'visualization_msgs/Marker', 'visualization_msgs/MarkerArray',
]);

/** Switches for what is recorded besides poses: contacts, and each topic that can be drawn. */
function switchesOf(log: StateLog, {store, topics}: Page): HTMLElement[] {
  const made = (name: string, on: boolean, set: (on: boolean) => void) => {
    const box = h('input', {type: 'checkbox', checked: on}) as HTMLInputElement;
    box.addEventListener('change', () => set(box.checked));
    set(on);
    return h('label', {}, box, name);
  };
  const contacts = log.hasContacts ? [made('Contacts', false, (on) => store.setOverlay('contacts', on))] : [];
  topics.sense(false);
  const drawn = log.topics.filter(({type}) => DRAWN.includes(type));
  return [...contacts, ...drawn.map(({name}) => made(name, true, (on) => topics.show(name, on)))];
}

function onKey(event: KeyboardEvent, {store, actions}: Page) {
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
  const {name, log, files, curves} = partsOf(await unpacked(data.textContent ?? ''));
  data.remove();
  const recorded = new StateLog(log);
  const player = new LogConnection(recorded, name);
  // It has all that the page uses of a connection to a simulator.
  const connection = player as unknown as Connection;
  const store = new Store(connection);
  store.connected = true;
  const actions = createActions({store, connection});
  const watches = new Watches(connection);
  const topics = new Topics({store, connection, watches});
  const notices = new Notices(byId('notices'));
  const page: Page = {store, actions, connection, watches, topics, notices, view: null,
      theme: mountTheme(),
    request: (type, fields) => connection.request(type, fields), driving: {speeds: {speed: 0, turn: 0}}};
  new TimeBar(byId('timebar'), page);
  store.listen('issue', ({detail}) => notices.add(detail));
  page.view = mountView(byId('view'), {store, actions, connection, watches, topics,
    resolveUrl: resolverOf(files)});
  document.addEventListener('keydown', (event) => onKey(event, page));
  player.open();
  topics.read();
  byId('switches').append(...switchesOf(recorded, page));
  new LogPlot(byId('plot'), page, recorded, curves);
  document.title = `${name} – replay`;
  Object.assign(window, {editor: page});
}

start().catch((fault) => {
  byId('view').textContent = `The recording cannot be shown: ${faultText(fault)}`;
  throw fault;
});
