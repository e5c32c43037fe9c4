/** The palette of the model editor: what can be added, and what the model has. */
import {addPanel, askText, Dialog, labelled} from '../ui/dialog.js';
import {fill, h, textButton as button} from '../ui/dom.js';
import {closeButton} from '../ui/icons.js';
import {jointDialog} from './joint_dialog.js';
import {isLinkOf, JOINT_TYPES, jointText, pluginText, resizing, sizeOf} from '../model_edits.js';
import {meshDialog} from './model_files.js';
import {Schematic} from './schematic.js';
import {SOLID_SHAPES, solidModel} from './solids.js';
import {svgDialog} from './svg_dialog.js';
import {pluginFor, PLUGIN_TITLES} from './plugin_templates.js';
import type {Joint, Model, Operation, Operations, SolidShape} from '../protocol.js';
import type {ModelEditor} from './model_editor.js';

const capital = (text: string) => text[0].toUpperCase() + text.slice(1);

export class Palette {
  editor;
  schematic;

  constructor(view: HTMLElement, editor: ModelEditor) {
    this.editor = editor;
    editor.connect.onChange = () => this.update();
    this.#type = h('select', {'aria-label': 'Joint type', onchange: () => { editor.connect.type = this.#type.value; }},
      ...JOINT_TYPES.map((type) => h('option', {value: type, text: capital(type)})));
    this.#connect = button('Connect', () => editor.connect.toggle(), {title: 'Click the parent link, then the child link'});
    const header = h('header', {title: 'Drag to move'}, h('h2', {text: 'Model Editor'}),
      closeButton('Exit model editor (Ctrl+M)', () => editor.close(), 18));
    this.#element = h('section', {class: 'model-palette', 'aria-label': 'Model editor'},
      header,
      this.#start,
      this.#ofModel(h('label', {class: 'model-name'}, 'Name', this.#name)),
      this.#ofModel(h('div', {class: 'flags'}, this.#flag('static', 'Static'), this.#flag('allow_auto_disable', 'Auto disable'))),
      h('h3', {text: 'Add link'}),
      h('div', {class: 'tools'}, ...SOLID_SHAPES.map((shape) =>
        button(capital(shape), () => this.#startPlacing(shape), {'aria-label': `Link: ${shape}`})),
      button('Mesh…', () => meshDialog(editor.request, (uri) => this.#addLink({uri}))),
      button('SVG…', () => svgDialog((polyline) => this.#addLink({polyline})), {title: 'Extrude the outline of a drawing'}), button('Model…', () => this.#nest())),
      this.#ofModel(h('h3', {text: 'Joints'})),
      this.#ofModel(h('div', {class: 'row'}, this.#type, this.#connect)),
      this.#ofModel(button('Schematic', () => this.schematic.toggle(), {title: 'Links and joints as a diagram (Ctrl+E)'})),
      this.#hint, this.#joints, this.#parts,
      this.#ofModel(h('h3', {text: 'Model'})),
      this.#ofModel(h('div', {class: 'tools'}, button('Plugins…', () => this.#plugins()),
        button('Inertia…', () => this.#inertia(this.model?.name), {'aria-label': 'Inertia of all links'}))),
      this.#ofModel(h('div', {class: 'tools'}, button('Save', () => editor.save(), {class: 'primary', title: 'Save (Ctrl+S)'}),
        button('Save As…', () => editor.save(true)))));
    addPanel(view, this.#element, header);
    this.schematic = new Schematic(view, editor, (joint) => this.model && this.#editJoint(this.model, joint));
  }

  #flags: {path: 'static'|'allow_auto_disable', input: HTMLInputElement}[] = [];
  #element;
  #name = h('input', {'aria-label': 'Model name',
    onchange: () => this.#rename()});
  #type;
  #connect;
  #hint = h('p', {class: 'hint', role: 'status'});
  #joints = h('ul', {class: 'model-joints', 'aria-label': 'Joints of the model'});
  #parts = h('div', {class: 'model-parts'});
  #start = h('p', {class: 'hint', text: 'Choose a shape and click in the view: it becomes the first link.'});
  /** What is of use only once there is a model. */
  #later: HTMLElement[] = [];

  get model() { return this.editor.model; }

  remove() {
    this.#element.remove();
    this.schematic.remove();
  }

  #ofModel(element: HTMLElement) {
    this.#later.push(element);
    return element;
  }

  #flag(path: 'static'|'allow_auto_disable', title: string) {
    const input = h('input', {type: 'checkbox'});
    input.addEventListener('change', () => {
      if (this.model) this.editor.actions.setProperty(this.model.name, path, input.checked);
    });
    this.#flags.push({path, input});
    return h('label', {}, input, title);
  }

  /** Shows the model as it is. */
  update() {
    const {model} = this;
    const {connect} = this.editor;
    if (document.activeElement !== this.#name) this.#name.value = model?.name ?? '';
    this.#start.hidden = Boolean(model);
    for (const element of this.#later) element.hidden = !model;
    for (const {path, input} of this.#flags) {
      input.checked = Boolean(model?.[path]);
    }
    this.#connect.setAttribute('aria-pressed', String(connect.active));
    this.#hint.textContent = connect.hint;
    const world = button('World as parent', () => connect.fromWorld(), {class: 'plain'});
    if (connect.active && model) this.#hint.append(' ', this.#linkList(model));
    if (connect.active && connect.parent === null) this.#hint.append(' ', world);
    fill(this.#joints, ...(model?.joints ?? []).map((joint) => h('li', {},
      button(jointText(joint), () => model && this.#editJoint(model, joint), {class: 'plain wide', title: `Edit ${joint.name}`}))));
    this.#showParts(model);
    this.schematic.update();
  }

  /** The links that the joint can connect next, for those that the view hides. */
  #linkList(model: Model) {
    const {connect} = this.editor;
    const list = h('select', {'aria-label': connect.parent === null ? 'Parent link' : 'Child link'},
      h('option', {value: '', text: 'Choose a link', disabled: true, selected: true}),
      ...model.links.filter(({name}) => name !== connect.parent).map(({name}) => h('option', {value: name, text: name})));
    list.addEventListener('change', () => connect.choose(list.value));
    return list;
  }

  /** What can be done with the selected link. */
  #showParts(model: Model|undefined) {
    const target = this.editor.store.selection.at(-1) ?? '';
    if (!model || !isLinkOf(model, target)) {
      fill(this.#parts);
      return;
    }
    const link = target.slice(model.name.length + 2);
    const shapes = h('select', {'aria-label': 'Shape to add'}, ...SOLID_SHAPES.map((shape) =>
      h('option', {value: shape, text: capital(shape)})));
    const add = (part: 'visual'|'collision') => this.#edit({kind: 'add_shape', link: target, part,
      shape: shapes.value as SolidShape});
    fill(this.#parts, h('h3', {text: `Link ${link}`}),
      h('div', {class: 'row'}, shapes),
      h('div', {class: 'tools'}, button('Add visual', () => add('visual')), button('Add collision', () => add('collision')),
        button('Rename…', () => this.#renameLink(target, link)), button('Inertia…', () => this.#inertia(target)),
        button('Shapes…', () => this.#shapes(model, target)), button('Size…', () => this.#resize(model, target)),
        button('Remove', () => this.#edit({kind: 'remove_part', target}), {class: 'danger'})));
  }

  async #edit(op: Operation) { return this.editor.actions.edit(op); }

  /** A request of a dialog: rejects with what is wrong. */
  async #asked(op: Operation) {
    await this.editor.request('edit', {op});
    return true;
  }

  #startPlacing(shape: SolidShape) {
    const {store} = this.editor;
    store.setPlacing({kind: 'model', document: solidModel(shape),
      op: (pose) => ({kind: 'add_link', model: store.modelEditing?.name ?? null, shape, pose})});
  }

  async #rename() {
    const {model} = this;
    if (model && this.#name.value.trim() !== model.name) await this.editor.actions.rename(model.name, this.#name.value.trim());
    this.update();
  }

  async #addLink(shape: Pick<Operations['add_link'], 'uri'|'polyline'>) {
    const {store, request, actions} = this.editor;
    const {name} = await request('edit', {op: {kind: 'add_link', model: store.modelEditing?.name ?? null, ...shape}});
    actions.placed(name ?? '');
  }

  #nest() {
    const {model} = this;
    if (!model) {
      this.editor.notices.say('Add a link first; models are nested in it from the Insert tab, or here.');
      return;
    }
    return askText('Nest Model', {label: 'URI', value: 'model://',
      note: 'It then follows the mouse. Models of the Insert tab are nested, too, while the model editor is open.'}, 'Nest', async (uri) => {
      const outcome = await this.editor.actions.insertModel(uri);
      if (!outcome.ok) throw new Error(outcome.issues[0]?.message);
    });
  }

  #editJoint(model: Model, joint: Joint) {
    const name = `${model.name}::${joint.name}`;
    return jointDialog(model, joint, {
      apply: (values) => this.#asked({kind: 'edit_joint', joint: name, values}),
      remove: () => this.#asked({kind: 'remove_part', target: name}),
    });
  }

  #renameLink(link: string, name: string) {
    return askText(`Rename ${link}`, {label: 'Name', value: name}, 'Rename', async (to) => {
      const reply = await this.editor.request('edit', {op: {kind: 'rename_link', link, to}});
      if (reply.name) this.editor.store.select([reply.name]);
    });
  }

  /** One size for the collision, the visual and the inertia of a link. */
  #resize(model: Model, target: string) {
    const link = model.links.find((one) => `${model.name}::${one.name}` === target);
    const size = link ? sizeOf(link) : [];
    if (!link || !size.length) {
      this.editor.notices.say('The first collision of this link has no size in numbers.');
      return undefined;
    }
    const inputs = size.map(({label, value}) => h('input', {type: 'number', value, min: 0, step: 'any',
      'aria-label': label}));
    return new Dialog({title: `Size of ${target}`, content: [
      h('p', {class: 'soft', text: 'For the collision, for the visual of the same shape, and for the inertia. The mass stays.'}),
      ...size.map(({label}, at) => labelled(`${label} (m)`, inputs[at])),
    ], buttons: [{title: 'Cancel'}, {title: 'OK', primary: true, run: () => {
      if (!inputs.every(({valueAsNumber}) => valueAsNumber > 0)) throw new Error('Each length must be greater than 0 m.');
      return this.#asked(resizing(target, link, size.map((one, at) => ({...one, value: inputs[at].valueAsNumber}))));
    }}]}).open();
  }

  /** What a link consists of, to take away. */
  #shapes(model: Model, target: string) {
    const link = model.links.find((one) => `${model.name}::${one.name}` === target);
    const rows = (kind: 'visual'|'collision') =>
        (kind === 'visual' ? link?.visuals ?? [] : link?.collisions ?? []).map(({name, geometry}) => {
      const row = h('div', {class: 'row'}, h('span', {text: `${kind} ${name} (${geometry.type})`}), h('span', {class: 'spring'}),
        button('Remove', async () => {
          const outcome = await this.#edit({kind: 'remove_part', target: `${target}::${kind}:${name}`});
          if (outcome.ok) row.remove();
        }, {class: 'danger'}));
      return row;
    });
    return new Dialog({title: `Shapes of ${target}`, buttons: [{title: 'Close', primary: true}],
      content: [h('p', {class: 'soft', text: 'Sizes, poses, materials and surfaces are in the property panel.'}),
        ...rows('visual'), ...rows('collision')]}).open();
  }

  #inertia(target: string|undefined) {
    if (!target) return;
    const density = h('input', {type: 'number', value: 1000, min: 0, step: 'any', 'aria-label': 'Density'});
    const kept = h('input', {type: 'checkbox', checked: true});
    return new Dialog({title: `Inertia of ${target}`, content: [
      h('p', {text: 'From the collisions, as solid bodies of one density.'}),
      h('label', {}, kept, 'Keep the mass'), labelled('Density (kg/m³)', density),
    ], buttons: [{title: 'Cancel'}, {title: 'Compute', primary: true, run: () => this.#asked({
      kind: 'compute_inertial', target, density: kept.checked ? null : density.valueAsNumber})}]}).open();
  }

  #plugins() {
    const {model} = this;
    if (!model) return;
    const text = h('textarea', {class: 'plugin-text', 'aria-label': 'Plugins', rows: 14});
    text.value = pluginText(model);
    const add = h('select', {'aria-label': 'Add', onchange: () => {
      text.value = [text.value.trim(), pluginFor(add.value, model, text.value)].filter(Boolean).join('\n');
      add.value = '';
      text.scrollTop = text.scrollHeight;
    }}, h('option', {value: '', text: 'Add…'}), ...PLUGIN_TITLES.map((title) => h('option', {value: title, text: title})));
    return new Dialog({title: `Plugins of ${model.name}`, name: 'model-plugins',
      content: [h('p', {class: 'soft', text: 'The plugins of the model, as <plugin> elements of SDF. Add… writes one with the joints of the model.'}),
        add, text],
      buttons: [{title: 'Cancel'}, {title: 'OK', primary: true, run: () =>
        this.#asked({kind: 'set_plugins', model: model.name, text: text.value})}]}).open();
  }
}
