/** The mouse and the held keys over the view: who gets a drag, and what a click means. */
import {isDown} from '../mouse_buttons.js';
import {closestTo} from '../ui/dom.js';
import {Touch, TOUCH_PIXELS} from './touch.js';
import type {Vec3} from '../pose.js';
import type {ViewParts} from './view.js';
import type {BoxSelect} from './box_select.js';
import type {Measure} from './measure.js';
import type {PivotMark} from './markers.js';
import type {Selector} from './selector.js';
import type {Forces} from './force_arrows.js';
import type {FaceSnap} from './face_snap.js';
import type {Placer} from './insert_ghost.js';
import type {Manipulator} from './manipulator.js';

/** Where the mouse is in the page, px, and what is held. */
export type MousePoint = {clientX: number, clientY: number} & KeyState;
/** The keys that are held while another one changes. */
export type KeyState = Partial<Record<'ctrlKey'|'metaKey'|'shiftKey', boolean|undefined>>;
/** The parts that the mouse works with. */
type PointerParts = {manipulator: Manipulator,
    placer: Placer,
    faceSnap: FaceSnap, forces: Forces,
    selector: Selector, pivotMark: PivotMark,
    measure: Measure, boxSelect: BoxSelect};
/** A pressed button: where it was pressed and who has the drag. */
type Press = {x: number, y: number,
    lastX: number, lastY: number, button: number, moved: number, point: Vec3,
    owner: 'camera'|'force'|'manipulator'|'box', touch: boolean};

const CLICK_PIXELS = 4;
const PLACE_PIXELS = 50;
const WHEEL_STEP = 0.15;
const AXIS_KEYS = ['x', 'y', 'z'] as const;
const WALK_KEYS = ['w', 'a', 's', 'd'];

/** Pixels within which a press is a click. */
const slop = ({touch}: Press) => (touch ? TOUCH_PIXELS : CLICK_PIXELS);

/** Keys that are down, and only while the page has the keyboard. */
class HeldKeys {
  #down: Set<string> = new Set();

  constructor(target: Window, onChange: (event: KeyState, key: string) => void, signal: AbortSignal) {
    const change = (event: KeyboardEvent) => {
      const key = event.key.toLowerCase();
      if (event.type === 'keydown') {
        if (event.repeat || closestTo(event, 'input, textarea, select')) return;
        this.#down.add(key);
      } else this.#down.delete(key);
      onChange(event, key);
    };
    const clear = () => {
      this.#down.clear();
      onChange({}, '');
    };
    target.addEventListener('keydown', change, {signal});
    target.addEventListener('keyup', change, {signal});
    target.addEventListener('blur', clear, {signal});
  }

