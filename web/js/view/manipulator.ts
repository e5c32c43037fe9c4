/** Moving, turning and scaling with the mouse: by the handles, or by the body itself. */
import {alongAxis, rotated, roundness, scaled, translated} from '../drag_math.js';
import {groupAround, membersOf} from '../model_groups.js';
import {compose, inverse, orientation, position} from '../pose.js';
import {LIMITS} from '../protocol.js';
import {Gizmo} from './gizmo.js';
import {axisOf, graspedPoint, isNothing, numbersOf} from './grasp.js';
import {ViewPart} from './view_part.js';
import type {AxisName, GizmoMode} from './gizmo.js';
import type {DragResult, Grasp} from './grasp.js';
import type {KeyState, MousePoint} from './pointer.js';
import type {Pose7, Vec3} from '../pose.js';
import type {Ray} from '../drag_math.js';
import type {Under} from './selector.js';
import type {EntityRef} from '../store.js';
import type {ViewParts} from './view.js';

const AXIS_INDEX: Record<AxisName, 0|1|2> = {x: 0, y: 1, z: 2};
/** Milliseconds between two messages of a drag. */
const DRAG_INTERVAL = 1000 / LIMITS.drags_hz;
/** The modes in which a body can be moved, with the words for the history. */
const LABELS: Record<string, string> = {translate: 'translate', rotate: 'rotate'};

/** Whether the tool moves bodies. */
const isGizmoMode = (mode: string): mode is GizmoMode =>
    mode === 'translate' || mode === 'rotate' || mode === 'scale';

/** How a drag goes: its axis and frame, as one text. */
const howOf = (handle: AxisName|null, key: AxisName|null, event: KeyState) =>
    `${key ?? handle ?? ''} ${Boolean(event.shiftKey)}`;

export class Manipulator extends ViewPart {
  #gizmo;
  #grasp: Grasp|null = null;
  #result: DragResult|null = null;
  #lastSent = 0;
  #lastEvent: MousePoint|null = null;
  #worldAxes = false;

  /** Called when something is moved by hand, so that boxes and overlays go along. */
  onMoved = () => {};

  /** Called with what a drag has come to, in numbers; '' at its end. */
  onNumbers = (_text: string) => {};

  constructor(parts: ViewParts) {
    super(parts);
    const {store, stage} = parts;
    this.#gizmo = new Gizmo(stage.scene);
    for (const event of ['selection', 'mode', 'document', 'entity', 'overlays'] as const) {
      store.listen(event, () => {
        this.#dropGone();
        this.update();
      });
    }
  }

