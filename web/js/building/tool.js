import {add} from './plan.js';
/** @import {Floor, Opening, Stairs, Wall} from '../protocol.js' */
/** @import {Kind} from './plan.js' */
/** @import {Point} from './plane_geometry.js' */
/** @import {Session} from './drawing_session.js' */

/**
 * A tool of the plan. It gets what the mouse does in metres of the plan: `press`, `move`, `release`,
 * `double`, `typed` (a length) and `cancel` (Esc, right button), and shows what it is about to do in
 * `session.draft`. Here is what it does where a tool has nothing of its own to do.
 *
 * @typedef {{point: Point, shift: boolean, alt: boolean, ctrl: boolean,
 *            tolerance: number}} Mouse
 */
export class Tool {
  /** @param {Session} session */
  constructor(session) { this.session = session; }

  /** What the tool is called: `select`, `wall`, … */
  name = '';
  /** What it says at the foot of the canvas. */
  hint = '';

  /** @param {Mouse} _mouse @returns {void} */
  press(_mouse) {}
  /** @param {Mouse} _mouse @returns {void} */
  move(_mouse) {}
  /** @param {Mouse} _mouse @returns {void} */
  release(_mouse) {}
  /** @param {Mouse} _mouse @returns {void} */
  double(_mouse) {}
  /** @param {number|null} _length  null: Enter without a number @returns {void} */
  typed(_length) {}

  /** @returns {boolean} whether something was given up; the tool stays in the hand then */
  cancel() {
    this.session.draft = {};
    return false;
  }

  /**
   * Puts a new thing into the plan, which ends the tool and leaves the thing selected.
   * @param {Kind} kind
   * @param {Partial<Wall>|Partial<Opening>|Partial<Stairs>|Partial<Floor>} fields
   * @param {string} label
   */
  insert(kind, fields, label) {
    const {session} = this;
    const {plan, ref} = add(session.history.plan, session.at, kind, fields);
    session.commit(plan, label);
    session.endTool();
    session.select([ref]);
  }
}