  has(key: string) { return this.#down.has(key); }

  /** x, y or z when one is held. */
  get axis() { return AXIS_KEYS.find((key) => this.#down.has(key)) ?? null; }
}

export class Pointer {
  #parts;
  #keys;
  #touch;
  #press: Press|null = null;

  /** @param signal  ends the listeners */
  constructor(parts: ViewParts & PointerParts, signal: AbortSignal) {
    this.#parts = parts;
    this.#keys = new HeldKeys(window, (event) => this.#keysChanged(event), signal);
    const on = <T extends keyof HTMLElementEventMap>(type: T, listener: (event: HTMLElementEventMap[T]) => void) =>
      parts.stage.canvas.addEventListener(type, listener, {signal, passive: false});
    this.#touch = new Touch(parts, (event) => this.#longPress(event));
    on('pointerdown', (event) => this.#down(event));
    on('pointermove', (event) => this.#move(event));
    on('pointerup', (event) => this.#up(event));
    on('pointercancel', (event) => {
      this.#touch.up(event);
      this.#abandon();
    });
    on('pointerleave', () => this.#leave());
    on('dblclick', (event) => this.#parts.selector.flyTo(event));
    on('wheel', (event) => this.#wheel(event));
    on('contextmenu', (event) => event.preventDefault());
    on('dragover', (event) => {
      event.preventDefault();
      this.#parts.placer.follow(event);
    });
    on('dragleave', () => this.#parts.placer.hide());
    on('drop', (event) => this.#drop(event));
  }

  #down(event: PointerEvent) {
    const {stage, store, manipulator, selector, forces} = this.#parts;
    if (this.#touch.down(event)) {
      this.#abandon();
      return;
    }
    if (this.#press) return;
    stage.canvas.parentElement?.focus({preventScroll: true});
    stage.canvas.setPointerCapture(event.pointerId);
    const point = selector.point(event);
    const press: Press = {x: event.clientX, y: event.clientY, lastX: event.clientX,
        lastY: event.clientY,
      button: event.button, moved: 0, point, owner: 'camera',
      touch: event.pointerType === 'touch'};
    this.#press = press;
    if (event.button !== 0 || store.mode === 'insert') return;
    if (forces.grab(event)) press.owner = 'force';
    else if (manipulator.grab(event, () => selector.grasped(event), this.#keys.axis)) {
      press.owner = 'manipulator';
    } else if (store.mode === 'select' && (event.ctrlKey || event.metaKey)) press.owner = 'box';
  }

  /** A finger that rests is the right button. */
  #longPress(event: MousePoint) {
    const press = this.#press;
    if (!press || press.moved > TOUCH_PIXELS) return;
    this.#abandon();
    this.#parts.selector.menu(event);
  }

  #move(event: PointerEvent) {
    if (this.#touch.move(event)) return;
    const press = this.#press;
    if (!press) {
      this.#hover(event);
      return;
    }
    if (!isDown(event, press.button)) {
      this.#end(event, press);
      return;
    }
    const dx = event.clientX - press.lastX;
    const dy = event.clientY - press.lastY;
    press.lastX = event.clientX;
    press.lastY = event.clientY;
    press.moved = Math.max(press.moved,
      Math.hypot(event.clientX - press.x, event.clientY - press.y));
    if (this.#parts.store.mode === 'insert') this.#parts.placer.follow(event);
    if (press.moved < slop(press)) return;
    if (press.owner === 'box') this.#parts.boxSelect.show(press);
    else if (press.owner === 'manipulator') this.#parts.manipulator.drag(event, this.#keys.axis);
    else if (press.owner === 'force') this.#parts.forces.drag(event);
    else this.#moveCamera(event, press, dx, dy);
  }

  #moveCamera(event: PointerEvent, press: Press, dx: number, dy: number) {
    const {rig, store, pivotMark} = this.#parts;
    const fps = store.camera.controller === 'fps';
    const times = event.ctrlKey ? 2 : 1;
    const [x, y] = [dx * times, dy * times];
    if (press.button === 2) rig.zoom(press.point, Math.exp(y * 0.01));
    else if (fps && press.button === 0) rig.look(x, y);
    else if (press.button === 1 || event.shiftKey || press.touch) {
      const only = this.#keys.has('y') ? 'pitch' : this.#keys.has('z') ? 'yaw' : null;
      pivotMark.show(press.point);
      rig.orbit(press.point, x, y, only);
    } else rig.pan(x, y, press.point, this.#keys.axis);
  }

  #up(event: PointerEvent) {
    if (this.#touch.up(event)) return;
    const press = this.#press;
    if (press && !isDown(event, press.button)) this.#end(event, press);
  }

  #end(event: PointerEvent, press: Press) {
    this.#press = null;
    const {store, manipulator, placer, faceSnap, forces, selector, pivotMark} = this.#parts;
    pivotMark.hide();
    const clicked = press.moved < slop(press);
    if (press.owner === 'manipulator') manipulator.release();
    else if (press.owner === 'box' && !clicked) this.#parts.boxSelect.end(press);
    else if (press.owner === 'force') forces.release();
    else if (store.mode === 'insert') {
      if (press.button === 0 && press.moved < PLACE_PIXELS) placer.put(event);
      else if (press.button === 2 && clicked) this.#parts.actions.escape();
    } else if (clicked && press.button === 0) {
      if (store.mode === 'snap') faceSnap.click(event);
      else if (store.mode === 'connect') selector.pick(event);
      else if (store.mode === 'measure') this.#parts.measure.click(event);
      else selector.click(event);
    } else if (clicked && press.button === 2) selector.menu(event);
  }

  #abandon() {
    this.#press = null;
    this.#parts.boxSelect.cancel();
    this.#parts.manipulator.cancel();
    this.#parts.pivotMark.hide();
  }

  #leave() {
    if (this.#press) return;
    this.#parts.placer.hide();
    this.#parts.faceSnap.leave();
  }

  #hover(event: PointerEvent) {
    const {stage, store, manipulator, placer, faceSnap, forces} = this.#parts;
    let cursor = '';
    if (store.mode === 'insert') placer.follow(event);
    else if (store.mode === 'snap') faceSnap.hover(event);
    else if (store.mode === 'connect') cursor = 'crosshair';
    else if (forces.hover(event) || manipulator.hover(event)) cursor = 'grab';
    if (stage.canvas.style.cursor !== cursor) stage.canvas.style.cursor = cursor;
  }

  #wheel(event: WheelEvent) {
    event.preventDefault();
    const {rig, store, selector} = this.#parts;
    const steps = Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY) / 100, 3);
    if (store.camera.controller === 'fps') rig.changeWalkSpeed(1 - 0.05 * Math.sign(steps));
    else rig.zoom(selector.point(event), Math.exp(steps * WHEEL_STEP * (event.ctrlKey ? 2 : 1)));
  }

  #keysChanged(event: KeyState) {
    const {manipulator, rig, store} = this.#parts;
    manipulator.keysChanged(event, this.#keys.axis);
    if (store.camera.controller !== 'fps' || event.ctrlKey) return;
    const [w, a, s, d] = WALK_KEYS.map((key) => Number(this.#keys.has(key)));
    rig.walk(w - s, d - a, Boolean(event.shiftKey));
  }

  async #drop(event: DragEvent) {
    event.preventDefault();
    const {clientX, clientY} = event;
    const uri = event.dataTransfer?.getData('text/x-model-uri');
    if (!uri) {
      // What was dropped must be taken hold of before the event is over.
      const items = [...event.dataTransfer?.items ?? []].flatMap((item) =>
        item.webkitGetAsEntry?.() ?? item.getAsFile() ?? []);
      const place = this.#parts.placer.placeAt({clientX, clientY});
      if (items.length && place) this.#parts.actions.dropFiles(items, place);
      return;
    }
    const {store, actions, placer} = this.#parts;
    // The drag has begun to fetch it: the first drop may come before it is there.
    if (store.placing?.uri !== uri && !(await actions.insertModel(uri)).ok) return;
    placer.put({clientX, clientY});
  }
}
