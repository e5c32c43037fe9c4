/**
 * The property panel under the tree. A change goes to the server; what the panel then shows is what
 * came back.
 */
import {compose, inverse} from '../pose.js';
import {fill, h, onceAFrame, remembered} from './dom.js';
import {faultText} from './dialog.js';
import {icon} from './icons.js';
import {makeInput} from './inputs.js';
import {sectionsOf, valueAt} from './property_sections.js';
import {unitGeometry} from './geometry_fields.js';

export class Properties {
  /**
   * @param {HTMLElement} element
   * @param {import('./panels.js').Page} page
   */
  constructor(element, {store, request}) {
    this.element = element;
    this.store = store;
    this.request = request;
    this.row = null;
    this.#body = h('div', {class: 'properties-body'});
    this.#title = h('h2', {class: 'properties-title'});
    fill(element, this.#title, this.#body);
    this.update = onceAFrame(() => this.#show());
    for (const event of ['document', 'entity', 'connection', 'stats']) {
      store.addEventListener(event, this.update);
    }
  }

  #body;
  #title;
  #signature = null;
  #inputs = [];
  #closed = new Set(remembered.get('closed-sections', ['Inertial']));

  /** @param {import('./world_rows.js').Row|null} row whose properties are wanted */
  show(row) {
    this.row = row;
    this.update();
  }

  #show() {
    const found = sectionsOf(this.store.document, this.row);
    const signature = found ? JSON.stringify([found.title, this.row.id, found.sections.map(
      ({key, fields}) => [key, fields.map(({path, type, fixed}) => [path, type, fixed])])]) : '';
    if (signature !== this.#signature) {
      this.#signature = signature;
      this.#build(found);
    }
    if (!found) return;
    const entities = new Map(found.sections.map((section) => [section.key, section.entity]));
    for (const {key, field, input, element} of this.#inputs) {
      // While a change is on its way the field shows the new value, not the one before it.
      if (element.classList.contains('pending')) continue;
      input.show(this.#value(entities.get(key), field));
    }
  }

  /** Poses are what they are now: models in the world, links in their model. */
  #value(entity, field) {
    if (field.path === 'pose' && this.row.kind === 'model') {
      return this.store.worldPose(entity.name) ?? entity.pose;
    }
    if (field.path === 'pose' && this.row.kind === 'link' && field.local === 'pose' &&
        entity.inertial) {
      const [model, link] = [this.row.model, this.row.select].map((name) => this.store.worldPose(name));
      return model && link ? compose(inverse(model), link) : entity.pose;
    }
    return valueAt(entity, field.local);
  }

  #build(found) {
    this.#inputs = [];
    this.#title.textContent = found?.title ?? 'Property';
    this.#title.title = found?.title ?? '';
    if (!found) {
      fill(this.#body, h('p', {class: 'empty',
        text: 'Choose a row above, or click something in the view.' }));
      return;
    }
    fill(this.#body, ...found.sections.map((section) => this.#section(section)));
  }

  #section(section) {
    const rows = section.fields.map((field) => this.#field(section, field));
    if (!section.title) return h('div', {class: 'section'}, ...rows);
    const kind = section.title.split(' ')[0];
    const details = h('details', {class: 'section', open: !this.#closed.has(kind)},
      h('summary', {}, icon('right', 13), h('span', {text: section.title})), ...rows);
    details.addEventListener('toggle', () => {
      if (details.open) this.#closed.delete(kind);
      else this.#closed.add(kind);
      remembered.set('closed-sections', [...this.#closed]);
    });
    return details;
  }

  #field(section, field) {
    const note = h('div', {class: 'field-note', role: 'alert'});
    const commit = (value) => this.#commit(section, field, value, element, note);
    const refuse = (text) => { note.textContent = text; };
    const input = makeInput(field, commit, refuse);
    const wide = ['vector', 'pose', 'color', 'xml'].includes(field.type);
    const element = h('div', {
      class: `field ${wide ? 'wide' : ''} ${field.fixed ? 'fixed' : ''}`, title: field.hint,
      dataset: {path: field.path, target: section.target},
    }, h('span', {class: 'field-label', text: field.label}),
    h('span', {class: 'field-input'}, input.element,
      field.unit && h('span', {class: 'unit', text: field.unit})), note);
    this.#inputs.push({key: section.key, field, input, element});
    return element;
  }

  async #commit(section, field, value, element, note) {
    note.textContent = '';
    element.classList.add('pending');
    try {
      if (field.rename) await this.#rename(section.target, value);
      else if (field.path === 'geometry.type') {
        await this.#set(section.target, 'geometry', unitGeometry(value));
      } else await this.#set(section.target, field.path, value);
      element.classList.add('taken');
      setTimeout(() => element.classList.remove('taken'), 700);
    } catch (fault) {
      note.textContent = faultText(fault);
      note.scrollIntoView({block: 'nearest'});
    }
    element.classList.remove('pending');
    this.#show();
  }

  async #rename(name, to) {
    await this.request('edit', {op: {kind: 'rename', name, to: to.trim()} });
    this.store.select([to.trim()]);
  }

  #set(target, path, value) {
    return this.request('edit', {op: {kind: 'set', target, path, value} });
  }
}
