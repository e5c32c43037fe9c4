/**
 * The bar below the view: play, pause, step, the figures of time; while a log is replayed its
 * slider in their place.
 */
import {fill, h, remembered, roving, textButton} from '../ui/dom.js';
import {clockText} from '../ui/text_format.js';
import {icon, iconButton} from '../ui/icons.js';
import type {Page} from './panels.js';

const RATES = [0.1, 0.25, 0.5, 1, 2, 5, 10];

/** The mean of the last factors of real time, as Gazebo's 20 statistics. */
class Mean {
  values: number[] = [];

  /** @returns the mean with the new one */
  add(value: number): number {
    this.values.push(value);
    if (this.values.length > 20) this.values.shift();
    return this.values.reduce((sum, one) => sum + one, 0) / this.values.length;
  }

  clear() {
    this.values = [];
  }
}

/**
 * A figure of the bar.
 * @param width  CSS
 */
const figure = (label: string, width: string) =>
  h('output', {class: 'figure', 'aria-label': label, style: `min-width:${width}`});

/**
 * A figure behind its label.
 * @param name  for narrow windows
 */
const labelledFigure = (output: HTMLElement, name = '') =>
  h(
    'span',
    {class: `figure-pair figure-${name}`},
    h('span', {class: 'figure-label', text: output.getAttribute('aria-label')}),
    output,
  );

export class TimeBar {
  page;
  store;
  actions;
  notices;

