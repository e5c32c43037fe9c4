/** What is being drawn: the plan with its history, the level, the selection, the tool. */
import {Emitter} from '../emitter.js';
import {faultsOf} from './plan_check.js';
import {History} from './plan_history.js';
import {Tool} from './tool.js';
import {emptyPlan, itemOf, KINDS, remove} from './plan.js';
import {clipboardOf, pasted} from './plan_clipboard.js';
import type {Kind, OpeningKind, Ref} from './plan.js';
import type {Clip} from './plan_clipboard.js';
import type {Opening, Plan, Stairs} from '../protocol.js';
import type {Point} from './plane_geometry.js';

/** What the canvas draws besides the plan. */
interface Sketch {
  /** a wall */
  segment?: {start: Point, end: Point, thickness: number, on?: string};
  mark?: Point|null;
  opening?: {kind: OpeningKind, item: Opening, fault: string};
  stairs?: Omit<Stairs, 'id'>;
  polygon?: {points: Point[], closed?: boolean};
  box?: [Point, Point];
  measure?: [Point, Point];
}

/** `change` comes after anything that the canvas or the panels show, `tool` when the tool changes. */
export class Session extends Emitter<{change: undefined, tool: undefined}> {
  history;
  selection: Ref[] = [];
  /** The level being drawn. */
  at = 0;
  /** What is shown of the plan: the floor-plan picture, and everything else. */
  shown = {image: true, features: true};
  /** where the building was saved or opened */
  file: {path: string, name: string}|null = null;
  clipboard: Clip[] = [];
  draft: Sketch = {};
  hint = '';
  #tool: Tool = new Tool(this);
  #preview: Plan|null = null;

  constructor(plan = emptyPlan()) {
    super();
    this.history = new History(plan);
  }

  /** The plan as it is shown: with what is being dragged. */
  get plan() { return this.#preview ?? this.history.plan; }
  get level() { return this.plan.levels[this.at]; }
  get dirty() { return this.history.dirty; }

  /** The tool in the hand. */
  get tool() { return this.#tool; }
  set tool(tool) {
    this.#tool.cancel();
    this.#tool = tool;
    this.draft = {};
    this.hint = tool.hint;
    this.emit('tool');
    this.changed();
  }

  /** Selects the select tool again. The building editor sets this function. */
  endTool = () => {};

  /** Shows a plan that is not done yet; null shows the real one again. */
  preview(plan: Plan|null) {
    this.#preview = plan;
    this.changed();
  }

  /** Makes a plan the present one. */
  commit(plan: Plan, label: string) {
    this.#preview = null;
    this.history.commit(plan, label);
    this.#settle();
    this.changed();
  }

  undo() { this.#step(() => this.history.undo()); }
  redo() { this.#step(() => this.history.redo()); }

  #step(step: () => void) {
    this.#tool.cancel();
    this.#preview = null;
    step();
    this.#settle();
    this.changed();
  }

  /** Starts over with another plan. */
  open(plan: Plan, file: Session['file'] = null) {
    this.#preview = null;
    this.history = new History(plan);
    this.at = 0;
    this.selection = [];
    this.file = file;
    this.#tool.cancel();
    this.changed();
  }

  /** Nothing selected that is not there. */
  #settle() {
    this.at = Math.min(this.at, this.plan.levels.length - 1);
    this.selection = this.selection.filter((ref) => itemOf(this.plan, this.at, ref));
  }

  select(refs: Ref[]) {
    this.selection = refs;
    this.changed();
  }

  isSelected = ({kind, id}: Ref) => this.selection.some((ref) => ref.kind === kind && ref.id === id);

  /** Shows the level of this number, or the nearest one that exists, and clears the selection. */
  showLevel(at: number) {
    this.at = Math.min(Math.max(at, 0), this.plan.levels.length - 1);
    this.selection = [];
    this.#tool.cancel();
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
    this.select(KINDS.flatMap((kind) => level[kind].map(({id}) => ({kind, id}))));
  }

  /** Faults of all levels, with the level's number. */
  faults() {
    return this.plan.levels.flatMap((level, at) => faultsOf(level).map((fault) => ({...fault, at})));
  }

  /** Says something at the foot of the canvas; the tool's own words come back with ''. */
  say(hint: string) {
    this.hint = hint || this.#tool.hint || '';
    this.changed();
  }

  show(what: keyof Session['shown'], on = !this.shown[what]) {
    this.shown = {...this.shown, [what]: on};
    this.changed();
  }

  changed() { this.emit('change'); }
}

/** What items are called in texts. */
export const NAMES: Record<Kind, string> = Object.freeze(
  {walls: 'wall', windows: 'window', doors: 'door', stairs: 'stairs', floors: 'floor'});
