import {add} from './plan.js';
import type {Floor, Opening, Stairs, Wall} from '../protocol.js';
import type {Kind} from './plan.js';
import type {Point} from './plane_geometry.js';
import type {Session} from './drawing_session.js';

/**
 * A tool of the plan. It gets what the mouse does in metres of the plan: `press`, `move`, `release`,
 * `double`, `typed` (a length) and `cancel` (Esc, right button), and shows what it is about to do in
 * `session.draft`. Here is what it does where a tool has nothing of its own to do.
 */
export type Mouse = {point: Point, shift: boolean, alt: boolean, ctrl: boolean,
    tolerance: number};
export class Tool {
  session;

  constructor(session: Session) { this.session = session; }

  /** What the tool is called: `select`, `wall`, … */
  name = '';
  /** What it says at the foot of the canvas. */
  hint = '';

  press(_mouse: Mouse): void {}
  move(_mouse: Mouse): void {}
  release(_mouse: Mouse): void {}
  double(_mouse: Mouse): void {}
  /** @param _length  null: Enter without a number */
  typed(_length: number|null): void {}

  /** @returns whether something was given up; the tool stays in the hand then */
  cancel(): boolean {
    this.session.draft = {};
    return false;
  }

  /** Puts a new thing into the plan, which ends the tool and leaves the thing selected. */
  insert(kind: Kind, fields: Partial<Wall>|Partial<Opening>|Partial<Stairs>|Partial<Floor>,
      label: string) {
    const {session} = this;
    const {plan, ref} = add(session.history.plan, session.at, kind, fields);
    session.commit(plan, label);
    session.endTool();
    session.select([ref]);
  }
}
