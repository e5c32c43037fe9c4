/** Undo and redo: plans with the words for what led to them. */
/** @import {Plan} from '../protocol.js' */

const MOST = 200;

/** @typedef {{plan: Plan, label: string}} Step */

export class History {
  /** @type {Step[]} */
  #past = [];
  /** @type {Step[]} */
  #future = [];
  #saved;

  /** @param {Plan} plan */
  constructor(plan) {
    this.plan = plan;
    this.#saved = plan;
  }

  /**
   * Takes a new plan; `label` says in words what was done.
   * @param {Plan} plan
   * @param {string} label
   */
  commit(plan, label) {
    if (plan === this.plan) return;
    this.#past.push({plan: this.plan, label});
    if (this.#past.length > MOST) this.#past.shift();
    this.plan = plan;
    this.#future = [];
  }

  /** @returns {string|null} what was undone */
  undo() {
    return this.#step(this.#past, this.#future);
  }

  /** @returns {string|null} what was done again */
  redo() {
    return this.#step(this.#future, this.#past);
  }

  /** @param {Step[]} from @param {Step[]} to */
  #step(from, to) {
    const step = from.pop();
    if (!step) return null;
    to.push({...step, plan: this.plan});
    this.plan = step.plan;
    return step.label;
  }

  get undoLabel() { return this.#past[this.#past.length - 1]?.label ?? null; }
  get redoLabel() { return this.#future[this.#future.length - 1]?.label ?? null; }

  /**
   * What the file holds, by default the present plan.
   * @param {Plan} [plan]
   */
  markSaved(plan = this.plan) { this.#saved = plan; }
  /** The plan that the file holds. */
  get saved() { return this.#saved; }
  get dirty() { return this.plan !== this.#saved; }
}
