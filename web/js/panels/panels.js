/**
 * Everything around the 3D view: bars, tabs, windows, messages. The panels read the store and call
 * actions; what they show of the world is what the simulator last said.
 *
 * @typedef {Object} Page  what the panels hand to each other
 * @property {Store} store
 * @property {Actions} actions
 * @property {Connection} connection
 * @property {RequestFunction} request
 * @property {Watches} watches
 * @property {Topics} topics
 * @property {{speeds: DriveSpeeds}} driving
 * @property {Notices} notices
 * @property {ReturnType<typeof mountTheme>} theme
 * @property {PageView|null} view  null until it is there
 * @property {Requests['hello']['reply']} [about]  what the server said of itself
 */
import {HOTKEYS} from '../hotkeys.js';
import {closeDialogs} from './dialog.js';
import {aboutDialog, hotkeyDialog} from './dialogs/help_dialogs.js';
import {cloneDialog, newWorld, openDialog, saveAsDialog} from './dialogs/world_file_dialogs.js';
import {forceDialog} from './dialogs/force_dialog.js';
import {logsDialog} from './dialogs/log_dialog.js';
import {importDialog} from './dialogs/import_dialog.js';
import {offerRestore} from './dialogs/restore_offer.js';
import {recoverDialog} from './dialogs/recover_dialog.js';
import {byId, elementsOf, fill, h, remembered, roving} from './dom.js';
import {mountHints} from './hint_line.js';
import {InsertTab} from './insert_tab.js';
import {JointsPanel} from './joints_panel.js';
import {mountLayers} from './layers_tab.js';
import {mountMenuBar} from './menubar.js';
import {contextMenu, menus} from './menu_items.js';
import {Notices} from './notices.js';
import {Plots} from './plots.js';
import {openMenu} from './popup.js';
import {mountPeople} from './people_bar.js';
import {lyingBar, splitter} from './splitter.js';
import {mountTheme} from './theme.js';
import {TimeBar} from './timebar.js';
import {mountToolBar} from './toolbar.js';
import {TopicsPanel} from './topics_panel.js';
import {TopicWindows} from './topic_windows.js';
import {WorldTab} from './world_tab.js';
/** @import {Actions, DialogName, DialogRequest} from '../actions.js' */
/** @import {LoadingPush, Requests} from '../protocol.js' */
/** @import {Connection, RequestFunction} from '../connection.js' */
/** @import {SceneView} from '../view/view.js' */
/** @import {Store} from '../store.js' */
/** @import {DriveSpeeds} from '../drive_keys.js' */
/** @import {Topics} from '../topics/topics.js' */
/** @import {Watches} from '../watches.js' */

/**
 * What the panels ask of the view, which may be without a picture.
 * @typedef {Pick<SceneView, 'fps'|'available'|'thumbnail'|'redraw'>} PageView
 */

/**
 * @param {Document} document
 * @param {Omit<Page, 'request'|'notices'|'theme'>} parts
 * @returns {Page}
 */
