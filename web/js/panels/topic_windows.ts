/** Windows over the view for topics that are no part of the scene: pictures and text. */
import {fill, h} from '../ui/dom.js';
import {closeButton} from '../ui/icons.js';
import type {ImageView} from '../protocol.js';
import type {TopicView} from '../topics/topics.js';
import type {Page} from './panels.js';

type TopicWindow = {element: HTMLElement, body: HTMLElement, canvas: HTMLCanvasElement|null,
    busy: boolean};

export class TopicWindows {
  #page;
  #container = h('div', {class: 'topic-windows'});
  #windows: Map<string, TopicWindow> = new Map();

  constructor(element: HTMLElement, page: Page) {
    this.#page = page;
    element.append(this.#container);
    page.topics.listen('view', ({detail}) => this.#show(detail));
    page.topics.listen('shown', () => this.#closeHidden());
  }

  /** Closes the windows of topics that are not shown any more. */
  #closeHidden() {
    const shown = new Set(this.#page.topics.shown);
    for (const [name, {element}] of this.#windows) {
      if (shown.has(name)) continue;
      element.remove();
      this.#windows.delete(name);
    }
  }

  #show({head: {topic, view}, buffer, start}: TopicView) {
    if (view.type !== 'image' && view.type !== 'text') return;
    if (!this.#page.topics.shown.includes(topic)) return;
    let opened = this.#windows.get(topic);
    if (!opened) this.#windows.set(topic, opened = this.#open(topic));
    if (view.type === 'text') showText(opened, view.text);
    else showImage(opened, view, new Uint8Array(buffer, start));
  }

  #open(topic: string): TopicWindow {
    const body = h('div', {class: 'topic-window-body'});
    const element = h(
      'section',
      {class: 'topic-window', 'aria-label': topic},
      h('header', {},
        h('h2', {text: topic, title: topic}),
        closeButton(`Close ${topic}`, () => this.#page.topics.show(topic, false))),
      body,
    );
    this.#container.append(element);
    return {element, body, canvas: null, busy: false};
  }
}

function showText({body}: TopicWindow, text: string) {
  const shown = body.querySelector('pre');
  if (shown) shown.textContent = text;
  else fill(body, h('pre', {tabindex: 0, text}));
}

async function showImage(opened: TopicWindow, {format, width, height, near, far}: ImageView,
    data: Uint8Array<ArrayBuffer>) {
  // Of pictures that come while one is being decoded the next one is newer anyway.
  if (opened.busy) return;
  opened.busy = true;
  try {
    const picture = await createImageBitmap(new Blob([data], {type: format}));
    if (!opened.canvas) {
      opened.canvas = h('canvas', {role: 'img'});
      fill(opened.body, opened.canvas, h('p', {class: 'soft'}));
    }
    const {canvas} = opened;
    if (canvas.width !== picture.width) canvas.width = picture.width;
    if (canvas.height !== picture.height) canvas.height = picture.height;
    canvas.getContext('2d')?.drawImage(picture, 0, 0);
    picture.close();
    const depth = typeof near === 'number' && typeof far === 'number'
      ? `, ${near.toFixed(2)} to ${far.toFixed(2)} m` : '';
    const said = `${width} x ${height}${depth}`;
    canvas.setAttribute('aria-label', said);
    const note = opened.body.querySelector('p');
    if (note && note.textContent !== said) note.textContent = said;
  } catch {
    fill(opened.body, h('p', {class: 'empty', text: 'The browser cannot read this picture.'}));
    opened.canvas = null;
  }
  opened.busy = false;
}