  constructor(element: HTMLElement, page: Page) {
    const {store, actions, notices} = page;
    this.page = page;
    this.store = store;
    this.actions = actions;
    this.notices = notices;
    this.#live = this.#liveBar();
    this.#replay = this.#replayBar();
    fill(element, this.#live, this.#replay, h('span', {class: 'spring'}), this.#shared());
    roving(element, 'button, input');
    store.listen('stats', () => this.#showStats());
    store.listen('connection', () => this.#showStats());
    store.listen('log', () => this.#showLog());
    store.listen('history', () => this.#showFile());
    setInterval(() => this.#showFrames(), 1000);
    this.#showStats();
    this.#showLog();
    this.#showFile();
  }

  #live;
  #replay;
  #play = h('button', {class: 'play edits', onclick: () => this.actions.togglePlay()});
  #step = iconButton('step', 'Step', () => this.#doStep(), 18, {class: 'edits'});
  #steps = h('input', {
    type: 'number',
    min: 1,
    max: 9999,
    step: 1,
    value: remembered.get('steps', 1),
    'aria-label': 'Steps',
    class: 'steps',
    onkeydown: (event) => {
      if (event.key === 'Enter') this.#doStep();
    },
  });
  #figures = {
    factor: figure('Real Time Factor', '3.2em'),
    sim: figure('Sim Time', '8.6em'),
    real: figure('Real Time', '8.6em'),
    iterations: figure('Iterations', '5em'),
    fps: figure('FPS', '2.2em'),
  };
  #file = h('span', {class: 'file-name'});
  #recording = h('span', {class: 'recording', hidden: true, text: '● recording'});
  #log = {
    play: h('button', {class: 'play', onclick: () => this.#playLog()}),
    slider: h('input', {
      type: 'range',
      min: 0,
      max: 1,
      step: 0.001,
      'aria-label': 'Log time',
      class: 'log-slider',
      oninput: () => { this.actions.logSeek(Number(this.#log.slider.value)); },
    }),
    time: h('output', {class: 'figure', 'aria-label': 'Current time'}),
    end: h('output', {class: 'figure', 'aria-label': 'End time'}),
    rate: h(
      'select',
      {'aria-label': 'Rate', onchange: () => this.#playLog(true)},
      ...RATES.map((rate) => h('option', {value: rate, text: `${rate}×`, selected: rate === 1})),
    ),
  };
  #mean = new Mean();
  #lastIterations = -1;

  #liveBar() {
    return h(
      'div',
      {class: 'time-part'},
      this.#play,
      this.#step,
      h(
        'label',
        {class: 'figure-pair figure-steps edits'},
        h('span', {class: 'figure-label', text: 'Steps'}),
        this.#steps,
      ),
      labelledFigure(this.#figures.factor, 'factor'),
      labelledFigure(this.#figures.sim, 'sim'),
      labelledFigure(this.#figures.real, 'real'),
      labelledFigure(this.#figures.iterations, 'iterations'),
      labelledFigure(this.#figures.fps, 'fps'),
      iconButton('reset', 'Reset time', () => this.actions.resetTime(), 16, {class: 'edits'}),
    );
  }

  async #doStep() {
    const steps = Math.min(9999, Math.max(1, Math.round(Number(this.#steps.value)) || 1));
    this.#steps.value = String(steps);
    remembered.set('steps', steps);
    await this.actions.step(steps);
  }

  #showStats() {
    const {stats, connected} = this.store;
    const {sim, real, iterations, factor} = this.#figures;
    const paused = stats.paused;
    fill(this.#play, icon(paused ? 'play' : 'pause', 20));
    this.#play.title = paused ? 'Play (Space)' : 'Pause (Space)';
    this.#play.setAttribute('aria-label', paused ? 'Play' : 'Pause');
    this.#play.disabled = !connected;
    this.#step.disabled = !connected || !paused;
    this.#steps.disabled = !connected || !paused;
    sim.textContent = clockText(stats.sim_ns);
    real.textContent = clockText(stats.real_ns);
    iterations.textContent = String(stats.iterations);
    if (paused || stats.iterations < this.#lastIterations) this.#mean.clear();
    factor.textContent = (paused ? 0 : this.#mean.add(stats.factor)).toFixed(2);
    this.#lastIterations = stats.iterations;
  }

  #showFrames() {
    const fps = this.page.view?.fps;
    // A picture now and then is what a view at rest draws.
    const text = fps === undefined ? '–' : fps < 2 ? 'idle' : String(Math.round(fps));
    if (this.#figures.fps.textContent !== text) this.#figures.fps.textContent = text;
  }

  #shared() {
    return h(
      'span',
      {class: 'time-part'},
      this.#recording,
      this.#file,
      this.notices.button,
    );
  }

  #showFile() {
    const {file, dirty} = this.store.history;
    const name = file ? file.split('/').pop() : 'unsaved';
    this.#file.textContent = `${name}${dirty ? ' •' : ''}`;
    const unsaved = dirty ? ': unsaved changes' : '';
    this.#file.title = `${file || 'The world has not been saved'}${unsaved}`;
    const world = file ? name : (this.store.document?.name ?? 'no world');
    document.title = `${dirty ? '• ' : ''}${world} – World editor`;
  }

  #replayBar() {
    const seek = (time: number) => this.actions.logSeek(time);
    const ends = () => [this.store.log?.begin ?? 0, this.store.log?.end ?? 0];
    const log = this.#log;
    const by = (change: number) => () =>
      seek(Math.min(Math.max((this.store.log?.time ?? 0) + change, ends()[0]), ends()[1]));
    return h(
      'div',
      {class: 'time-part replay', hidden: true},
      iconButton('begin', 'Jump to start', () => seek(ends()[0]), 16),
      iconButton('left', 'Step back', by(-0.05), 16),
      log.play,
      iconButton('right', 'Step forward', by(0.05), 16),
      iconButton('end', 'Jump to end', () => seek(ends()[1]), 16),
      log.slider,
      log.time,
      h('span', {text: '/'}),
      log.end,
      log.rate,
      textButton('Close log', () => this.actions.logClose(), {class: 'close-log'}),
    );
  }

  /** Plays or stops; with `keep` goes on as it was, at the rate that is chosen now. */
  #playLog(keep = false) {
    const playing = this.store.log?.state === 'playing';
    const rate = playing === keep ? Number(this.#log.rate.value) : 0;
    this.actions.logPlay(rate);
  }

  #showLog() {
    const log = this.store.log;
    const replaying = log?.state === 'open' || log?.state === 'playing';
    this.#live.hidden = replaying;
    this.#replay.hidden = !replaying;
    this.#recording.hidden = log?.state !== 'recording';
    if (!log || !replaying) return;
    const {slider, time, end, play} = this.#log;
    slider.min = String(log.begin);
    slider.max = String(log.end);
    if (document.activeElement !== slider || log.state === 'playing') {
      slider.value = String(log.time);
    }
    time.textContent = clockText(log.time * 1e9);
    end.textContent = clockText(log.end * 1e9);
    fill(play, icon(log.state === 'playing' ? 'pause' : 'play', 20));
    play.setAttribute('aria-label', log.state === 'playing' ? 'Pause the log' : 'Play the log');
  }
}
