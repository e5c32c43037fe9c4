/** Moving, turning and scaling with the mouse: by the handles, or by the body itself. */
import {
  alongAxis, rotated, roundness, scaled, translated, WORLD_AXES,
} from '../drag_math.js';
import {orientation, position, rotate} from '../pose.js';
import {Gizmo} from './gizmo.js';

const DRAG_INTERVAL = 40;
const LABELS = {translate: 'translate', rotate: 'rotate'};

/**
 * @typedef {object} Grasp
 * @property {string} name          what is dragged
 * @property {'translate'|'rotate'|'scale'} mode
 * @property {string|null} handle   axis of the handle, null: the body
 * @property {number[]} start       pose7 when the drag began, or its base was changed
 * @property {number[]} point       grasped, world
 * @property {any} ray              when the drag began
 * @property {number[]} size        for scaling: extent along the own axes
 * @property {Record<string, number[]>} others  what moves along, poses at the start
 * @property {string} how           axis and frame in force; a change begins the drag anew
 */

/** Whether a drag has left everything as it was: that is no step of the history. */
function isNothing(grasp, {poses, factors}) {
  if (factors) return factors.every((factor) => factor === 1);
  if (grasp.sent) return false;
  return poses[grasp.name].every((part, i) => Math.abs(part - grasp.first[i]) < 1e-9);
}

export class Manipulator {
  #store;
  #actions;
  #connection;
  #models;
  #lights;
  #rig;
  #picker;
  #stage;
  #gizmo;
  /** @type {Grasp|null} */
  #grasp = null;
  #result = null;
  #lastSent = 0;
  #lastEvent = null;
  #worldAxes = false;

  /** Called when something is moved by hand, so that boxes and overlays go along. */
  onMoved = () => {};

  constructor({store, actions, connection, models, lights, rig, picker, stage}) {
    this.#store = store;
    this.#actions = actions;
    this.#connection = connection;
    this.#models = models;
    this.#lights = lights;
    this.#rig = rig;
    this.#picker = picker;
    this.#stage = stage;
    this.#gizmo = new Gizmo(stage.scene);
    for (const event of ['selection', 'mode', 'document', 'entity']) {
      store.addEventListener(event, () => this.update());
    }
  }

  get dragging() { return this.#grasp !== null; }

  /** The one that has the handles: the last selected model or light. @returns {string|null} */
  get target() {
    const {mode, selection} = this.#store;
    if (!LABELS[mode] && mode !== 'scale') return null;
    const name = selection.at(-1);
    const entity = name && this.#store.entity(name);
    if (!entity) return null;
    if (entity.kind === 'link') return entity.model.name;
    if (entity.kind === 'light' && mode === 'scale') return null;
    return name;
  }

  /** Puts the handles where the target is shown. */
  update() {
    const name = this.target;
    this.#gizmo.show(name ? this.#store.mode : null);
    if (name) {
      const pose = this.#shown(name);
      const turned = this.#worldAxes && this.#store.mode !== 'scale';
      const axes = turned ? [0, 0, 0, 1] : orientation(pose);
      this.#gizmo.place([...position(pose), ...axes], this.#rig.unitAt(position(pose)));
    }
    this.#stage.invalidate();
  }

  /** Lights up the handle under the mouse. @returns {boolean} whether there is one */
  hover(event) {
    this.#worldAxesWith(event.shiftKey);
    const axis = this.#handleUnder(event);
    if (this.#gizmo.light(axis)) this.#stage.invalidate();
    return axis !== null;
  }

  /**
   * Takes hold of a handle, or of a body in a mode that moves bodies.
   * @param {PointerEvent} event
   * @param {() => {name: string, point: number[]}|null} pick  what body is under the mouse
   * @param {string|null} key  x, y or z when held
   * @returns {boolean} whether the drag is ours
   */
  grab(event, pick, key) {
    const {mode} = this.#store;
    if (!LABELS[mode] && mode !== 'scale') return false;
    const handle = this.#handleUnder(event);
    if (handle) {
      const name = this.target;
      return this.#take(event, name, handle, position(this.#shown(name)), key);
    }
    const body = pick();
    if (!body) return false;
    if (!this.#store.selection.includes(body.name)) this.#store.select([body.name]);
    if (mode !== 'translate' && !key) return true;
    if (this.target === null) return true;
    return this.#take(event, body.name, null, body.point, key);
  }

  /** Follows the mouse. */
  drag(event, key) {
    if (!this.#grasp) return;
    this.#lastEvent = event;
    const ray = this.#picker.ray(event.clientX, event.clientY);
    this.#rebase(ray, event, key);
    const made = this.#apply(ray, event, key);
    if (!made) return;
    this.#result = made;
    this.#show(made);
    this.#send();
  }

  /** A held key has changed while the mouse rests. */
  keysChanged(event, key) {
    this.#worldAxesWith(event.shiftKey);
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
      ? await this.#actions.scale(grasp.name, result.factors)
      : await this.#actions.move(result.poses, LABELS[grasp.mode]);
    this.#end(grasp, outcome.ok && !result.factors);
  }

  /** Gives a drag up; everything is where it was. @returns {boolean} whether there was one */
  cancel() {
    const grasp = this.#grasp;
    if (!grasp) return false;
    this.#grasp = this.#result = this.#lastEvent = null;
    if (grasp.sent) {
      this.#connection.send('drag', this.#message({[grasp.name]: grasp.first, ...grasp.others}));
    }
    this.#end(grasp, false);
    return true;
  }

  #message(poses) {
    const names = Object.keys(poses).filter((name) => this.#store.model(name));
    return {names, poses: names.map((name) => poses[name])};
  }

  #end(grasp, keep) {
    if (grasp.sent) this.#connection.send('drag_end');
    const names = [grasp.name, ...Object.keys(grasp.others)];
    // A next drag may have begun while the simulator answered.
    if (this.#grasp && names.includes(this.#grasp.name)) return;
    for (const name of names) this.#models.fade(name, false);
    this.#models.release(names, {keep});
    const light = this.#store.light(grasp.name);
    if (light && !keep) this.#lights.move(grasp.name, light.pose);
    this.#moved();
  }

  #shown(name) {
    if (this.#grasp?.name === name && this.#result?.poses) return this.#result.poses[name];
    return this.#models.shownPose(name);
  }

  #handleUnder(event) {
    if (!this.#gizmo.shown) return null;
    const [hit] = this.#picker.objects(this.#gizmo.grips, event.clientX, event.clientY);
    return hit ? Gizmo.axisOf(hit.object) : null;
  }

  #take(event, name, handle, point, key) {
    const {mode} = this.#store;
    const model = this.#store.model(name);
    if (mode === 'scale' && (!model || !model.scalable)) {
      this.#store.addIssue({severity: 'note', code: 'not-scalable',
        message: `${name} cannot be scaled: it has several links or shapes that are not centred.`});
      return true;
    }
    const pose = this.#models.shownPose(name);
    const others = {};
    if (mode === 'translate') {
      for (const other of this.#store.selection) {
        if (other !== name && this.#store.model(other)) {
          others[other] = this.#models.shownPose(other);
        }
      }
    }
    const size = mode === 'scale' ? this.#models.bounds(name, pose) : null;
    this.#grasp = {name, mode, handle, start: pose, first: pose, point, others, sent: false,
      size: size ? size.max.clone().sub(size.min).toArray() : [1, 1, 1], factors: [1, 1, 1],
      ray: this.#picker.ray(event.clientX, event.clientY), how: this.#how(handle, key, event)};
    this.#grasp.point = this.#graspedPoint(point);
    if (model) for (const one of [name, ...Object.keys(others)]) this.#models.fade(one, true);
    return true;
  }

  /** With a handle the drag is along its axis: from the point of it under the mouse. */
  #graspedPoint(point) {
    const {handle, ray} = this.#grasp;
    const axis = handle && this.#axis(handle, false);
    const along = axis && alongAxis(ray, point, axis);
    return along ? point.map((part, index) => part + along * axis[index]) : point;
  }

