/** Arrows for the force dialog; their tips can be dragged to turn them. */
import {Group} from 'three';
import {
  conjugate, length, normalized, orientation, rotate, scale, subtract, transform,
} from '../pose.js';
import {arrow, empty, point, through} from './markers.js';

const COLOR = {force: 0xff7a00, torque: 0xb5179e};
const PIXELS = 120;

/** The nearest point to `centre` on a sphere's near side under a ray: where a tip goes. */
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
  #wrench = null;
  #onTurned = null;
  #held = null;

  constructor({store, models, picker, rig, stage}) {
    this.#store = store;
    this.#models = models;
    this.#picker = picker;
    this.#rig = rig;
    this.#stage = stage;
    stage.scene.add(this.#group);
  }

  /**
   * @param {{link: string, force: number[], torque: number[], point?: number[],
   *          in_link_axes?: boolean}|null} wrench  null takes the arrows away
   * @param {(turned: {force?: number[], torque?: number[]}) => void} [onTurned]  told while an
   *        arrow is dragged; magnitudes stay
   */
  show(wrench, onTurned = null) {
    this.#wrench = wrench;
    this.#onTurned = onTurned;
    empty(this.#group);
    for (const kind of ['force', 'torque']) {
      if (!wrench || !length(wrench[kind] ?? [0, 0, 0])) continue;
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
    if (!frame) return;
    for (const mark of this.#group.children) {
      const vector = this.#wrench[mark.userData.kind];
      const direction = this.#wrench.in_link_axes ? rotate(frame.axes, vector) : vector;
      mark.position.set(...frame.place);
      mark.scale.setScalar(PIXELS * this.#rig.unitAt(frame.place));
      point(mark, direction);
    }
  }

  hover(event) {
    return this.#under(event) !== null;
  }

  grab(event) {
    this.#held = this.#under(event);
    return this.#held !== null;
  }

  drag(event) {
    const frame = this.#frame();
    if (!this.#held || !frame) return;
    const ray = this.#picker.ray(event.clientX, event.clientY);
    const radius = PIXELS * this.#rig.unitAt(frame.place);
    let way = onSphere(ray, frame.place, radius);
    if (this.#wrench.in_link_axes) way = rotate(conjugate(frame.axes), way);
    const turned = scale(way, length(this.#wrench[this.#held]));
    this.#wrench = {...this.#wrench, [this.#held]: turned};
    this.#onTurned?.({[this.#held]: turned});
    this.update();
    this.#stage.invalidate();
  }

  release() {
    this.#held = null;
  }

  #under({clientX, clientY}) {
    if (!this.#wrench || !this.#onTurned) return null;
    const [hit] = this.#picker.objects(this.#group.children, clientX, clientY);
    return hit ? hit.object.parent.userData.kind : null;
  }

  #frame() {
    const entity = this.#wrench && this.#store.entity(this.#wrench.link);
    if (entity?.kind !== 'link') return null;
    const pose = this.#models.shownPose(this.#wrench.link);
    const at = this.#wrench.point ?? entity.link.inertial.pose.slice(0, 3);
    return {place: transform(pose, at), axes: orientation(pose)};
  }
}
