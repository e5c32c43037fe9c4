/** What is being drawn: the plan with its history, the level, the selection, the tool. */
import {faultsOf} from './plan_check.js';
import {History} from './plan_history.js';
import {clipboardOf, emptyPlan, itemOf, pasted, remove} from './plan.js';

/** Emits `change` after anything that the canvas or the panels show, `tool` when the tool changes. */
export class Session extends EventTarget {
  /** @type {import('./plan.js').Ref[]} */
  selection = [];
  /** The level being drawn. */
  at = 0;
  /** What is shown of the plan: the floor-plan picture, and everything else. */
  shown = {image: true, features: true};
  /** @type {{path: string, name: string}|null} where the building was saved or opened */
  file = null;
  clipboard = [];
  /** What the canvas draws besides the plan: {segment, ghost, polygon, box, measure}. */
  draft = {};
  hint = '';
  #tool = null;
  #preview = null;

  constructor(plan = emptyPlan()) {
    super();
    this.history = new History(plan);
  }

  /** The plan as it is shown: with what is being dragged. */
  get plan() { return this.#preview ?? this.history.plan; }
  get level() { return this.plan.levels[this.at]; }
  get dirty() { return this.history.dirty; }

  /** @type {any} */
  get tool() { return this.#tool; }
  set tool(tool) {
    this.#tool?.cancel();
    this.#tool = tool;
    this.draft = {};
    this.hint = tool.hint;
    this.dispatchEvent(new Event('tool'));
    this.changed();
  }

  /** Back to selecting; set by whoever makes the tools. */
  endTool = () => {};

  /** Shows a plan that is not done yet; null shows the real one again. */
  preview(plan) {
    this.#preview = plan;
    this.changed();
  }

  /** Makes a plan the present one. */
  commit(plan, label) {
    this.#preview = null;
    this.history.commit(plan, label);
    this.#settle();
    this.changed();
  }

  undo() { this.#step(() => this.history.undo()); }
  redo() { this.#step(() => this.history.redo()); }

  #step(step) {
    this.#tool?.cancel();
    this.#preview = null;
    step();
    this.#settle();
    this.changed();
  }

  /** Starts over with another plan. */
  open(plan, file = null) {
    this.#preview = null;
    this.history = new History(plan);
    this.at = 0;
    this.selection = [];
    this.file = file;
    this.#tool?.cancel();
    this.changed();
  }

  /** Nothing selected that is not there. */
  #settle() {
    this.at = Math.min(this.at, this.plan.levels.length - 1);
    this.selection = this.selection.filter((ref) => itemOf(this.plan, this.at, ref));
  }

  select(refs) {
    this.selection = refs;
    this.changed();
  }

  isSelected = ({kind, id}) => this.selection.some((ref) => ref.kind === kind && ref.id === id);

  goTo(at) {
    this.at = Math.min(Math.max(at, 0), this.plan.levels.length - 1);
    this.selection = [];
    this.#tool?.cancel();
    this.changed();
  }

  removeSelected() {
    if (!this.selection.length) return;
    const what = this.selection.length === 1 ? NAMES[this.selection[0].kind] : `${this.selection.length} items`;
    this.commit(remove(this.history.plan, this.at, this.selection), `delete ${what}`);
  }

  copy() {
    if (this.selection.length) this.clipboard = clipboardOf(this.plan, this.at, this.selection);
  }

  /** Puts copies beside the originals, and selects them. */
  paste(by = [0.5, -0.5]) {
    if (!this.clipboard.length) return;
    const {plan, refs} = pasted(this.history.plan, this.at, this.clipboard, by);
    this.commit(plan, 'paste');
    this.select(refs);
    this.copy();
  }

  selectAll() {
    const {level} = this;
    this.select(Object.keys(NAMES).flatMap((kind) => level[kind].map(({id}) => ({kind, id}))));
  }

  /** Faults of all levels, with the level's number. */
  faults() {
    return this.plan.levels.flatMap((level, at) => faultsOf(level).map((fault) => ({...fault, at})));
  }

  /** Says something at the foot of the canvas; the tool's own words come back with ''. */
  say(hint) {
    this.hint = hint || this.#tool?.hint || '';
    this.changed();
  }

  show(what, on = !this.shown[what]) {
    this.shown = {...this.shown, [what]: on};
    this.changed();
  }

  changed() { this.dispatchEvent(new Event('change')); }
}

export const NAMES = Object.freeze(
  {walls: 'wall', windows: 'window', doors: 'door', stairs: 'stairs', floors: 'floor'});