export function mountPanels(document, parts) {
  const page = Object.assign(parts, {
    /** @type {RequestFunction} */
    request: (type, fields) => parts.connection.request(type, fields),
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
  mountConnectionNote(byId('centre'), page);
  mountHints(byId('view'));
  mountDrawer();
  return page;
}

/** In a narrow window the left panel lies over the view, while it is wanted. */
function mountDrawer() {
  const button = byId('drawer');
  /** @param {boolean} open */
  const set = (open) => {
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

/** @param {HTMLElement} element @param {Page} page */
function mountTabs(element, page) {
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
      type: 'button',
      role: 'tab',
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
  /** @param {number} at */
  const show = (at) => {
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
    /** @param {string} name */
    show: (name) => show(TABS.findIndex((tab) => tab[0] === name)),
  };
}

/** The parts of the window that F6 visits, each with what takes the focus there. */
const REGIONS = [
  '#menubar [tabindex="0"]',
  '#toolbar [tabindex="0"]',
  '.world-tree',
  '.properties input, .properties select',
  '#view',
  '#dock input',
  '#right [tabindex="0"]',
  '#timebar [tabindex="0"]',
];

/** Moves the focus to the next part of the window that is there. @param {number} step */
function goToRegion(step) {
  const shown = REGIONS.flatMap((selector) =>
    elementsOf(document, selector).find((element) => element.offsetParent !== null) ?? []);
  const at = shown.findIndex((element) => element.closest(
    '#menubar, #toolbar, .world-tree, .properties, #view, #dock, #right, #timebar',
  )?.contains(document.activeElement));
  const from = at < 0 && step < 0 ? 0 : at;
  shown[(from + step + shown.length) % shown.length]?.focus();
}

/** The dialogs and docked windows, by the names that actions ask for them. */
class Windows {
  /**
   * @param {Page} page
   * @param {ReturnType<typeof mountTabs>} tabs
   */
  constructor(page, tabs) {
    this.page = page;
    this.tabs = tabs;
    this.joints = new JointsPanel(byId('joints'), page);
    this.topics = new TopicsPanel(byId('topics'), page);
    new TopicWindows(byId('centre'), page);
    splitter(byId('right-splitter'), {
      key: 'right-width',
      initial: 300,
      min: 220,
      max: 560,
      from: 'right',
      within: byId('app'),
      apply: (size) =>
        byId('app').style.setProperty('--right-size', `${size}px`),
    });
    if (remembered.get('joints-shown', false)) this.#toggleSide('joints');
    if (remembered.get('topics-shown', false)) this.#toggleSide('topics');
  }

  /** @type {{panel: Plots, bar: HTMLElement}|null} */
  #plots = null;
  /** Names of the windows that are being opened. @type {Set<DialogName>} */
  #open = new Set();
  /** @type {{close: () => Promise<boolean>}|null} */
  #building = null;
  /** @type {import('../model_editor/model_editor.js').ModelEditor|null} */
  #model = null;

  /** @param {DialogRequest} detail */
  show(detail) {
    /** @type {Record<DialogName, () => unknown>} */
    const windows = {
      open: () => this.#files(openDialog, 'Opened'),
      saveAs: () => this.#files(saveAsDialog, 'Saved'),
      cloneWorld: () => cloneDialog(this.page),
      newWorld: () => newWorld(this.page),
      recover: () => recoverDialog(this.page),
      importFiles: () => importDialog(this.page, detail.entries ?? [], detail.place ?? [0, 0, 0]),
      applyForce: () => forceDialog(this.page, detail.target ?? this.#target()),
      hotkeys: () => hotkeyDialog(HOTKEYS),
      about: () => aboutDialog(this.page.about ?? {}),
      logs: () => logsDialog(this.page),
      plot: () => this.#togglePlots(),
      joints: () => this.#toggleSide('joints'),
      topics: () => this.#toggleSide('topics'),
      building: () => this.#toggleBuilding(),
      modelEditor: () => this.#toggleModelEditor(detail.target ?? null),
      saveModel: () => this.#model?.save(),
      togglePanels: () => document.body.classList.toggle('bare'),
      find: () => this.#inWorld((world) => world.find()),
      rename: () => this.#inWorld((world) => world.rename()),
      nextRegion: () => goToRegion(1),
      previousRegion: () => goToRegion(-1),
    };
    const run = windows[detail.name];
    if (!run || this.#open.has(detail.name)) return;
    // A key that repeats must not stack the same window.
    this.#open.add(detail.name);
    Promise.resolve(run())
      .catch((fault) => this.page.notices.fault(fault))
      .finally(() => this.#open.delete(detail.name));
  }

  /** @param {(world: WorldTab) => void} run */
  #inWorld(run) {
    document.body.classList.remove('bare');
    this.tabs.show('world');
    run(this.tabs.world);
  }

  #target() {
    const {selection} = this.page.store;
    return selection[selection.length - 1] ?? '';
  }

  /** @param {(page: Page) => Promise<string|undefined>} dialog @param {string} done */
  async #files(dialog, done) {
    const path = await dialog(this.page);
    if (path) this.page.notices.say(`${done} ${path}`);
  }

  #togglePlots() {
    const dock = byId('dock');
    if (!this.#plots) {
      const bar = lyingBar('Height of the plots');
      dock.before(bar);
      splitter(bar, {
        key: 'dock-height',
        initial: 250,
        min: 120,
        max: 600,
        from: 'bottom',
        within: byId('centre'),
        apply: (size) => dock.style.setProperty('--dock-height', `${size}px`),
      });
      this.#plots = {panel: new Plots(dock, this.page, () => this.#togglePlots()), bar};
      bar.hidden = true;
    }
    const {panel, bar} = this.#plots;
    dock.hidden = !dock.hidden;
    bar.hidden = dock.hidden;
    if (!dock.hidden) {
      panel.redraw();
      dock.querySelector('input')?.focus();
    }
  }

  /** Opens or closes a panel at the right. @param {'joints'|'topics'} name */
  #toggleSide(name) {
    const section = byId(name);
    section.hidden = !section.hidden;
    const right = byId('right');
    right.hidden = ['joints', 'topics'].every((one) => byId(one).hidden);
    byId('right-splitter').hidden = right.hidden;
    remembered.set(`${name}-shown`, !section.hidden);
    this[name].show(!section.hidden);
  }

  /** @param {string|null} name  of the model to edit */
  async #toggleModelEditor(name) {
    if (this.#model) {
      await this.#model.close();
      return;
    }
    if (this.#building) {
      this.page.notices.say('Leave the building editor first (Ctrl+B).');
      return;
    }
    const {ModelEditor} = await import('../model_editor/model_editor.js');
    const {store, request, actions, notices} = this.page;
    this.#model = new ModelEditor({store, request, actions, notices});
    this.#model.onExit = () => {
      closeDialogs();
      this.#model = null;
      byId('view').focus();
    };
    await this.#model.open(name);
  }

  async #toggleBuilding() {
    if (this.#model) {
      this.page.notices.say('Leave the model editor first (Ctrl+M).');
      return;
    }
    const element = byId('building');
    if (this.#building) {
      const closed = await this.#building.close();
      if (closed === false) return;
      this.#building = null;
      element.hidden = true;
      document.body.classList.remove('building');
      return;
    }
    const {mount} = await import('../building/building_editor.js');
    element.hidden = false;
    document.body.classList.add('building');
    const {store, request, actions} = this.page;
    this.#building = await mount(element, {store, request, actions});
    element.addEventListener(
      'exit',
      () => {
        closeDialogs();
        this.#building = null;
        element.hidden = true;
        document.body.classList.remove('building');
        byId('view').focus();
      },
      {once: true},
    );
  }
}

