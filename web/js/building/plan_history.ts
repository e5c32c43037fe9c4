/** Undo and redo: plans with the words for what led to them. */
import type {Plan} from '../protocol.js';

const MOST = 200;

type Step = {plan: Plan, label: string};

export class History {
  plan;
  #past: Step[] = [];
  #future: Step[] = [];
  #saved;

  constructor(plan: Plan) {
    this.plan = plan;
    this.#saved = plan;
  }

  /** Takes a new plan; `label` says in words what was done. */
  commit(plan: Plan, label: string) {
    if (plan === this.plan) return;
    this.#past.push({plan: this.plan, label});
    if (this.#past.length > MOST) this.#past.shift();
    this.plan = plan;
    this.#future = [];
  }

  /** @returns what was undone */
  undo(): string|null {
    return this.#step(this.#past, this.#future);
  }

  /** @returns what was done again */
  redo(): string|null {
    return this.#step(this.#future, this.#past);
  }

  #step(from: Step[], to: Step[]) {
    const step = from.pop();
    if (!step) return null;
    to.push({...step, plan: this.plan});
    this.plan = step.plan;
    return step.label;
  }

  get undoLabel() { return this.#past[this.#past.length - 1]?.label ?? null; }
  get redoLabel() { return this.#future[this.#future.length - 1]?.label ?? null; }

  /** What the file holds, by default the present plan. */
  markSaved(plan: Plan = this.plan) { this.#saved = plan; }
  /** The plan that the file holds. */
  get saved() { return this.#saved; }
  get dirty() { return this.plan !== this.#saved; }
}
