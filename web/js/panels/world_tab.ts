/** The World tab: a filter, the tree, and the properties of the row that is chosen. */
import {elementsOf, fill, h, onceAFrame, remembered} from '../ui/dom.js';
import {groupsOf, membersOf} from '../model_groups.js';
import {colorOf} from '../person_color.js';
import {doing} from './people_bar.js';
import {pluginState, sensorState, stateTag} from './plugin_states.js';
import {Properties} from './properties_panel.js';
import {Tree} from '../ui/tree_view.js';
import {rowOf, worldRows} from './world_rows.js';
import {lyingBar, splitter} from '../ui/splitter.js';
import type {Row} from './world_rows.js';
import type {Page} from './panels.js';

/** What of a model or light this browser's user has chosen, as tags of its row. */
const FLAGS = ['hidden', 'locked'] as const;

export class WorldTab {
  store;
  actions;
  page;
  tree;
  properties;
  update = onceAFrame(() => this.#update());

  constructor(element: HTMLElement, page: Page) {
    this.store = page.store;
    this.actions = page.actions;
    this.page = page;
    const tree = h('div', {class: 'world-tree'});
    const properties = h('section', {class: 'properties', 'aria-label': 'Properties'});
    const bar = lyingBar('Height of the properties');
    fill(element, h('div', {class: 'filter'}, this.#filter), tree, bar, properties);
    splitter(bar, {
      key: 'properties-height',
      initial: 300,
      min: 90,
      max: 640,
      from: 'bottom',
      within: element,
      apply: (size) => {
        properties.style.height = `${size}px`;
      },
    });
    this.tree = new Tree(tree, {
      label: 'World',
      choose: (row, event) => this.#choose(row, event),
      toggle: (row, open) => this.#toggle(row, open),
      activate: (row) => this.actions.moveTo(row.select),
      menu: (row, x, y) => this.#menu(row, x, y),
      decorate: (row) => this.#decorate(row),
    });
    this.properties = new Properties(properties, page);
    for (const event of ['document', 'entity'] as const) this.store.listen(event, this.update);
    this.store.listen('selection', () => this.#followSelection());
    this.store.listen('overlays', () => this.tree.draw());
    this.store.listen('people', () => this.tree.draw());
    this.store.listen('plugins', () => {
      this.tree.draw();
      this.properties.update();
    });
    let paused: boolean|null = null;
    this.store.listen('stats', () => {
      if (this.store.stats.paused === paused) return;
      paused = this.store.stats.paused;
      this.tree.draw();
    });
    this.update();
  }

  #filter = h('input', {
    type: 'search',
    placeholder: 'Find a model or light',
    'aria-label': 'Find a model or light',
    oninput: () => {
      this.#open.add('models').add('lights');
      this.update();
    },
  });
  #open = new Set(['models', 'groups', 'lights', ...remembered.get('open-rows', [])]);
  /** The row whose properties are shown. */
  #row: Row|null = null;
  /** Name of a new, selected entity whose row does not exist yet. */
  #awaited: string|null = null;

  #update() {
    if (this.#awaited && rowOf(this.store.document, this.#awaited)) {
      this.#followSelection();
      return;
    }
    const rows = worldRows(this.store.document, this.#open, this.#filter.value);
    this.tree.show(rows, this.#selectedRows());
    this.#row = rows.find((row) => row.id === this.#row?.id) ?? this.#row;
    this.properties.show(this.#row);
  }

  #selectedRows() {
    const {document, selection} = this.store;
    if (!document) return new Set<string>();
    const models = new Set(document.models.map(({name}) => name));
    const lights = new Set(document.lights.map(({name}) => name));
    const idOf = (name: string) =>
      models.has(name) ? `model:${name}` : lights.has(name) ? `light:${name}` : `link:${name}`;
    return new Set([...selection.map(idOf), ...(this.#row ? [this.#row.id] : [])]);
  }

  #choose(row: Row, event: {ctrlKey?: boolean, metaKey?: boolean}) {
    if (row.kind === 'heading') return;
    this.#row = row;
    if (row.kind === 'group') {
      this.store.select(groupsOf(membersOf(this.store.document)).get(row.name ?? '') ?? []);
      // The selection shows the row of its last model.
      this.#row = row;
    } else if (row.select) {
      this.store.select([row.select], {toggle: event.ctrlKey || event.metaKey});
    } else if (this.store.selection.length && !this.#belongs(row, this.store.selection)) {
      this.store.select([]);
    }
    this.update();
  }

  /** A joint's or plugin's row leaves its model selected. */
  #belongs(row: Row, selection: string[]) {
    return row.model && selection.some((name) => this.store.split(name)[0]?.name === row.model);
  }

  #toggle(row: Row, open: boolean) {
    if (open) this.#open.add(row.id);
    else this.#open.delete(row.id);
    const kept = [...this.#open].filter((id) =>
      this.store.document?.models.some((model) => id.endsWith(`:${model.name}`)),
    );
    remembered.set('open-rows', kept.slice(-50));
    this.update();
  }

  #followSelection() {
    const last = this.store.selection[this.store.selection.length - 1];
    const found = last && rowOf(this.store.document, last);
    this.#awaited = found ? null : (last ?? null);
    if (found && this.#row?.id !== found.id) {
      found.opens.forEach((id) => this.#open.add(id));
      const rows = worldRows(this.store.document, this.#open, this.#filter.value);
      this.#row =
        rows.find((row) => row.id === found.id) ??
        worldRows(this.store.document, this.#open).find((row) => row.id === found.id) ??
        null;
      this.tree.show(rows, this.#selectedRows());
      this.tree.reveal(found.id);
    } else if (!last && this.#row?.select) this.#row = null;
    // At once: the next typed text belongs to the new selection.
    this.#update();
    this.properties.refresh();
  }

  #menu(row: Row, x: number, y: number) {
    if (row.kind === 'group') {
      this.#choose(row, {});
      const name = this.store.selection.at(-1);
      if (name) this.store.emit('contextmenu', {name, x, y});
    }
    if (!row.select) return;
    if (!this.store.selection.includes(row.select)) this.#choose(row, {});
    this.store.emit('contextmenu', {name: row.select, x, y});
  }

  #decorate(row: Row) {
    const person = row.select && this.store.others.find(({held, selected}) =>
      held.includes(row.select ?? '') || selected.includes(row.select ?? ''));
    if (person) {
      return h('span', {class: 'tag person-tag', style: `--person: ${colorOf(person)}`,
        text: person.name, title: `${person.name} ${doing(person)}`});
    }
    if (row.kind === 'model' || row.kind === 'light') {
      const model = this.store.model(row.model ?? '');
      const member = model ?? this.store.light(row.name ?? '');
      const tags = [member?.group, model?.static && 'static', ...FLAGS.map((flag) => member && this.store.overlay(flag, member.name) && flag)];
      const failed = this.store.pluginStates.find((one) => one.model && one.model === row.model && one.state === 'failed');
      return h('span', {class: 'tags'}, ...tags.map((text) => text && h('span', {class: 'tag', text})),
        failed && stateTag('plugin failed', failed.reason));
    }
    if (row.kind === 'plugin' || row.kind === 'sensor') {
      const state = (row.kind === 'plugin' ? pluginState : sensorState)(this.store, row);
      return state && stateTag(state.state, state.reason);
    }
    if (row.kind === 'physics' && this.store.stats.paused) {
      return h('span', {class: 'tag', text: 'paused'});
    }
    return null;
  }

  /** Puts the focus where names are looked for. */
  find() {
    this.#filter.focus();
    this.#filter.select();
  }

  /** Puts the focus into the name of what is selected. */
  rename() {
    this.#update();
    this.properties.refresh();
    elementsOf(this.properties.element, '[data-path="name"] input:not([readonly])')[0]?.focus();
  }
}