/**
 * What is waited for: the line, the simulator that reads its world, meshes and textures.
 * @param {HTMLElement} element
 * @param {Page} page
 */
function mountConnectionNote(element, {store, connection}) {
  const text = h('span');
  const detail = h('span', {class: 'soft'});
  const bar = h('progress', {'aria-label': 'Progress'});
  const note = h('div', {class: 'connection-note', role: 'status', hidden: true}, text, detail, bar);
  element.append(note);
  let begun = false;
  /** @type {LoadingPush|null} */
  let loading = null;
  const words = () => {
    if (connection.refused) {
      return 'The simulator was started again, with a new token. Run “gzclient”: it opens the ' +
        'editor, and this page connects again.';
    }
    if (loading) return loading.title || 'Loading the world';
    return begun ? 'Connection to the simulator lost. Reconnecting…' : 'Connecting to the simulator…';
  };
  const show = () => {
    begun ||= store.connected;
    note.hidden = store.connected && !loading;
    text.textContent = words();
    const {done = 0, of = 0} = loading ?? {};
    const count = of ? `${done} of ${of}` : '';
    detail.textContent = [loading?.text, count].filter(Boolean).join(' · ');
    bar.hidden = !loading;
    if (of) Object.assign(bar, {max: of, value: done});
    else bar.removeAttribute('value');
  };
  store.listen('connection', () => {
    loading = null;
    show();
  });
  connection.listen('refused', show);
  store.listen('loading', ({detail: news}) => {
    loading = news.of && news.done >= news.of && store.connected ? null : news;
    show();
  });
  // A page that connects at once need not say so.
  setTimeout(show, 600);
}
