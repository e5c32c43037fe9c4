/** The schematic view of the model editor: links as boxes, joints as lines between them. */
import {svg} from '../ui/svg.js';
import {addPanel} from '../ui/dialog.js';
import {fill, h, onActivate} from '../ui/dom.js';
import {closeButton} from '../ui/icons.js';
import {BOX, schematicOf} from './schematic_layout.js';
import type {Joint} from '../protocol.js';
import type {ModelEditor} from './model_editor.js';
import type {Edge, Placed} from './schematic_layout.js';

const LONGEST = 16;

const shortened = (text: string) => (text.length > LONGEST ? `…${text.slice(1 - LONGEST)}` : text);

export class Schematic {
  /** @param edit  opens the dialog of a joint */
  constructor(view: HTMLElement, editor: ModelEditor, edit: (joint: Joint) => unknown) {
    this.#editor = editor;
    this.#edit = edit;
    const header = h('header', {title: 'Drag to move'}, h('h2', {text: 'Schematic'}),
      closeButton('Close schematic', () => this.toggle(), 18));
    this.#element = h('section', {class: 'model-schematic', 'aria-label': 'Schematic', hidden: true}, header, this.#sheet);
    addPanel(view, this.#element, header);
  }

  #editor;
  #edit;
  #element;
  #sheet = h('div', {class: 'sheet'});

  get shown() { return !this.#element.hidden; }

  remove() { this.#element.remove(); }

  toggle() {
    this.#element.hidden = this.shown;
    this.update();
  }

  /** Draws the model as it is. */
  update() {
    if (!this.shown) return;
    const {model} = this.#editor;
    if (!model) {
      fill(this.#sheet, h('p', {class: 'soft', text: 'Add a first link.'}));
      return;
    }
    const focused = document.activeElement?.getAttribute('aria-label');
    const {links, edges, width, height} = schematicOf(model);
    fill(this.#sheet, svg('svg', {width, height, role: 'group', 'aria-label': `Links and joints of ${model.name}`},
      ...edges.map((edge) => this.#joint(edge)), ...links.map((link) => this.#link(link, model.name))));
    const again = focused && [...this.#sheet.querySelectorAll('[tabindex]')]
      .find((one) => one.getAttribute('aria-label') === focused);
    if (again instanceof SVGElement) again.focus();
  }

  #link({name, x, y}: Placed, model: string) {
    const {connect, store} = this.#editor;
    const world = name === 'world';
    const selected = store.selection.includes(`${model}::${name}`) || connect.parent === name;
    const element = svg('g', {class: `link${selected ? ' selected' : ''}${world ? ' world' : ''}`, tabindex: 0, role: 'button',
      'aria-label': world ? 'World' : `Link ${name}`, 'aria-pressed': String(selected), transform: `translate(${x} ${y})`},
    svg('title', {text: name}), svg('rect', {width: BOX.width, height: BOX.height, rx: 5}),
    svg('text', {x: BOX.width / 2, y: BOX.height / 2 + 4, text: shortened(name)}));
    onActivate(element, () => {
      if (world) connect.fromWorld();
      else store.select([`${model}::${name}`]);
    });
    return element;
  }

  #joint({joint, from, to}: Edge) {
    const [x1, y1, x2, y2] = [from.x + BOX.width / 2, from.y + BOX.height, to.x + BOX.width / 2, to.y];
    const bend = `M${x1} ${y1}C${x1} ${(y1 + y2) / 2} ${x2} ${(y1 + y2) / 2} ${x2} ${y2}`;
    const element = svg('g', {class: `joint ${joint.type}`, tabindex: 0, role: 'button',
      'aria-label': `Joint ${joint.name}: ${joint.type}`},
    svg('title', {text: `${joint.name}: ${joint.type}`}), svg('path', {class: 'reach', d: bend}), svg('path', {d: bend}),
    svg('text', {x: (x1 + x2) / 2, y: (y1 + y2) / 2 + 3, text: joint.type}));
    onActivate(element, () => this.#edit(joint));
    return element;
  }
}
