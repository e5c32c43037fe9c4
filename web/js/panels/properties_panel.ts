/**
 * The property panel under the tree. A change goes to the server; what the panel then shows is what
 * came back.
 */
import {compose, inverse} from '../pose.js';
import {byId, fill, h, onceAFrame, remembered} from '../ui/dom.js';
import {faultText} from '../ui/dialog.js';
import {icon} from '../ui/icons.js';
import {pluginState, withSensorState, withState} from './plugin_states.js';
import {pluginOwner} from './plugin_fields.js';
import {makeInput} from './property_inputs.js';
import {keepTyping} from './kept_typing.js';
import {sharedSections} from './model_sections.js';
import {sectionsOf, valueAt} from './property_sections.js';
import {unitGeometry} from './geometry_fields.js';
import type {Field, Section} from './property_fields.js';
import type {Found} from './property_sections.js';
import type {Restore} from './kept_typing.js';
import type {Input} from './property_inputs.js';
import type {Row} from './world_rows.js';
import type {Page} from './panels.js';

/** A field on the panel; `field` is that of the newest document. */
type Entry = {key: string, field: Field, input: Input, element: HTMLElement};

/** Shows the properties of the selected row of the tree, and sends changes. */
export class Properties {
  element;
  store;
  request;
  notices;
  row: Row|null = null;
  update = onceAFrame(() => this.#show());

  constructor(element: HTMLElement, {store, request, notices}: Page) {
    this.element = element;
    this.store = store;
    this.request = request;
    this.notices = notices;
    fill(element, this.#title, this.#body);
    // Escape leaves a field that holds nothing new; the next one is the view's.
    element.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') byId('view').focus();
    });
    for (const event of ['document', 'entity', 'connection', 'plugins'] as const) {
      store.listen(event, this.update);
    }
    store.listen('poses', () => this.#posesCame());
  }

  #body = h('div', {class: 'properties-body'});
  #title = h('h2', {class: 'properties-title'});
  #signature: string|null = null;
  #inputs: Entry[] = [];
  #turns = new WeakMap();
  #closed = new Set(remembered.get('closed-sections', ['Inertial']));

  /** Gives the focus, and text that is not yet confirmed, to the fields that had them. */
  #typing: Restore|null = null;
  /** Callbacks that the next poses resolve. */
  #frames: (() => void)[] = [];
  #later: ReturnType<typeof setTimeout>|0 = 0;

  /** Ten times a second is as often as a person reads numbers. */
  #posesCame() {
    this.#frames.splice(0).forEach((resolve) => resolve());
    const several = this.store.selection.length > 1;
    if (this.#later || !(several || ['model', 'link'].includes(this.row?.kind ?? ''))) return;
    this.#later = setTimeout(() => {
      this.#later = 0;
      this.update();
    }, 100);
  }

  /** Settles with the next poses: a moved model is where they say. */
  #nextFrame() {
    return new Promise((resolve: (value?: unknown) => void) => {
      this.#frames.push(resolve);
      setTimeout(resolve, 500);
    });
  }

  /** @param row  whose properties are wanted */
  show(row: Row|null) {
    this.row = row;
    this.update();
  }

  /** Shows what is so now, without waiting for the next picture. */
  refresh() {
    this.#show();
  }

  /** What several selected models have in common, else what the row is. */
  #found(): Found|null {
    const {selection} = this.store;
    if (selection.length < 2) return this.#ofRow();
    const models = selection.flatMap((name) => this.store.model(name) ?? []);
    return models.length === selection.length
      ? sharedSections(models, (name) => this.store.worldPose(name))
      : this.#ofRow();
  }

  /** What the row is; of a plugin, whether it runs. */
  #ofRow(): Found|null {
    const found = sectionsOf(this.store.document, this.row);
    if (found && this.row?.kind === 'sensor') return withSensorState(found, this.store, this.row);
    const state = found && this.row?.kind === 'plugin' ? pluginState(this.store, this.row) : undefined;
    const {model = '', index = -1} = this.row ?? {};
    const owner = pluginOwner(this.store.document, model);
    return found && state && owner ? withState(found, state, owner, index) : found;
  }

  #show() {
    const found = this.#found();
    const signature = found
      ? JSON.stringify([
          found.title,
          this.row?.id,
          found.sections.map(({key, fields}) => [
            key,
            fields.map(({path, type, fixed}) => [path, type, fixed]),
          ]),
        ])
      : '';
    if (signature !== this.#signature) {
      this.#signature = signature;
      this.#build(found);
    }
    if (!found) return;
    renew(this.#inputs, found);
    const entities = new Map(found.sections.map((section) => [section.key, section.entity]));
    for (const {key, field, input, element} of this.#inputs) {
      // While a change is on its way the field shows the new value, not the one before it.
      if (element.classList.contains('pending')) continue;
      input.show(this.#value(entities.get(key), field));
    }
  }

  /** Poses are what they are now: models in the world, links in their model. */
  #value(entity: unknown, field: Field) {
    const now = field.path === 'pose' && !field.ops ? this.#poseNow(entity) : null;
    return now ?? valueAt(entity, field.local ?? field.path);
  }

  /** The present pose of a model or link; null for other entities. */
  #poseNow(entity: unknown) {
    const {kind, model, select} = this.row ?? {};
    const [owner, own] = [model, select].map((name) => (name ? this.store.worldPose(name) : null));
    if (kind === 'model') return own;
    const isLink = typeof entity === 'object' && entity !== null && 'inertial' in entity;
    return kind === 'link' && isLink && owner && own ? compose(inverse(owner), own) : null;
  }

  #build(found: Found|null) {
    const fresh = keepTyping(this.#body);
    const typing = fresh ?? this.#typing;
    // A renamed entity is gone for a moment; its field gets the focus back.
    this.#typing = found ? null : typing;
    this.#inputs = [];
    this.#title.textContent = found?.title ?? 'Property';
    this.#title.title = found?.title ?? '';
    this.element.classList.toggle('nothing', !found);
    if (!found) {
      fill(
        this.#body,
        h('p', {class: 'empty', text: 'Select an item in the tree or in the 3D view.'}),
      );
      return;
    }
    fill(this.#body, ...found.sections.map((section) => this.#section(section)));
    typing?.({focus: document.activeElement === document.body, confirm: typing === fresh});
  }

  #section(section: Section) {
    const fields = section.fields.filter(({type}) => !(this.store.readOnly && type === 'button'));
    const rows = fields.map((field) => this.#field(section, field));
    if (!section.title) return h('div', {class: 'section'}, ...rows);
    const kind = section.title.split(' ')[0];
    const details = h(
      'details',
      {class: 'section', open: !this.#closed.has(kind)},
      h('summary', {}, icon('right', 13), h('span', {text: section.title})),
      ...rows,
    );
    details.addEventListener('toggle', () => {
      if (details.open) this.#closed.delete(kind);
      else this.#closed.add(kind);
      remembered.set('closed-sections', [...this.#closed]);
    });
    return details;
  }

  #field(section: Section, field: Field) {
    const note = h('div', {class: 'field-note', role: 'alert'});
    const commit = (value: unknown) => this.#commit(section, entry, value, note);
    const refuse = (text: string) => {
      note.textContent = text;
    };
    const fixed = field.fixed || this.store.readOnly;
    const input = makeInput({...field, fixed}, commit, refuse);
    const wide = ['vector', 'pose', 'color', 'xml'].includes(field.type);
    const element = h(
      'div',
      {
        class: `field ${wide ? 'wide' : ''} ${fixed ? 'fixed' : ''}`,
        title: field.hint,
        dataset: {path: field.path, target: section.target},
      },
      field.type === 'button' ? null : h('span', {class: 'field-label'}, field.label,
        wide && field.unit ? h('span', {class: 'unit', text: ` ${field.unit}`}) : null),
      h(
        'span',
        {class: 'field-input'},
        input.element,
        !wide && field.unit && h('span', {class: 'unit', text: field.unit}),
      ),
      note,
    );
    const entry = {key: section.key, field, input, element};
    this.#inputs.push(entry);
    return element;
  }

  /** Resolves to whether the change was accepted. */
  async #commit(section: Section, entry: Entry, value: unknown, note: HTMLElement) {
    // What other properties and poses are now may be newer than what the panel shows.
    renew([entry], this.#found());
    const {field, element} = entry;
    note.textContent = '';
    element.classList.add('pending');
    // Several changes of one field may be on their way; the last one decides.
    const turn = (this.#turns.get(element) ?? 0) + 1;
    this.#turns.set(element, turn);
    let accepted = true;
    try {
      if (field.ops) {
        const {label, ops} = field.ops(value);
        await this.request('edit', {op: ops.length === 1 && ops[0].kind === 'compute_inertial'
          ? ops[0] : {kind: 'group', ops, label}});
      } else if (field.rename) await this.#rename(section.target, String(value));
      else if (field.path === 'geometry.type') {
        await this.#set(section.target, 'geometry', unitGeometry(String(value)));
      } else await this.#set(section.target, field.path, value);
      if (field.path === 'pose' && this.row?.kind !== 'light') await this.#nextFrame();
      element.classList.add('taken');
      setTimeout(() => element.classList.remove('taken'), 700);
    } catch (fault) {
      accepted = false;
      if (element.isConnected) {
        note.textContent = faultText(fault);
        note.scrollIntoView({block: 'nearest'});
      } else this.notices.say(`${field.label}: ${faultText(fault)}`);
    }
    if (this.#turns.get(element) !== turn) return accepted;
    element.classList.remove('pending');
    this.#show();
    return accepted;
  }

  async #rename(name: string, to: string) {
    const renamed = to.trim();
    await this.request('edit', {op: {kind: 'rename', name, to: renamed}});
    this.store.select([renamed]);
  }

  #set(target: string, path: string, value: unknown) {
    return this.request('edit', {op: {kind: 'set', target, path, value}});
  }
}

/**
 * Replaces the fields of entries by those of the present document, because the `ops` of a field refer
 * to the document that it was made from. Entries without a new field, as after another selection,
 * keep theirs.
 */
function renew(entries: Entry[], found: Found|null) {
  const sections = new Map(found?.sections.map(({key, fields}) => [key, fields]));
  for (const entry of entries) {
    const {path, label} = entry.field;
    const fresh = sections.get(entry.key)?.find((one) => one.path === path && one.label === label);
    entry.field = fresh ?? entry.field;
  }
}
