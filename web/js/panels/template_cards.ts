/** The robot templates at the top of the Insert tab. */
import {templateDialog} from './dialogs/template_dialog.js';
import {fill, h, onActivate} from '../ui/dom.js';
import {icon} from '../ui/icons.js';
import type {Page} from './panels.js';
import type {Template} from '../protocol.js';

const ICONS: Record<string, string> = {differential_drive: 'car', four_wheels: 'car', arm: 'joints',
    camera: 'camera', laser: 'topics', imu: 'frames'};

export class TemplateCards {
  element;

  constructor(page: Page) {
    this.#page = page;
    this.element = h('details', {class: 'section templates', open: true},
      h('summary', {}, icon('right', 13), h('span', {text: 'Robots and sensors'})), this.#grid);
  }

  #page;
  #grid = h('div', {class: 'model-grid'});

  /** Asks for the templates; called when the tab is first seen. */
  async load() {
    try {
      const {templates} = await this.#page.request('templates');
      fill(this.#grid, ...templates.map((template) => this.#card(template)));
    } catch (fault) {
      this.#page.notices.fault(fault);
    }
  }

  #card(template: Template) {
    const card = h('div', {class: 'template-card', role: 'button', tabindex: 0, title: template.description,
      'aria-label': `Template: ${template.title}`},
    h('span', {class: 'thumb'}, icon(ICONS[template.name] ?? 'model', 26)), h('span', {class: 'label', text: template.title}));
    onActivate(card, () => templateDialog(this.#page, template));
    return card;
  }
}
