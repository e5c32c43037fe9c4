/**
 * Everything around the 3D view: bars, tabs, windows, messages. The panels read the store and call
 * actions; what they show of the world is what the simulator last said.
 * what the panels hand to each other
 */
import {mountConnectionNote} from './connection_note.js';
import {offerRestore} from './dialogs/restore_offer.js';
import {byId, fill, h, roving} from '../ui/dom.js';
import {mountHints} from './hint_line.js';
import {InsertTab} from './insert_tab.js';
import {mountLayers} from './layers_tab.js';
import {mountMenuBar} from '../ui/menubar.js';
import {contextMenu, menus} from './menu_items.js';
import {Notices} from './notices.js';
import {openMenu} from '../ui/popup.js';
import {mountPeople} from './people_bar.js';
import {splitter} from '../ui/splitter.js';
import {mountTheme} from '../ui/theme.js';
import {TimeBar} from './timebar.js';
import {mountToolBar} from './toolbar.js';
import {Windows} from './windows.js';
import {WorldTab} from './world_tab.js';
import type {Actions} from '../actions.js';
import type {Requests} from '../protocol.js';
import type {Connection, RequestFunction} from '../connection.js';
import type {SceneView} from '../view/scene_view.js';
import type {Store} from '../store.js';
import type {DriveSpeeds} from '../drive_keys.js';
import type {Topics} from '../topics/topics.js';
import type {Watches} from '../watches.js';

export interface Page {
  store: Store;
  actions: Actions;
  connection: Connection;
  request: RequestFunction;
  watches: Watches;
  topics: Topics;
  driving: {speeds: DriveSpeeds};
  notices: Notices;
  theme: ReturnType<typeof mountTheme>;
  /** null until it is there */
  view: PageView|null;
  /** what the server said of itself */
  about?: Requests['hello']['reply'];
}

/** What the panels ask of the view, which may be without a picture. */
type PageView = Pick<SceneView, 'fps'|'available'|'thumbnail'|'redraw'>;

export function mountPanels(parts: Omit<Page, 'request'|'notices'|'theme'>): Page {
  const page = Object.assign(parts, {
    request: ((type, fields) => parts.connection.request(type, fields)) as RequestFunction,
    notices: new Notices(byId('notices')),
    theme: mountTheme(),
  });
  mountMenuBar(byId('menubar'), menus(page));
  mountPeople(byId('people'), page);
  mountToolBar(byId('toolbar'), page);
  const tabs = mountTabs(byId('left'), page);
  new TimeBar(byId('timebar'), page);
  const windows = new Windows(page, tabs);
  page.store.listen('dialog', (event) => windows.show(event.detail));
  page.store.listen('contextmenu', ({detail: {name, x, y}}) => {
    if (name === null) return;
    const items = contextMenu(page, name);
    if (items.length) openMenu(items, {x, y, label: name});
  });
  page.store.listen('issue', (event) => page.notices.add(event.detail));
  page.store.listen('autosave', (event) => offerRestore(page, event.detail));
  page.store.listen('shutdown', (event) =>
    page.notices.say(
      `The simulator has shut down${event.detail.reason ? `: ${event.detail.reason}` : ''}.`,
    ),
  );
  parts.connection.listen('replaced', () => page.store.addIssue({
    severity: 'note', code: 'another-simulator',
    message: `This page now shows another start of a simulator, with the world ${worldFile(page.store)}.`,
  }));
  mountConnectionNote(byId('centre'), page);
  mountHints(byId('view'), page.store);
  mountDrawer();
  return page;
}

/** The name of the file of a world, or of the world without a file. */
function worldFile({document}: Store) {
  return document?.file.split('/').pop() || document?.name || '';
}

/** In a narrow window the left panel lies over the view, while it is wanted. */
function mountDrawer() {
  const button = byId('drawer');
  const set = (open: boolean) => {
    document.body.classList.toggle('drawer', open);
    button.setAttribute('aria-expanded', String(open));
  };
  button.addEventListener('click', () => set(!document.body.classList.contains('drawer')));
  byId('view').addEventListener('pointerdown', () => set(false));
}

const TABS = [
  ['world', 'World'],
  ['insert', 'Insert'],
  ['layers', 'Layers'],
];

function mountTabs(element: HTMLElement, page: Page) {
  const panels = TABS.map(([name]) =>
    h('section', {
      class: `tab-panel ${name}-tab`,
      id: `tab-${name}`,
      role: 'tabpanel',
      'aria-labelledby': `tab-button-${name}`,
    }),
  );
  const buttons = TABS.map(([name, title], at) =>
    h('button', {
      role: 'tab',
      class: TABS[at][0] === 'insert' ? 'edits' : '',
      id: `tab-button-${name}`,
      'aria-controls': `tab-${name}`,
      text: title,
      onclick: () => show(at),
    }),
  );
  const bar = h('div', {class: 'tabs', role: 'tablist', 'aria-label': 'Left panel'}, ...buttons);
  fill(element, bar, ...panels);
  const world = new WorldTab(panels[0], page);
  const insert = new InsertTab(panels[1], page);
  mountLayers(panels[2], page);
  const show = (at: number) => {
    buttons.forEach((button, index) => button.setAttribute('aria-selected', String(index === at)));
    panels.forEach((panel, index) => {
      panel.hidden = index !== at;
    });
    if (TABS[at][0] === 'insert' && !insert.locations) insert.load();
  };
  show(0);
  roving(bar, '[role=tab]').settle();
  splitter(byId('left-splitter'), {
    key: 'left-width',
    initial: 292,
    min: 200,
    max: 560,
    from: 'left',
    within: byId('app'),
    apply: (size) => byId('app').style.setProperty('--left-width', `${size}px`),
  });
  return {
    world,
    show: (name: string) => show(TABS.findIndex((tab) => tab[0] === name)),
  };
}
