/**
 * The Insert tab: simple shapes, then the model database by location, each model with its picture.
 * A click takes the model in hand: it then follows the mouse over the view until it is placed.
 */
import {askText} from '../ui/dialog.js';
import {elementsOf, fill, h, onActivate, remembered} from '../ui/dom.js';
import {bytesText} from '../ui/text_format.js';
import {closeButton, icon} from '../ui/icons.js';
import {TemplateCards} from './template_cards.js';
import type {LibraryModel, Location, Pushes} from '../protocol.js';
import type {Page} from './panels.js';

/** The locations with the models that a search leaves. Pure. */
export function searched(locations: Location[], wanted: string) {
  const word = wanted.trim().toLowerCase();
  if (!word) return locations;
  const fits = ({title, name, description}: LibraryModel) =>
    [title, name, description].some((text) => text?.toLowerCase().includes(word));
  return locations
    .map((location) => ({...location, models: location.models.filter(fits)}))
    .filter((location) => location.models.length);
}

export class InsertTab {
  page;
  locations: Location[]|null = null;

  constructor(element: HTMLElement, page: Page) {
    this.page = page;
    this.#templates = new TemplateCards(page);
    fill(
      element,
      h(
        'div',
        {class: 'filter'},
        this.#search,
        h('button', {title: 'Add model path', onclick: () => this.#addPath()}, icon('add', 15), 'Add Path'),
      ),
      this.#progress,
      h('div', {class: 'library'}, this.#templates.element, this.#list),
    );
    this.#list.addEventListener('keydown', (event) => this.#key(event));
    page.store.listen('library', (event) => this.#take(event.detail.locations));
    page.store.listen('placing', () => this.#markPlaced());
    page.connection.listen('message', ({detail}) => {
      if (detail.type === 'download') this.#showDownload(detail);
    });
    page.store.listen('connection', () => {
      if (this.locations && page.store.connected) this.load();
    });
    this.#show();
  }

  #search = h('input', {
    type: 'search',
    placeholder: 'Find: chair, kitchen…',
    'aria-label': 'Find a model',
    oninput: () => this.#show(),
  });
  #templates;
  #list = h('div', {class: 'models'});
  #progress = h('div', {class: 'download', role: 'status', hidden: true});
  #hide: ReturnType<typeof setTimeout>|0 = 0;
  #closed = new Set(remembered.get('closed-locations', [] as string[]));

  /** Asks for the library; called when the tab is first seen. */
  async load() {
    if (!this.locations) this.#templates.load();
    try {
      this.#take((await this.page.request('library')).locations);
    } catch (fault) {
      this.page.notices.fault(fault);
    }
  }

  #take(locations: Location[]) {
    this.locations = locations;
    this.#show();
  }

  #show() {
    if (!this.locations) {
      fill(this.#list, h('p', {class: 'empty', text: 'Loading models…'}));
      return;
    }
    this.#templates.filter(this.#search.value);
    const found = searched(this.locations, this.#search.value);
    const at = document.activeElement instanceof HTMLElement
      ? document.activeElement.dataset.uri : undefined;
    fill(
      this.#list,
      ...(found.length
        ? found.map((location) => this.#location(location))
        : [h('p', {class: 'empty', text: 'No matching models'})]),
    );
    if (at)
      elementsOf(this.#list, '.model-card')
        .find((card) => card.dataset.uri === at)
        ?.focus();
  }

  #location(location: Location) {
    const body = location.problem
      ? h('p', {class: 'empty', text: location.problem})
      : location.models.length
        ? h('div', {class: 'model-grid'}, ...location.models.map((model) => this.#model(model)))
        : h('p', {class: 'empty', text: 'No models in this folder'});
    const details = h(
      'details',
      {class: 'section', open: !this.#closed.has(location.id)},
      h(
        'summary',
        {title: location.path},
        icon('right', 13),
        h('span', {text: location.title}),
        h('span', {class: 'tag', text: String(location.models.length)}),
      ),
      body,
    );
    details.addEventListener('toggle', () => {
      if (details.open) this.#closed.delete(location.id);
      else this.#closed.add(location.id);
      remembered.set('closed-locations', [...this.#closed]);
    });
    if (location.kind !== 'added') return details;
    // Beside the summary: screen readers announce no button inside of it.
    return h('div', {class: 'removable'}, details,
      closeButton(`Remove ${location.title}`, () => void this.#removePath(location)));
  }

  #model(model: LibraryModel) {
    const card = h(
      'div',
      {
        class: 'model-card',
        role: 'button',
        tabindex: 0,
        draggable: 'true',
        dataset: {uri: model.uri},
        title: model.description || model.title || model.name,
        'aria-label': model.title || model.name,
        ondragstart: (event) => {
          event.dataTransfer?.setData('text/x-model-uri', model.uri);
          if (event.dataTransfer) event.dataTransfer.effectAllowed = 'copy';
          // Its ghost follows the drag.
          void this.#insert(model);
        },
        ondragend: (event) => {
          const dropped = event.dataTransfer?.dropEffect !== 'none';
          if (!dropped && this.page.store.placing?.uri === model.uri) this.page.store.setPlacing(null);
        },
      },
      this.#picture(model),
      h('span', {class: 'label', text: model.title || model.name}),
    );
    onActivate(card, () => this.#insert(model));
    return card;
  }

  #picture(model: LibraryModel) {
    const frame = h('span', {class: 'thumb'}, icon('model', 26));
    if (!model.thumb) return frame;
    const image = h('img', {
      alt: '',
      loading: 'lazy',
      src: model.thumb,
      draggable: 'false',
      onload: () => { fill(frame, image); },
      onerror: () => this.#render(model, frame),
    });
    frame.append(image);
    return frame;
  }

  /** A model without a picture gets one from the view, when that can draw it. */
  async #render(model: LibraryModel, frame: HTMLElement) {
    frame.querySelector('img')?.remove();
    const picture = await this.page.view?.thumbnail(model.uri, model.thumb);
    if (picture && frame.isConnected) {
      fill(frame, h('img', {alt: '', src: picture, draggable: 'false'}));
    }
  }

  async #insert(model: LibraryModel) {
    const card = elementsOf(this.#list, '.model-card').find(
      (one) => one.dataset.uri === model.uri,
    );
    card?.classList.add('pending');
    await this.page.actions.insertModel(model.uri);
    card?.classList.remove('pending');
  }

  #markPlaced() {
    const uri = this.page.store.placing?.uri;
    for (const card of elementsOf(this.#list, '.model-card')) {
      card.classList.toggle('chosen', Boolean(uri) && card.dataset.uri === uri);
    }
  }

  #showDownload({name, done, expected}: Pushes['download']) {
    clearTimeout(this.#hide);
    this.#progress.hidden = false;
    const known = expected > 0;
    fill(
      this.#progress,
      h('span', {
        text: `Downloading ${name}: ${bytesText(done)}${known ? ` of ${bytesText(expected)}` : ''}`,
      }),
      h('progress', known ? {max: expected, value: done} : {}),
    );
    const over = known && done >= expected;
    this.#hide = setTimeout(
      () => {
        this.#progress.hidden = true;
      },
      over ? 800 : 15000,
    );
  }

  #key(event: KeyboardEvent) {
    const cards = elementsOf(this.#list, '.model-card').filter(
      (card) => card.offsetParent,
    );
    const at = cards.findIndex((card) => card === document.activeElement);
    if (at < 0) return;
    const columns = cards.filter((card) => card.offsetTop === cards[at].offsetTop).length || 1;
    const to = {
      ArrowLeft: at - 1,
      ArrowRight: at + 1,
      ArrowUp: at - columns,
      ArrowDown: at + columns,
      Home: 0,
      End: cards.length - 1,
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    cards[Math.min(Math.max(to, 0), cards.length - 1)].focus();
  }

  #addPath() {
    void askText('Add Path', {label: 'Model directory', placeholder: '/home/me/models'}, 'Add', async (path) =>
      this.#take((await this.page.request('library_add', {path})).locations));
  }

  async #removePath(location: Location) {
    try {
      this.#take((await this.page.request('library_remove', {path: location.path})).locations);
    } catch (fault) {
      this.page.notices.fault(fault);
    }
  }
}
