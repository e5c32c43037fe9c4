/** The plot of a replay: curves of the numbers of recorded topics, with the time of the log. */
import {fill, h, onceAFrame} from '../ui/dom.js';
import {drawPlot, freeColor, legendEntry} from '../ui/plot_canvas.js';
import {Series} from '../ui/plot_data.js';
import {decodeTopicFrame} from '../topics/topic_frames.js';
import {numbersOf} from '../topics/view_numbers.js';
import type {Curve, Drawn} from '../ui/plot_canvas.js';
import type {Page} from '../panels/panels.js';
import type {StateLog} from './state_log.js';

/** The numbers of all recorded messages over log time, by variable such as `/cmd_vel.linear.x`. */
export function seriesOf(log: StateLog): Map<string, Series> {
  const found = new Map<string, Series>();
  for (const {state, frame} of log.notes(-1, Infinity)) {
    const decoded = frame && decodeTopicFrame(frame);
    if (!decoded) continue;
    const {head, buffer, start} = decoded;
    for (const [field, value] of numbersOf(head.view, buffer.slice(start))) {
      const variable = `${head.topic}.${field}`;
      const series = found.get(variable) ?? new Series(variable);
      found.set(variable, series);
      series.add(log.timeOf(state), value);
    }
  }
  return found;
}

export class LogPlot {
  #page;
  #log;
  #series;
  #curves: Curve[] = [];
  #legend = h('div', {class: 'plot-legend'});
  #canvas = h('canvas', {role: 'img', 'aria-label': 'Plot'});
  #drawn: Drawn|null = null;
  #draw = onceAFrame(() => this.#show());

  /**
   * @param element  hidden if the log contains no numbers
   * @param shown  variables that have a curve from the start
   */
  constructor(element: HTMLElement, page: Page, log: StateLog, shown: string[]) {
    this.#page = page;
    this.#log = log;
    this.#series = seriesOf(log);
    element.hidden = !this.#series.size;
    if (element.hidden) return;
    fill(element, this.#legend, this.#canvas);
    this.#canvas.addEventListener('pointerdown', (event) => this.#seek(event));
    this.#canvas.addEventListener('pointermove', (event) => event.buttons && this.#seek(event));
    page.store.listen('log', this.#draw);
    new ResizeObserver(this.#draw).observe(this.#canvas);
    for (const variable of shown) this.#add(variable);
    this.#showLegend();
  }

  #add(variable: string) {
    const series = this.#series.get(variable);
    if (!series || this.#curves.some((one) => one.series === series)) return;
    this.#curves.push({series, color: freeColor(this.#curves)});
    this.#showLegend();
  }

  #remove(curve: Curve) {
    this.#curves = this.#curves.filter((one) => one !== curve);
    this.#showLegend();
  }

  #showLegend() {
    this.#canvas.hidden = !this.#curves.length;
    fill(this.#legend, this.#choice(), ...this.#curves.map((curve) => legendEntry(curve, () => this.#remove(curve))));
    this.#draw();
  }

  /** The variables that have no curve yet. */
  #choice() {
    const shown = new Set(this.#curves.map(({series}) => series.variable));
    const free = [...this.#series.keys()].filter((variable) => !shown.has(variable));
    const select: HTMLSelectElement = h('select', {'aria-label': 'Plot a number of a topic',
        onchange: () => this.#add(select.value)},
      h('option', {value: '', text: 'Plot…'}), ...free.map((variable) => h('option', {value: variable, text: variable})));
    return select;
  }

  #seek(event: PointerEvent) {
    if (!this.#drawn) return;
    const {box, range} = this.#drawn;
    const share = Math.min(Math.max((event.offsetX - box.left) / box.width, 0), 1);
    this.#page.actions.logSeek(range.from + share * (range.to - range.from));
  }

  #show() {
    const time = this.#page.store.log?.time ?? this.#log.begin;
    this.#drawn = drawPlot(this.#canvas, this.#curves, {span: null, cursor: null, mark: time, now: this.#log.end});
  }
}
