/**
 * Fingers on the view: one orbits or drags what the mouse would, two pan and zoom, a long press
 * opens the menu. Taps are clicks.
 */
/** @import {ViewParts} from './view.js' */
/** @import {MousePoint} from './pointer.js' */

/** Milliseconds of a long press. */
const LONG = 550;
/** A finger that rests wanders by so many pixels. */
export const TOUCH_PIXELS = 12;

/** @typedef {{x: number, y: number}} Finger */

export class Touch {
  #rig;
  #selector;
  /** By pointer id. @type {Map<number, Finger>} */
  #fingers = new Map();
  /** Since two fingers were down, until all are up. */
  #pinching = false;
  /** @type {ReturnType<typeof setTimeout>|undefined} */
  #timer;
  /** Where a finger has pressed long. @type {(event: MousePoint) => void} */
  #onLong;

  /**
   * @param {Pick<ViewParts, 'rig'> & {selector: import('./selector.js').Selector}} parts
   * @param {(event: MousePoint) => void} onLong
   */
  constructor({rig, selector}, onLong) {
    this.#rig = rig;
    this.#selector = selector;
    this.#onLong = onLong;
  }

  /** @param {PointerEvent} event @returns {boolean} whether the fingers together are a gesture */
  down(event) {
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

  /** @param {PointerEvent} event @returns {boolean} whether the gesture has it */
  move(event) {
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

  /** @param {PointerEvent} event @returns {boolean} whether it was of a gesture */
  up(event) {
    if (!this.#fingers.delete(event.pointerId)) return false;
    clearTimeout(this.#timer);
    const was = this.#pinching;
    if (!this.#fingers.size) this.#pinching = false;
    return was;
  }

  /**
   * The world goes with the fingers: their middle pans, their distance zooms.
   * @param {PointerEvent} event
   * @param {Finger} finger
   */
  #pinch(event, finger) {
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
