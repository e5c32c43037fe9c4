/**
 * The Topics panel lists all ROS topics with their types. A ticked topic is shown in the view or in
 * a separate window, with its rate and bandwidth. Only topics that are shown are subscribed to.
 */
import {fill, h} from '../ui/dom.js';
import {bandwidthText, rateText} from '../ui/text_format.js';
import type {Topic} from '../protocol.js';
import type {Page} from './panels.js';

export class TopicsPanel {
  page;

  constructor(element: HTMLElement, page: Page) {
    this.page = page;
    this.#sensing.addEventListener('change', () => page.topics.sense(this.#sensing.checked));
    const {speeds} = page.driving;
    const speed = (key: keyof typeof speeds, title: string, unit: string) =>
      h(
        'label',
        {},
        title,
        h('input', {
          type: 'number', min: 0.01, step: 0.05, value: speeds[key], 'aria-label': title,
          onchange: (event) => {
            const value = event.target instanceof HTMLInputElement ? event.target.valueAsNumber : 0;
            if (value > 0) speeds[key] = value;
          },
        }),
        h('span', {class: 'unit', text: unit}),
      );
    fill(
      element,
      h('h2', {class: 'properties-title', text: 'Topics'}),
      h('div', {class: 'filter'}, this.#filter),
      h('label', {class: 'topic-sensing'}, this.#sensing, 'Show what the selected robot senses'),
      this.#list,
      h('details', {class: 'section drive-speeds'},
        h('summary', {text: 'Arrow keys drive the selected robot'}),
        speed('speed', 'Speed', 'm/s'), speed('turn', 'Turn', 'rad/s')),
    );
    const {topics} = page;
    for (const event of ['list', 'shown', 'problem'] as const) {
      topics.listen(event, () => this.#update());
    }
  }

  #filter = h('input', {
    type: 'search',
    placeholder: 'Find a topic or type',
    'aria-label': 'Find a topic or type',
    oninput: () => this.#update(),
  });
  #list = h('ul', {class: 'topic-list', 'aria-label': 'Topics'});
  #sensing = h('input', {type: 'checkbox'});
  #off: (() => void)|null = null;
  #signature = '';
  #rows: Map<string, {box: HTMLInputElement, measured: HTMLElement, problem: HTMLElement}> = new Map();

  /** A closed panel asks for nothing. */
  show(shown: boolean) {
    if (shown) this.#off ??= this.page.topics.read();
    else {
      this.#off?.();
      this.#off = null;
    }
    this.#update();
  }

  #update() {
    if (!this.#off) return;
    const {topics} = this.page;
    this.#sensing.checked = topics.sensing;
    const word = this.#filter.value.trim().toLowerCase();
    const found = topics.list.filter(({name, type}) =>
      !word || name.toLowerCase().includes(word) || type.toLowerCase().includes(word));
    const signature = JSON.stringify([topics.available, word,
      found.map(({name, type, publishers}) => [name, type, publishers > 0])]);
    if (signature !== this.#signature) {
      this.#signature = signature;
      this.#build(found);
    }
    const shown = new Set(topics.shown);
    for (const topic of found) this.#refresh(topic, shown.has(topic.name));
  }

  #build(found: Topic[]) {
    this.#rows.clear();
    const {topics} = this.page;
    const empty = topics.available ? 'No topics' : 'The simulator runs without ROS.';
    fill(
      this.#list,
      ...found.map((topic) => this.#row(topic)),
      !found.length && h('li', {class: 'empty', text: empty}),
    );
  }

  #row({name, type, publishers}: Topic) {
    const box = h('input', {type: 'checkbox', 'aria-label': `Show ${name}`});
    box.addEventListener('change', () => this.page.topics.show(name, box.checked));
    const measured = h('span', {class: 'topic-rate'});
    const problem = h('div', {class: 'field-note', role: 'status'});
    this.#rows.set(name, {box, measured, problem});
    return h(
      'li',
      {class: publishers ? '' : 'quiet', title: publishers ? name : `${name}: nobody publishes it`},
      h('label', {}, box, h('span', {class: 'topic-name', text: name}), measured,
        h('span', {class: 'topic-type', text: type || 'unknown type'})),
      problem,
    );
  }

  #refresh(topic: Topic, shown: boolean) {
    const row = this.#rows.get(topic.name);
    if (!row) return;
    row.box.checked = shown;
    const {hz, bytes_per_s: size} = topic;
    row.measured.textContent = shown && typeof hz === 'number'
      ? `${rateText(hz)}, ${bandwidthText(size ?? 0)}` : '';
    row.problem.textContent = (shown && this.page.topics.problems.get(topic.name)) || '';
  }
}
