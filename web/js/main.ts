/** Puts the page together. */
import {createActions} from './actions.js';
import {Connection, webSocketUrl} from './connection.js';
import {mountDriving} from './drive_keys.js';
import {mountKeys} from './hotkeys.js';
import {faultText} from './ui/dialog.js';
import {byId} from './ui/dom.js';
import {identity} from './panels/people_bar.js';
import {mountPanels} from './panels/panels.js';
import {shareClipboard} from './shared_clipboard.js';
import {Store} from './store.js';
import {Topics} from './topics/topics.js';
import {Watches} from './watches.js';

const connection = new Connection(webSocketUrl(location), {identity});
const store = new Store(connection);
const actions = createActions({store, connection});
shareClipboard(store, new BroadcastChannel('world-editor.clipboard'));
const watches = new Watches(connection);
const topics = new Topics({store, connection, watches});
const driving = mountDriving(window, {store, actions});
const page = mountPanels({store, actions, connection, watches, topics, driving, view: null});
connection.listen('open', ({detail}) => {
  page.about = detail;
  document.body.classList.toggle('read-only', detail.read_only);
});
mountKeys(window, {store, actions});
connection.open();

try {
  const {mountView} = await import('./view/view.js');
  page.view = mountView(byId('view'), {store, actions, connection, watches, topics});
} catch (fault) {
  // Tree, properties and time work without a picture.
  store.addIssue({
    severity: 'error', code: 'view', message: `The 3D view failed to load: ${faultText(fault)}`,
  });
  console.error(fault);
}

/** For people with the browser's console open, and for tests. */
Object.assign(window, {editor: page});
