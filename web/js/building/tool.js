import {add} from './plan.js';

/**
 * A tool of the plan. It gets what the mouse does in metres of the plan: `press`, `move`, `release`,
 * `double`, `typed` (a length) and `cancel` (Esc, right button), and shows what it is about to do in
 * `session.draft`. Here is what it does where a tool has nothing of its own to do.
 *
 * @typedef {{point: import('./plane_geometry.js').Point, shift: boolean, alt: boolean, ctrl: boolean,
 *            tolerance: number}} Mouse
 */
export class Tool {
  constructor(session) { this.session = session; }

  release() {}
  double() {}
  typed() {}

  /** @returns {boolean} whether something was given up; the tool stays in the hand then */
  cancel() {
    this.session.draft = {};
    return false;
  }

  /** Puts a new thing into the plan, which ends the tool and leaves the thing selected. */
  insert(kind, fields, label) {
    const {session} = this;
    const {plan, ref} = add(session.history.plan, session.at, kind, fields);
    session.commit(plan, label);
    session.endTool();
    session.select([ref]);
  }
}