  #how(handle, key, event) {
    return `${key ?? handle ?? ''} ${event.shiftKey}`;
  }

  /** x, y or z held or let go, or Shift: the drag goes on from where it is, in the new way. */
  #rebase(ray, event, key) {
    const grasp = this.#grasp;
    const how = this.#how(grasp.handle, key, event);
    if (how === grasp.how) return;
    grasp.how = how;
    if (grasp.mode === 'scale') return;
    const now = this.#result?.poses?.[grasp.name] ?? grasp.start;
    grasp.point = grasp.point.map((part, index) => part + now[index] - grasp.start[index]);
    grasp.start = now;
    grasp.ray = ray;
  }

  #axis(name, world) {
    if (world) return WORLD_AXES[name];
    return rotate(orientation(this.#grasp.first), WORLD_AXES[name]);
  }

  #apply(ray, event, key) {
    const grasp = this.#grasp;
    const snap = event.ctrlKey || event.metaKey;
    if (grasp.mode === 'scale') return this.#scaled(ray, event, key, snap);
    // A held key means the world's axis when moving (Gazebo behaviour), the handles' when turning.
    const axisName = key ?? grasp.handle;
    const world = event.shiftKey || (grasp.mode === 'translate' && key !== null);
    const axis = axisName ? this.#axis(axisName, world) : null;
    const pose = grasp.mode === 'translate'
      ? translated(grasp.start, grasp.point, ray, {axis, snap})
      : axis && rotated(grasp.start, grasp.ray, ray, axis, {snap});
    if (!pose) return null;
    const poses = {[grasp.name]: pose};
    for (const [name, start] of Object.entries(grasp.others)) {
      poses[name] = [...[0, 1, 2].map((i) => start[i] + pose[i] - grasp.first[i]),
        ...start.slice(3)];
    }
    return {poses};
  }

  #scaled(ray, event, key, snap) {
    const grasp = this.#grasp;
    const axisName = key ?? grasp.handle;
    if (!axisName) return null;
    const axis = this.#axis(axisName, false);
    const distance = alongAxis(ray, grasp.point, axis);
    const from = alongAxis(grasp.ray, grasp.point, axis) ?? 0;
    if (distance === null) return null;
    return {factors: scaled(grasp.size, 'xyz'.indexOf(axisName), distance - from,
      {snap, uniform: event.shiftKey, kind: roundness(this.#store.model(grasp.name))})};
  }

  #show({poses, factors}) {
    const {name} = this.#grasp;
    if (factors) this.#models.stretch(name, factors);
    else if (this.#store.light(name)) this.#lights.move(name, poses[name]);
    else this.#models.hold(poses);
    this.#moved();
  }

  #moved() {
    this.update();
    this.onMoved();
  }

  #send() {
    const {poses} = this.#result;
    const now = performance.now();
    if (!poses || now - this.#lastSent < DRAG_INTERVAL) return;
    const message = this.#message(poses);
    if (!message.names.length) return;
    this.#lastSent = now;
    this.#grasp.sent = true;
    this.#connection.send('drag', message);
  }

  #worldAxesWith(shift) {
    if (shift === this.#worldAxes) return;
    this.#worldAxes = shift;
    this.update();
  }
}
