/**
 * The bar below the view: play, pause, step, the figures of time; while a log is replayed its
 * slider in their place.
 */
import {fill, h, remembered, roving} from './dom.js';
import {clockText} from './text_format.js';
import {icon} from './icons.js';

const RATES = [0.1, 0.25, 0.5, 1, 2, 5, 10];

/** The mean of the last factors of real time, as Gazebo's 20 statistics. */
class Mean {
  constructor(kept = 20) {
    this.kept = kept;
    this.values = [];
  }

  /** @returns {number} the mean with the new one */
  add(value) {
    this.values.push(value);
    if (this.values.length > this.kept) this.values.shift();
    return this.values.reduce((sum, one) => sum + one, 0) / this.values.length;
  }

  clear() {
    this.values = [];
  }
}

export class TimeBar {
  /**
   * @param {HTMLElement} element
   * @param {import('./panels.js').Page} page
   */
  constructor(element, page) {
    const {store, actions, notices} = page;
    this.page = page;
    this.store = store;
    this.actions = actions;
    this.notices = notices;
    this.#live = this.#liveBar();
    this.#replay = this.#replayBar();
    fill(element, this.#live, this.#replay, h('span', {class: 'spring'}), this.#shared());
    roving(element, 'button, input');
    store.addEventListener('stats', () => this.#showStats());
    store.addEventListener('connection', () => this.#showStats());
    store.addEventListener('log', () => this.#showLog());
    store.addEventListener('history', () => this.#showFile());
    setInterval(() => this.#showFrames(), 1000);
    this.#showStats();
    this.#showLog();
    this.#showFile();
  }

  #live;
  #replay;
  #play;
  #step;
  #steps;
  #figures = {};
  #log = {};
  #mean = new Mean();
  #lastIterations = -1;

  #liveBar() {
    this.#play = h('button', {
      type: 'button',
      class: 'play',
      onclick: () => this.actions.togglePlay(),
    });
    this.#step = h(
      'button',
      {
        type: 'button',
        title: 'Step',
        'aria-label': 'Step',
        onclick: () => this.#doStep(),
      },
      icon('step'),
    );
    this.#steps = h('input', {
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
    const figure = (key, label, width) => {
      this.#figures[key] = h('output', {
        class: 'figure',
        'aria-label': label,
        style: `min-width:${width}`,
      });
      return h(
        'span',
        {class: 'figure-pair'},
        h('span', {class: 'figure-label', text: label}),
        this.#figures[key],
      );
    };
    const reset = h(
      'button',
      {
        type: 'button',
        title: 'Reset time',
        'aria-label': 'Reset time',
        onclick: () => this.actions.reset('time'),
      },
      icon('reset', 16),
    );
    return h(
      'div',
      {class: 'time-part'},
      this.#play,
      this.#step,
      h(
        'label',
        {class: 'figure-pair'},
        h('span', {class: 'figure-label', text: 'Steps'}),
        this.#steps,
      ),
      figure('factor', 'Real Time Factor', '3.2em'),
      figure('sim', 'Sim Time', '8.6em'),
      figure('real', 'Real Time', '8.6em'),
      figure('iterations', 'Iterations', '5em'),
      figure('fps', 'FPS', '2.4em'),
      reset,
    );
  }

  async #doStep() {
    const steps = Math.min(9999, Math.max(1, Math.round(Number(this.#steps.value)) || 1));
    this.#steps.value = steps;
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
    const text = this.page.view?.fps === undefined ? '–' : String(Math.round(this.page.view.fps));
    if (this.#figures.fps.textContent !== text) this.#figures.fps.textContent = text;
  }

  #shared() {
    this.#log.recording = h('span', {class: 'recording', hidden: true, text: '● recording'});
    this.#figures.file = h('span', {class: 'file-name'});
    return h(
      'span',
      {class: 'time-part'},
      this.#log.recording,
      this.#figures.file,
      this.notices.button,
    );
  }

  #showFile() {
    const {file, dirty} = this.store.history;
    const name = file ? file.split('/').pop() : 'not saved yet';
    this.#figures.file.textContent = `${name}${dirty ? ' •' : ''}`;
    const unsaved = dirty ? ': unsaved changes' : '';
    this.#figures.file.title = `${file || 'This world has no file'}${unsaved}`;
    const world = file ? name : (this.store.document?.name ?? 'no world');
    document.title = `${dirty ? '• ' : ''}${world} – World editor`;
  }

  #replayBar() {
    const button = (glyph, label, run) =>
      h(
        'button',
        {type: 'button', title: label, 'aria-label': label, onclick: run},
        icon(glyph, 16),
      );
    const seek = (time) => this.actions.logSeek(time);
    const ends = () => [this.store.log?.begin ?? 0, this.store.log?.end ?? 0];
    const log = this.#log;
    log.play = h('button', {type: 'button', class: 'play', onclick: () => this.#playLog()});
    log.slider = h('input', {
      type: 'range',
      min: 0,
      max: 1,
      step: 0.001,
      'aria-label': 'Log time',
      class: 'log-slider',
      oninput: () => seek(Number(log.slider.value)),
    });
    log.time = h('output', {class: 'figure', 'aria-label': 'Current time'});
    log.end = h('output', {class: 'figure', 'aria-label': 'End time'});
    log.rate = h(
      'select',
      {'aria-label': 'Rate', onchange: () => this.#playLog(true)},
      ...RATES.map((rate) => h('option', {value: rate, text: `${rate}×`, selected: rate === 1})),
    );
    const by = (change) => () =>
      seek(Math.min(Math.max((this.store.log?.time ?? 0) + change, ends()[0]), ends()[1]));
    return h(
      'div',
      {class: 'time-part replay', hidden: true},
      button('begin', 'To the beginning', () => seek(ends()[0])),
      button('left', 'Step back', by(-0.05)),
      log.play,
      button('right', 'Step forward', by(0.05)),
      button('end', 'To the end', () => seek(ends()[1])),
      log.slider,
      log.time,
      h('span', {text: '/'}),
      log.end,
      log.rate,
      h('button', {type: 'button', text: 'Close log', onclick: () => this.actions.logClose()}),
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
    this.#log.recording.hidden = log?.state !== 'recording';
    if (!replaying) return;
    const {slider, time, end, play} = this.#log;
    slider.min = log.begin;
    slider.max = log.end;
    if (document.activeElement !== slider || log.state === 'playing') slider.value = log.time;
    time.textContent = clockText(log.time * 1e9);
    end.textContent = clockText(log.end * 1e9);
    fill(play, icon(log.state === 'playing' ? 'pause' : 'play', 20));
    play.setAttribute('aria-label', log.state === 'playing' ? 'Pause the log' : 'Play the log');
  }
}
