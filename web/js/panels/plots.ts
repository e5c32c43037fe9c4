/**
 * The plot window, docked below the view: a palette of everything that can be plotted, any number
 * of canvases, any number of curves on each, drawn as the values come.
 */
import {saveBlob} from '../actions.js';
import {elementsOf, fill, h, onActivate, onceAFrame, roving} from '../ui/dom.js';
import {closeButton, icon} from '../ui/icons.js';
import {drawPlot, freeColor, legendEntry} from '../ui/plot_canvas.js';
import {csvOf, Series, take} from '../ui/plot_data.js';
import {isTopicField, topicVariables, variablesOf} from './plot_variables.js';
import type {Curve} from '../ui/plot_canvas.js';
import type {Pushes} from '../protocol.js';
import type {Page} from './panels.js';

/** The time spans to choose from, s; null: all. */
const SPANS: [string, number|null][] = [
  ['5 s', 5],
  ['10 s', 10],
  ['30 s', 30],
  ['2 min', 120],
  ['all', null],
];
const SHOWN = 300;

/** The samples of a variable that canvases show. */
type Kept = {series: Series, uses: number, off: () => void,
    problem?: string|null};

export class Plots {
  page;
  span: number|null = 10;

  constructor(element: HTMLElement, page: Page, close: () => void) {
    this.page = page;
    const span = h(
      'select',
      {
        'aria-label': 'Time span',
        onchange: () => {
          this.span = SPANS[span.selectedIndex][1];
          this.#draw();
        },
      },
      ...SPANS.map(([title, value]) => h('option', {text: title, selected: value === 10})),
    );
    const tool = (glyph: string, text: string, run: () => void) =>
      h('button', {onclick: run}, icon(glyph, 14), text);
    const bar = h(
      'div',
      {class: 'dock-bar', role: 'toolbar', 'aria-label': 'Plots'},
      h('h2', {text: 'Plots'}),
      tool('add', 'Canvas', () => this.addCanvas()),
      span,
      tool('export', 'CSV', () => this.exportCsv()),
      tool('export', 'PNG', () => this.exportPng()),
      tool('trash', 'Clear', () => this.clear()),
      h('span', {class: 'spring'}),
      closeButton('Close plots', close, 15),
    );
    fill(
      element,
      bar,
      h(
        'div',
        {class: 'plots'},
        h('div', {class: 'plot-palette'}, this.#search, this.#list),
        this.#canvases,
      ),
    );
    roving(this.#list, '[role=option]', {vertical: true, wrap: false});
    this.#draw = onceAFrame(() =>
      this.#plots.forEach((plot) => plot.draw(this.span, page.store.stats.sim_ns * 1e-9)),
    );
    const palette = onceAFrame(() => {
      if (!element.hidden) this.#showPalette();
    });
    page.store.listen('watch', (event) => this.#take(event.detail));
    page.store.listen('stats', () => {
      if (!element.hidden && this.#series.size) this.#draw();
    });
    for (const event of ['document', 'entity', 'selection'] as const)
      page.store.listen(event, palette);
    page.topics.listen('list', palette);
    new ResizeObserver(this.#draw).observe(this.#canvases);
    this.addCanvas();
    this.#showPalette();
  }

  #search = h('input', {
    type: 'search',
    placeholder: 'Find a variable',
    'aria-label': 'Find a variable',
    oninput: () => this.#showPalette(),
  });
  #list = h('div', {class: 'plot-variables', role: 'listbox', 'aria-label': 'Variables'});
  #canvases = h('div', {class: 'plot-canvases'});
  #draw;
  #plots: Plot[] = [];
  #series: Map<string, Kept> = new Map();
  #current: Plot|null = null;
  /** Of the topics that are opened in the palette. */
  #fields: Map<string, string[]> = new Map();
  #unread: (() => void)|undefined;
  #signature = '';

  addCanvas() {
    const plot = new Plot(this);
    this.#plots.push(plot);
    this.#canvases.append(plot.element);
    this.choose(plot);
    this.#draw();
    return plot;
  }

  /** A closed window asks for no topics. */
  show(shown: boolean) {
    this.#unread?.();
    this.#unread = shown ? this.page.topics.read() : undefined;
    this.#draw();
  }

  /** Variables that are double-clicked go to this canvas. */
  choose(plot: Plot) {
    this.#current = plot;
    for (const one of this.#plots) one.element.classList.toggle('current', one === plot);
  }

  /** Asks for a variable, or finds it where another canvas shows it already. */
  series(variable: string) {
    let kept = this.#series.get(variable);
    if (!kept) {
      kept = {
        series: new Series(variable),
        uses: 0,
        off: this.page.watches.add(`plot:${variable}`),
      };
      this.#series.set(variable, kept);
    }
    kept.uses += 1;
    return kept.series;
  }

  release(variable: string) {
    const kept = this.#series.get(variable);
    if (!kept) return;
    kept.uses -= 1;
    if (kept.uses) return;
    kept.off();
    this.#series.delete(variable);
  }

  remove(plot: Plot) {
    this.#plots = this.#plots.filter((one) => one !== plot);
    plot.element.remove();
    if (!this.#plots.length) this.addCanvas();
    else this.choose(this.#plots[this.#plots.length - 1]);
  }

  redraw() {
    this.#draw();
  }

  clear() {
    for (const series of this.#all) series.clear();
    this.#draw();
  }

  get #all() {
    return [...this.#series.values()].map(({series}) => series);
  }

  exportCsv() {
    if (!this.#series.size) this.page.notices.say('No curves to export');
    else saveBlob(new Blob([csvOf(this.#all)], {type: 'text/csv'}), 'plot.csv');
  }

  /** The canvases below each other in one picture. */
  exportPng() {
    const sheets = this.#plots.map(({canvas}) => canvas);
    const whole = h('canvas', {
      width: Math.max(...sheets.map(({width}) => width)),
      height: sheets.reduce((sum, {height}) => sum + height, 0),
    });
    let top = 0;
    for (const sheet of sheets) {
      whole.getContext('2d')?.drawImage(sheet, 0, top);
      top += sheet.height;
    }
    whole.toBlob((blob) => blob && saveBlob(blob, 'plot.png'), 'image/png');
  }

  #take(push: Pushes['watch']) {
    const {topic, problem} = push;
    if (!topic.startsWith('plot:')) return;
    const kept = this.#series.get(topic.slice(5));
    if (!kept) return;
    if (problem && kept.problem !== problem) this.page.notices.say(`${topic.slice(5)}: ${problem}`);
    kept.problem = problem ?? null;
    take(this.#all, kept.series, push);
    this.#draw();
  }

  #showPalette() {
    const typed = this.#search.value.trim();
    const word = typed.toLowerCase();
    const chosen = new Set(this.page.store.selection.map((name) => this.page.store.split(name)[0]?.name));
    const groups = variablesOf(this.page.store.document).sort(
      (a, b) => Number(chosen.has(b.owner)) - Number(chosen.has(a.owner)),
    );
    const {topics} = this.page;
    groups.push({owner: 'Topics', variables: topicVariables(topics.list, this.#fields)});
    const found = groups.flatMap(({owner, variables}) =>
      variables
        .filter((variable) => !word || variable.toLowerCase().includes(word))
        .map((variable) => ({owner, variable})),
    );
    // An item of a long list, which the palette does not show.
    if (!found.length && isTopicField(typed)) found.push({owner: 'Topics', variable: typed});
    const shown = found.slice(0, SHOWN);
    const signature = JSON.stringify([found, [...this.#series.keys()], [...this.#fields.keys()]]);
    if (signature === this.#signature) return;
    this.#signature = signature;
    const focused = this.#list.contains(document.activeElement) && document.activeElement?.textContent;
    fill(
      this.#list,
      ...[...new Set(shown.map(({owner}) => owner))].map((owner) =>
        h('div', {role: 'group', 'aria-label': owner},
          h('h3', {role: 'presentation', text: owner}),
          ...shown.filter((one) => one.owner === owner).map(({variable}) => this.#option(variable)))),
      found.length > SHOWN &&
        h('p', {class: 'empty', text: `${found.length - SHOWN} more: refine the search`}),
    );
    const options = elementsOf(this.#list, '[role=option]');
    const kept = options.find(({textContent}) => textContent === focused);
    (kept ?? options[0])?.setAttribute('tabindex', '0');
    kept?.focus();
  }

  /** Shows or hides the numbers of a topic. */
  async #open(topic: string) {
    if (!this.#fields.delete(topic)) {
      this.#fields.set(topic, (await this.page.request('topic_fields', {topic})).fields);
    }
    this.#showPalette();
  }

  #topic(topic: string) {
    const option = h('div', {
      class: 'plot-variable', role: 'option', tabindex: -1, text: topic, 'aria-selected': 'false',
      title: 'Click to list the numbers of its messages',
    });
    onActivate(option, () => this.#open(topic).catch((fault) => this.page.notices.fault(fault)));
    return option;
  }

  #option(variable: string) {
    if (variable.startsWith('/') && !isTopicField(variable)) return this.#topic(variable);
    const option = h('div', {
      class: 'plot-variable',
      role: 'option',
      tabindex: -1,
      draggable: 'true',
      text: variable,
      'aria-selected': String(this.#series.has(variable)),
      title: 'Click to plot, or drag onto a canvas',
      ondragstart: (event) => event.dataTransfer?.setData('text/x-variable', variable),
    });
    onActivate(option, () => {
      this.#current?.add(variable);
      this.#showPalette();
    });
    return option;
  }
}

class Plot {
  canvas = h('canvas', {class: 'plot-canvas', role: 'img', 'aria-label': 'Plot'});
  element;
  #owner;
  #legend = h('div', {class: 'plot-legend'});
  #curves: Curve[] = [];
  /** px from the left. */
  #cursor: number|null = null;

  constructor(owner: Plots) {
    this.#owner = owner;
    this.element = h(
      'div',
      {
        class: 'plot',
        onpointerdown: () => owner.choose(this),
        ondragover: (event) => {
          if (event.dataTransfer?.types.includes('text/x-variable')) event.preventDefault();
        },
        ondrop: (event) => {
          event.preventDefault();
          this.add(event.dataTransfer?.getData('text/x-variable') ?? '');
        },
      },
      this.#legend,
      this.canvas,
    );
    this.canvas.addEventListener('pointermove', (event) => {
      this.#cursor = event.offsetX;
      owner.redraw();
    });
    this.canvas.addEventListener('pointerleave', () => {
      this.#cursor = null;
      owner.redraw();
    });
    this.#showLegend();
  }

  add(variable: string) {
    if (!variable || this.#curves.some(({series}) => series.variable === variable)) return;
    this.#curves.push({series: this.#owner.series(variable), color: freeColor(this.#curves)});
    this.#showLegend();
    this.#owner.redraw();
  }

  #drop(curve: Curve) {
    this.#curves = this.#curves.filter((one) => one !== curve);
    this.#owner.release(curve.series.variable);
    this.#showLegend();
    this.#owner.redraw();
  }

  #showLegend() {
    fill(
      this.#legend,
      ...this.#curves.map((curve) => legendEntry(curve, () => this.#drop(curve))),
      !this.#curves.length &&
        h('span', {class: 'soft', text: 'Click or drop variables to plot them'}),
      h('span', {class: 'spring'}),
      closeButton('Remove this canvas', () => {
        [...this.#curves].forEach((curve) => this.#drop(curve));
        this.#owner.remove(this);
      }),
    );
  }

  draw(span: number|null, now: number) {
    drawPlot(this.canvas, this.#curves, {span, now, cursor: this.#cursor});
  }
}
