/** Undo and redo: plans with the words for what led to them. */

const MOST = 200;

export class History {
  #past = [];
  #future = [];
  #saved;

  constructor(plan) {
    this.plan = plan;
    this.#saved = plan;
  }

  /** Takes a new plan; `label` says in words what was done. */
  commit(plan, label) {
    if (plan === this.plan) return;
    this.#past.push({plan: this.plan, label});
    if (this.#past.length > MOST) this.#past.shift();
    this.plan = plan;
    this.#future = [];
  }

  /** @returns {string|null} what was undone */
  undo() {
    const step = this.#past.pop();
    if (!step) return null;
    this.#future.push({...step, plan: this.plan});
    this.plan = step.plan;
    return step.label;
  }

  /** @returns {string|null} what was done again */
  redo() {
    const step = this.#future.pop();
    if (!step) return null;
    this.#past.push({...step, plan: this.plan});
    this.plan = step.plan;
    return step.label;
  }

  get undoLabel() { return this.#past[this.#past.length - 1]?.label ?? null; }
  get redoLabel() { return this.#future[this.#future.length - 1]?.label ?? null; }

  /** The present plan is what the file holds. */
  markSaved() { this.#saved = this.plan; }
  /** The plan that the file holds. */
  get saved() { return this.#saved; }
  get dirty() { return this.plan !== this.#saved; }
}