  get dragging() { return this.#grasp !== null; }

  /** The one that has the handles: the last selected model or light. */
  get target(): string|null {
    const {mode, selection} = this.store;
    if (!isGizmoMode(mode)) return null;
    const name = selection.at(-1);
    const entity = name ? this.store.entity(name) : null;
    if (!name || !entity || this.#isLocked(entity)) return null;
    if (entity.kind === 'link') {
      return this.store.modelEditing?.name === entity.model.name ? name : entity.model.name;
    }
    if (entity.kind === 'light' && mode === 'scale') return null;
    return name;
  }

  #isLocked({model, light}: EntityRef) {
    return this.store.overlay('locked', (model ?? light)?.name);
  }

  /** Puts the handles where the target is shown. */
  update() {
    const name = this.target;
    const {mode} = this.store;
    this.#gizmo.show(name && isGizmoMode(mode) ? mode : null);
    const pose = name && this.#shown(name);
    if (pose) {
      const turned = this.#worldAxes && this.store.mode !== 'scale';
      const axes = turned ? [0, 0, 0, 1] : orientation(pose);
      this.#gizmo.place([...position(pose), ...axes], this.rig.unitAt(position(pose)));
    }
    this.stage.invalidate();
  }

  /**
   * Lights up the handle under the mouse.
   * @returns whether there is one
   */
  hover(event: MousePoint): boolean {
    this.#worldAxesWith(Boolean(event.shiftKey));
    const axis = this.#handleUnder(event);
    if (this.#gizmo.light(axis)) this.stage.invalidate();
    return axis !== null;
  }

  /**
   * Takes hold of a handle, or of a body in a mode that moves bodies.
   * @param pick  what body is under the mouse
   * @param key  x, y or z when held
   * @returns whether the drag is ours
   */
  grab(event: MousePoint, pick: () => Under|null, key: AxisName|null): boolean {
    const {mode} = this.store;
    if (!isGizmoMode(mode)) return false;
    const handle = this.#handleUnder(event);
    const name = this.target;
    const pose = name && this.#shown(name);
    if (handle && name && pose) return this.#take(event, name, handle, position(pose), key);
    const body = pick();
    if (!body) return false;
    if (!this.store.selection.includes(body.name)) this.store.select(this.#group(body.name));
    if (mode !== 'translate' && !key) return true;
    if (this.target === null) return true;
    return this.#take(event, body.name, null, body.point, key);
  }

  /** Follows the mouse. */
  drag(event: MousePoint, key: AxisName|null) {
    if (!this.#grasp) return;
    this.#lastEvent = event;
    const ray = this.picker.ray(event.clientX, event.clientY);
    this.#rebase(ray, event, key);
    const made = this.#apply(ray, event, key);
    if (!made) return;
    this.#result = made;
    if (this.#grasp) this.onNumbers(numbersOf(this.#grasp, made));
    this.#show(made);
    this.#send();
  }

  /** A held key has changed while the mouse rests. */
  keysChanged(event: KeyState, key: AxisName|null) {
    this.#worldAxesWith(Boolean(event.shiftKey));
    if (!this.#grasp || !this.#lastEvent) return;
    const {clientX, clientY} = this.#lastEvent;
    this.drag({clientX, clientY, ctrlKey: event.ctrlKey || event.metaKey,
      shiftKey: event.shiftKey}, key);
  }

  /** Lets go: the simulator gets the result, as one step of the history. */
  async release() {
    const grasp = this.#grasp;
    const result = this.#result;
    this.#grasp = this.#result = this.#lastEvent = null;
    if (!grasp) return;
    if (!result || isNothing(grasp, result)) {
      this.#end(grasp, false);
      return;
    }
    const outcome = result.factors
      ? await this.actions.scale(grasp.name, result.factors)
      : await this.actions.move(result.poses, LABELS[grasp.mode]);
    this.#end(grasp, outcome.ok && !result.factors);
  }

  /**
   * Gives a drag up; everything is where it was.
   * @returns whether there was one
   */
  cancel(): boolean {
    const grasp = this.#grasp;
    if (!grasp) return false;
    this.#grasp = this.#result = this.#lastEvent = null;
    if (grasp.sent) {
      this.connection.send('drag', this.#message({[grasp.name]: grasp.first, ...grasp.others}));
    }
    this.#end(grasp, false);
    return true;
  }

  /** Ends the drag if the grasped entity was deleted. The simulator reports who deleted it. */
  #dropGone() {
    const grasp = this.#grasp;
    if (!grasp || this.store.entity(grasp.name)) return;
    this.#grasp = this.#result = this.#lastEvent = null;
    this.#end(grasp, false);
  }

  #message(poses: Record<string, Pose7>) {
    const names = Object.keys(poses).filter((name) => this.store.model(name));
    return {names, poses: names.map((name) => poses[name])};
  }

  #end(grasp: Grasp, keep: boolean) {
    this.onNumbers('');
    if (grasp.sent) this.connection.send('drag_end');
    const names = [grasp.name, ...Object.keys(grasp.others)];
    // A next drag may have begun while the simulator answered.
    if (this.#grasp && names.includes(this.#grasp.name)) return;
    for (const name of names) this.models.fade(name, false);
    this.models.release(names, {keep});
    if (!keep) this.#moveLights(Object.fromEntries(names.map((name) => [name, this.store.light(name)?.pose])));
    this.#moved();
  }

  #group(name: string) {
    return groupAround(membersOf(this.store.document), name);
  }

  #shown(name: string) {
    if (this.#grasp?.name === name && this.#result?.poses) return this.#result.poses[name];
    return this.models.shownPose(name);
  }

  #handleUnder(event: MousePoint) {
    if (!this.#gizmo.shown) return null;
    const [hit] = this.picker.objects(this.#gizmo.grips, event.clientX, event.clientY);
    return hit ? Gizmo.axisOf(hit.object) : null;
  }

  #take(event: MousePoint, name: string, handle: AxisName|null, point: Vec3, key: AxisName|null) {
    const {mode} = this.store;
    const model = this.store.model(name);
    if (mode === 'scale' && (!model || !model.scalable)) {
      this.store.addIssue({severity: 'note', code: 'not-scalable',
        message: `${name} cannot be scaled: only models with one link and simple shapes can be scaled.`});
      return true;
    }
    const pose = this.models.shownPose(name);
    if (!pose || !isGizmoMode(mode)) return false;
    const others: Record<string, Pose7> = {};
    if (mode !== 'scale') {
      // Of what is selected, all moves along; only the members of its group turn along.
      for (const other of this.store.selection) {
        const along = other !== name && this.store.entity(other)?.kind !== 'link' &&
          (mode === 'translate' || this.#group(name).includes(other));
        const shown = along && this.models.shownPose(other);
        if (shown) others[other] = shown;
      }
    }
    const size = mode === 'scale' ? this.models.bounds(name, pose) : null;
    const grasp: Grasp = {name, mode, handle, start: pose, first: pose, point, others, sent: false,
      size: size ? size.max.clone().sub(size.min).toArray() : [1, 1, 1],
      ray: this.picker.ray(event.clientX, event.clientY), how: howOf(handle, key, event)};
    grasp.point = graspedPoint(grasp, point);
    this.#grasp = grasp;
    for (const one of [name, ...Object.keys(others)]) this.models.fade(one, true);
    return true;
  }

  /** x, y or z held or let go, or Shift: the drag goes on from where it is, in the new way. */
  #rebase(ray: Ray, event: MousePoint, key: AxisName|null) {
    const grasp = this.#grasp;
    if (!grasp) return;
    const how = howOf(grasp.handle, key, event);
    if (how === grasp.how) return;
    grasp.how = how;
    if (grasp.mode === 'scale') return;
    const now = this.#result?.poses?.[grasp.name] ?? grasp.start;
    grasp.point = grasp.point.map((part, index) => part + now[index] - grasp.start[index]);
    grasp.start = now;
    grasp.ray = ray;
  }

  #apply(ray: Ray, event: MousePoint, key: AxisName|null) {
    const grasp = this.#grasp;
    if (!grasp) return null;
    const snap = Boolean(event.ctrlKey || event.metaKey);
    if (grasp.mode === 'scale') return this.#scaled(ray, event, key, snap);
    // A held key means the world's axis when moving (Gazebo behaviour), the handles' when turning.
    const axisName = key ?? grasp.handle;
    const world = Boolean(event.shiftKey) || (grasp.mode === 'translate' && key !== null);
    const axis = axisName ? axisOf(grasp, axisName, world) : null;
    const pose = grasp.mode === 'translate'
      ? translated(grasp.start, grasp.point, ray, {axis, snap})
      : axis && rotated(grasp.start, grasp.ray, ray, axis, {snap});
    if (!pose) return null;
    const poses = {[grasp.name]: pose};
    for (const [name, start] of Object.entries(grasp.others)) {
      poses[name] = grasp.mode === 'rotate' ? compose(pose, compose(inverse(grasp.first), start))
        : [...[0, 1, 2].map((i) => start[i] + pose[i] - grasp.first[i]), ...start.slice(3)];
    }
    return {poses};
  }

  #scaled(ray: Ray, event: MousePoint, key: AxisName|null, snap: boolean) {
    const grasp = this.#grasp;
    if (!grasp) return null;
    const axisName = key ?? grasp.handle;
    if (!axisName) return null;
    const axis = axisOf(grasp, axisName, false);
    const distance = alongAxis(ray, grasp.point, axis);
    const from = alongAxis(grasp.ray, grasp.point, axis) ?? 0;
    if (distance === null) return null;
    const model = this.store.model(grasp.name);
    if (!model) return null;
    return {factors: scaled(grasp.size, AXIS_INDEX[axisName], distance - from,
      {snap, uniform: Boolean(event.shiftKey), kind: roundness(model)})};
  }

  #show({poses, factors}: DragResult) {
    const name = this.#grasp?.name;
    if (name === undefined) return;
    if (factors) this.models.stretch(name, factors);
    else {
      this.#moveLights(poses);
      this.models.hold(Object.fromEntries(Object.entries(poses).filter(([one]) => !this.store.light(one))));
    }
    this.#moved();
  }

  #moveLights(poses: Record<string, Pose7|undefined>) {
    for (const [name, pose] of Object.entries(poses)) if (pose && this.store.light(name)) this.lights.move(name, pose);
  }

  #moved() {
    this.update();
    this.onMoved();
  }

  #send() {
    const poses = this.#result?.poses;
    const now = performance.now();
    if (!poses || now - this.#lastSent < DRAG_INTERVAL) return;
    const message = this.#message(poses);
    if (!message.names.length) return;
    this.#lastSent = now;
    if (this.#grasp) this.#grasp.sent = true;
    this.connection.send('drag', message);
  }

  #worldAxesWith(shift: boolean) {
    if (shift === this.#worldAxes) return;
    this.#worldAxes = shift;
    this.update();
  }
}
