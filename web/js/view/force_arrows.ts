/** Arrows for the force dialog; their tips can be dragged to turn them. */
import {Group} from 'three';
import {
  conjugate, length, normalized, orientation, rotate, scale, subtract, transform,
} from '../pose.js';
import {arrow, empty, point, through} from './markers.js';
import {ViewPart} from './view_part.js';
import type {MousePoint} from './pointer.js';
import type {Ray} from '../drag_math.js';
import type {ShownWrench} from '../actions.js';
import type {Vec3} from '../pose.js';
import type {ViewParts} from './view.js';

/** A wrench's vectors that were turned by hand, N and N m. */
export type Turned = {force?: Vec3, torque?: Vec3};

const COLOR: Record<'force'|'torque', number> = {force: 0xff7a00, torque: 0xb5179e};
const PIXELS = 120;
const KINDS = ['force', 'torque'] as const;

/** The nearest point to `centre` on a sphere's near side under a ray: where a tip goes. */
function onSphere(ray: Ray, centre: Vec3, radius: number) {
  const between = subtract(centre, ray.origin);
  const along = between.reduce((sum, part, i) => sum + part * ray.direction[i], 0);
  const near = ray.origin.map((part, i) => part + along * ray.direction[i]);
  const off = subtract(near, centre);
  const miss = length(off);
  if (miss >= radius) return scale(off, 1 / miss);
  const depth = Math.sqrt(radius * radius - miss * miss);
  return normalized(off.map((part, i) => part - depth * ray.direction[i]));
}

export class Forces extends ViewPart {
  #group = new Group();
  #wrench: ShownWrench|null = null;
  #onTurned: ((turned: Turned) => void)|null = null;
  #held: 'force'|'torque'|null = null;

  constructor(parts: ViewParts) {
    super(parts);
    this.stage.scene.add(this.#group);
  }

  /**
   * @param wrench  null takes the arrows away
   * @param onTurned  told while an
   * arrow is dragged; magnitudes stay
   */
  show(wrench: ShownWrench|null, onTurned: ((turned: Turned) => void)|null = null) {
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
    this.stage.invalidate();
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
      mark.scale.setScalar(PIXELS * this.rig.unitAt(frame.place));
      point(mark, direction);
    }
  }

  hover(event: MousePoint) {
    return this.#under(event) !== null;
  }

  grab(event: MousePoint) {
    this.#held = this.#under(event);
    return this.#held !== null;
  }

  drag(event: MousePoint) {
    const frame = this.#frame();
    const wrench = this.#wrench;
    if (!this.#held || !frame || !wrench) return;
    const ray = this.picker.ray(event.clientX, event.clientY);
    const radius = PIXELS * this.rig.unitAt(frame.place);
    let way = onSphere(ray, frame.place, radius);
    if (wrench.in_link_axes) way = rotate(conjugate(frame.axes), way);
    const turned = scale(way, length(wrench[this.#held]));
    this.#wrench = {...wrench, [this.#held]: turned};
    this.#onTurned?.({[this.#held]: turned});
    this.update();
    this.stage.invalidate();
  }

  release() {
    this.#held = null;
  }

  #under({clientX, clientY}: MousePoint) {
    if (!this.#wrench || !this.#onTurned) return null;
    const [hit] = this.picker.objects(this.#group.children, clientX, clientY);
    return KINDS.find((kind) => hit?.object.parent?.userData.kind === kind) ?? null;
  }

  #frame() {
    const wrench = this.#wrench;
    const entity = wrench && this.store.entity(wrench.link);
    const pose = wrench && this.models.shownPose(wrench.link);
    if (!wrench || !pose || entity?.kind !== 'link') return null;
    const at = wrench.point ?? entity.link.inertial.pose.slice(0, 3);
    return {place: transform(pose, at), axes: orientation(pose)};
  }
}
