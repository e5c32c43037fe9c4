/** Arrows for the force dialog; their tips can be dragged to turn them. */
import {Group} from 'three';
import {
  conjugate, length, normalized, orientation, rotate, scale, subtract, transform,
} from '../pose.js';
import {arrow, empty, point, through} from './markers.js';
/** @import {MousePoint} from './pointer.js' */
/** @import {Ray} from '../drag_math.js' */
/** @import {ShownWrench} from '../actions.js' */
/** @import {Vec3} from '../pose.js' */
/** @import {ViewParts} from './view.js' */

/**
 * A wrench's vectors that were turned by hand, N and N m.
 * @typedef {{force?: Vec3, torque?: Vec3}} Turned
 */

/** @type {Record<'force'|'torque', number>} */
const COLOR = {force: 0xff7a00, torque: 0xb5179e};
const PIXELS = 120;
const KINDS = /** @type {const} */ (['force', 'torque']);

/**
 * The nearest point to `centre` on a sphere's near side under a ray: where a tip goes.
 * @param {Ray} ray
 * @param {Vec3} centre
 * @param {number} radius
 */
function onSphere(ray, centre, radius) {
  const between = subtract(centre, ray.origin);
  const along = between.reduce((sum, part, i) => sum + part * ray.direction[i], 0);
  const near = ray.origin.map((part, i) => part + along * ray.direction[i]);
  const off = subtract(near, centre);
  const miss = length(off);
  if (miss >= radius) return scale(off, 1 / miss);
  const depth = Math.sqrt(radius * radius - miss * miss);
  return normalized(off.map((part, i) => part - depth * ray.direction[i]));
}

export class Forces {
  #store;
  #models;
  #picker;
  #rig;
  #stage;
  #group = new Group();
  /** @type {ShownWrench|null} */
  #wrench = null;
  /** @type {((turned: Turned) => void)|null} */
  #onTurned = null;
  /** @type {'force'|'torque'|null} */
  #held = null;

  /** @param {ViewParts} viewParts */
  constructor({store, models, picker, rig, stage}) {
    this.#store = store;
    this.#models = models;
    this.#picker = picker;
    this.#rig = rig;
    this.#stage = stage;
    stage.scene.add(this.#group);
  }

  /**
   * @param {ShownWrench|null} wrench  null takes the arrows away
   * @param {((turned: Turned) => void)|null} [onTurned]  told while an
   *        arrow is dragged; magnitudes stay
   */
  show(wrench, onTurned = null) {
    this.#wrench = wrench;
    this.#onTurned = onTurned;
    empty(this.#group);
    for (const kind of KINDS) {
      if (!wrench || !length(wrench[kind])) continue;
      const mark = arrow([0, 0, 1], through(COLOR[kind], 0.95));
      mark.userData.kind = kind;
      this.#group.add(mark);
    }
    this.update();
    this.#stage.invalidate();
  }

  /** Keeps the arrows at the link, and of one size on the screen. */
  update() {
    const frame = this.#frame();
    this.#group.visible = frame !== null;
    const wrench = this.#wrench;
    if (!frame || !wrench) return;
    for (const mark of this.#group.children) {
      const vector = mark.userData.kind === 'force' ? wrench.force : wrench.torque;
      const direction = wrench.in_link_axes ? rotate(frame.axes, vector) : vector;
      mark.position.fromArray(frame.place);
      mark.scale.setScalar(PIXELS * this.#rig.unitAt(frame.place));
      point(mark, direction);
    }
  }

  /** @param {MousePoint} event */
  hover(event) {
    return this.#under(event) !== null;
  }

  /** @param {MousePoint} event */
  grab(event) {
    this.#held = this.#under(event);
    return this.#held !== null;
  }

  /** @param {MousePoint} event */
  drag(event) {
    const frame = this.#frame();
    const wrench = this.#wrench;
    if (!this.#held || !frame || !wrench) return;
    const ray = this.#picker.ray(event.clientX, event.clientY);
    const radius = PIXELS * this.#rig.unitAt(frame.place);
    let way = onSphere(ray, frame.place, radius);
    if (wrench.in_link_axes) way = rotate(conjugate(frame.axes), way);
    const turned = scale(way, length(wrench[this.#held]));
    this.#wrench = {...wrench, [this.#held]: turned};
    this.#onTurned?.({[this.#held]: turned});
    this.update();
    this.#stage.invalidate();
  }

  release() {
    this.#held = null;
  }

  /** @param {MousePoint} mousePoint */
  #under({clientX, clientY}) {
    if (!this.#wrench || !this.#onTurned) return null;
    const [hit] = this.#picker.objects(this.#group.children, clientX, clientY);
    return KINDS.find((kind) => hit?.object.parent?.userData.kind === kind) ?? null;
  }

  #frame() {
    const wrench = this.#wrench;
    const entity = wrench && this.#store.entity(wrench.link);
    const pose = wrench && this.#models.shownPose(wrench.link);
    if (!wrench || !pose || entity?.kind !== 'link') return null;
    const at = wrench.point ?? entity.link.inertial.pose.slice(0, 3);
    return {place: transform(pose, at), axes: orientation(pose)};
  }
}
