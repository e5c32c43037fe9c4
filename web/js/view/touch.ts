/**
 * Fingers on the view: one orbits or drags what the mouse would, two pan and zoom, a long press
 * opens the menu. Taps are clicks.
 */
import type {ViewParts} from './view.js';
import type {MousePoint} from './pointer.js';
import type {Selector} from './selector.js';

/** Milliseconds of a long press. */
const LONG = 550;
/** A finger that rests wanders by so many pixels. */
export const TOUCH_PIXELS = 12;

type Finger = {x: number, y: number};

export class Touch {
  #rig;
  #selector;
  /** By pointer id. */
  #fingers: Map<number, Finger> = new Map();
  /** Since two fingers were down, until all are up. */
  #pinching = false;
  #timer: ReturnType<typeof setTimeout>|undefined;
  /** Where a finger has pressed long. */
  #onLong: (event: MousePoint) => void;

  constructor({rig, selector}: Pick<ViewParts, 'rig'> & {selector: Selector},
      onLong: (event: MousePoint) => void) {
    this.#rig = rig;
    this.#selector = selector;
    this.#onLong = onLong;
  }

  /** @returns whether the fingers together are a gesture */
  down(event: PointerEvent): boolean {
    if (event.pointerType !== 'touch') return false;
    this.#fingers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    clearTimeout(this.#timer);
    if (this.#fingers.size > 1) this.#pinching = true;
    else {
      const {clientX, clientY} = event;
      this.#timer = setTimeout(() => this.#onLong({clientX, clientY}), LONG);
    }
    return this.#pinching;
  }

  /** @returns whether the gesture has it */
  move(event: PointerEvent): boolean {
    const finger = this.#fingers.get(event.pointerId);
    if (!finger) return false;
    if (Math.hypot(event.clientX - finger.x, event.clientY - finger.y) > TOUCH_PIXELS) {
      clearTimeout(this.#timer);
    }
    if (!this.#pinching) return false;
    if (this.#fingers.size === 2) this.#pinch(event, finger);
    Object.assign(finger, {x: event.clientX, y: event.clientY});
    return true;
  }

  /** @returns whether it was of a gesture */
  up(event: PointerEvent): boolean {
    if (!this.#fingers.delete(event.pointerId)) return false;
    clearTimeout(this.#timer);
    const was = this.#pinching;
    if (!this.#fingers.size) this.#pinching = false;
    return was;
  }

  /** The world goes with the fingers: their middle pans, their distance zooms. */
  #pinch(event: PointerEvent, finger: Finger) {
    const other = [...this.#fingers.values()].find((one) => one !== finger);
    if (!other) return;
    const before = Math.hypot(finger.x - other.x, finger.y - other.y);
    const now = Math.hypot(event.clientX - other.x, event.clientY - other.y);
    const middle = {clientX: (event.clientX + other.x) / 2, clientY: (event.clientY + other.y) / 2};
    const point = this.#selector.point(middle);
    if (before > 1 && now > 1) this.#rig.zoom(point, before / now);
    this.#rig.pan((event.clientX - finger.x) / 2, (event.clientY - finger.y) / 2, point, null);
  }
}
