/** The building editor and the robot templates, at the top of the Insert tab. */
import {templateDialog} from './dialogs/template_dialog.js';
import {elementsOf, fill, h, onActivate} from '../ui/dom.js';
import {icon} from '../ui/icons.js';
import type {Page} from './panels.js';
import type {Template} from '../protocol.js';

const ICONS: Record<string, string> = {differential_drive: 'car', four_wheels: 'car', arm: 'joints',
    camera: 'camera', laser: 'topics', imu: 'frames'};

export class TemplateCards {
  #page;
  #grid = h('div', {class: 'model-grid'});
  element = h('details', {class: 'section templates', open: true},
    h('summary', {}, icon('right', 13), h('span', {text: 'Buildings, robots and sensors'})), this.#grid);

  constructor(page: Page) {
    this.#page = page;
  }

  /** Asks for the templates; called when the tab is first seen. */
  async load() {
    try {
      const {templates} = await this.#page.request('templates');
      fill(this.#grid, this.#building(), ...templates.map((template) => this.#card(template)));
    } catch (fault) {
      this.#page.notices.fault(fault);
    }
  }

  /** Leaves the cards whose title or description contains a text. */
  filter(wanted: string) {
    const word = wanted.trim().toLowerCase();
    const cards = elementsOf(this.#grid, '.template-card');
    for (const one of cards) one.hidden = !`${one.textContent} ${one.title}`.toLowerCase().includes(word);
    this.element.hidden = cards.length > 0 && cards.every((one) => one.hidden);
  }

  #building() {
    return card({icon: 'building', title: 'Draw a building', label: 'Draw a building',
      hint: 'Draw walls, doors and windows in the building editor (Ctrl+B).',
      run: () => this.#page.store.emit('dialog', {name: 'building'})});
  }

  #card(template: Template) {
    return card({icon: ICONS[template.name] ?? 'model', title: template.title,
      label: `Template: ${template.title}`, hint: template.description,
      run: () => templateDialog(this.#page, template)});
  }
}

function card({icon: shown, title, label, hint, run}: {icon: string, title: string, label: string,
    hint: string, run: () => void}) {
  const element = h('div', {class: 'template-card', role: 'button', tabindex: 0, title: hint,
    'aria-label': label},
  h('span', {class: 'thumb'}, icon(shown, 26)), h('span', {class: 'label', text: title}));
  onActivate(element, run);
  return element;
}
