/** Dialogs, docked windows and editors, opened by the names that actions ask for them. */
import {HOTKEYS} from '../hotkeys.js';
import {closeDialogs} from '../ui/dialog.js';
import {aboutDialog, hotkeyDialog} from './dialogs/help_dialogs.js';
import {cloneDialog, newWorld, openDialog, saveAsDialog} from './dialogs/world_file_dialogs.js';
import {forceDialog} from './dialogs/force_dialog.js';
import {arrayDialog} from './dialogs/array_dialog.js';
import {commandDialog} from './dialogs/command_dialog.js';
import {logsDialog} from './dialogs/log_dialog.js';
import {importDialog} from './dialogs/import_dialog.js';
import {recoverDialog} from './dialogs/recover_dialog.js';
import {byId, elementsOf, remembered} from '../ui/dom.js';
import {JointsPanel} from './joints_panel.js';
import {Plots} from './plots.js';
import {lyingBar, splitter} from '../ui/splitter.js';
import {TopicsPanel} from './topics_panel.js';
import {TopicWindows} from './topic_windows.js';
import type {DialogName, DialogRequest} from '../actions.js';
import type {Page} from './panels.js';
import type {WorldTab} from './world_tab.js';
import type {ModelEditor} from '../model_editor/model_editor.js';

/** The tabs of the left panel. */
type Tabs = {world: WorldTab, show: (name: string) => void};

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

/** Moves the focus to the next part of the window that is there. */
function goToRegion(step: number) {
  const shown = REGIONS.flatMap((selector) =>
    elementsOf(document, selector).find((element) => element.offsetParent !== null) ?? []);
  const at = shown.findIndex((element) => element.closest(
    '#menubar, #toolbar, .world-tree, .properties, #view, #dock, #right, #timebar',
  )?.contains(document.activeElement));
  const from = at < 0 && step < 0 ? 0 : at;
  shown[(from + step + shown.length) % shown.length]?.focus();
}

/** The dialogs and docked windows, by the names that actions ask for them. */
export class Windows {
  page;
  tabs;
  joints;
  topics;

  constructor(page: Page, tabs: Tabs) {
    this.page = page;
    this.tabs = tabs;
    this.joints = new JointsPanel(byId('joints'), page);
    this.topics = new TopicsPanel(byId('topics'), page);
    new TopicWindows(byId('view'), page);
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

  #plots: {panel: Plots, bar: HTMLElement}|null = null;
  /** Names of the windows that are being opened. */
  #open: Set<DialogName> = new Set();
  #building: {close: () => Promise<boolean>}|null = null;
  #model: ModelEditor|null = null;

  show(detail: DialogRequest) {
    const windows: Record<DialogName, () => unknown> = {
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
      schematic: () => (this.#model ? this.#model.toggleSchematic()
        : this.page.notices.say('The schematic view is part of the model editor (Ctrl+M).')),
      togglePanels: () => document.body.classList.toggle('bare'),
      find: () => this.#inWorld((world) => world.find()),
      array: () => arrayDialog(this.page),
      commands: () => commandDialog(this.page),
      rename: () => this.#inWorld((world) => world.rename()),
      nextRegion: () => goToRegion(1),
      previousRegion: () => goToRegion(-1),
    };
    const run = windows[detail.name];
    // A key that repeats must not stack the same window. Files that are dropped during an import must not be lost.
    if (!run || (this.#open.has(detail.name) && !detail.entries)) return;
    this.#open.add(detail.name);
    Promise.resolve(run())
      .catch((fault) => this.page.notices.fault(fault))
      .finally(() => this.#open.delete(detail.name));
  }

  #inWorld(run: (world: WorldTab) => void) {
    document.body.classList.remove('bare');
    this.tabs.show('world');
    run(this.tabs.world);
  }

  #target() {
    const {selection} = this.page.store;
    return selection[selection.length - 1] ?? '';
  }

  async #files(dialog: (page: Page) => Promise<string|undefined>, done: string) {
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
    panel.show(!dock.hidden);
    if (!dock.hidden) dock.querySelector('input')?.focus();
  }

  /** Opens or closes a panel at the right. */
  #toggleSide(name: 'joints'|'topics') {
    const section = byId(name);
    section.hidden = !section.hidden;
    const right = byId('right');
    right.hidden = ['joints', 'topics'].every((one) => byId(one).hidden);
    byId('right-splitter').hidden = right.hidden;
    remembered.set(`${name}-shown`, !section.hidden);
    this[name].show(!section.hidden);
  }

  /** @param name  of the model to edit */
  async #toggleModelEditor(name: string|null) {
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
