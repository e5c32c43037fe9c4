/** The ghost of what is being added: it follows the mouse over what is seen there, a click puts it down. */
import {WORLD_AXES} from '../drag_math.js';
import {magnetic} from '../drag_snap.js';
import {axisAngle, multiply, orientation} from '../pose.js';
import {Landing} from './landing.js';
import {place} from './three_convert.js';
import {lightIcon} from './light_views.js';
import {free} from './markers.js';
import {standaloneModel} from './standalone_model.js';
import {Box3, Vector3} from 'three';
import {ViewPart} from './view_part.js';
import type {Group} from 'three';
import type {Pose7} from '../pose.js';
import type {Light, Model} from '../protocol.js';
import type {MousePoint} from './pointer.js';
import type {ViewParts} from './view.js';

/** Things whose boxes overlap by less only touch, m. */
const CLEAR = 0.01;
/** Places that are tried beside a taken one, in widths. */
const STEPS_ASIDE = [0, 1, -1, 2, -2, 3, -3, 4, -4];

const NO_BOX = {min: [0, 0, 0], max: [0, 0, 0]};

export class Placer extends ViewPart {
  #landing;
  /** How far it is turned about z, rad. */
  #turn = 0;
  /** Its box about its origin, along the world's axes, m. */
  #box: {min: number[], max: number[]} = NO_BOX;
  #ghost: Group|null = null;
  /** Where the mouse was last. */
  #pointed: MousePoint|null = null;
  #dispose = () => {};

  constructor(parts: ViewParts) {
    super(parts);
    this.#landing = new Landing(parts);
    this.store.listen('placing', () => this.#change());
  }

  /** Goes where the mouse is; with Ctrl to whole metres when near. */
  follow(event: MousePoint) {
    const pose = this.#pose(event);
    if (!this.#ghost || !pose) return;
    this.#pointed = event;
    this.#ghost.visible = true;
    place(this.#ghost, pose);
    this.stage.shadowsChanged();
  }

  /** The mouse has left the picture. */
  hide() {
    if (!this.#ghost?.visible) return;
    this.#ghost.visible = false;
    this.stage.shadowsChanged();
  }

  /** Turns it counterclockwise, seen from above. @param angle  rad */
  turn(angle: number) {
    this.#turn += angle;
    this.#measure();
    if (this.#pointed && this.#ghost?.visible) this.follow(this.#pointed);
  }

  /** Where something of 1 m lands under the mouse. */
  placeAt(event: MousePoint) {
    return this.#landing.under(event, {min: [-0.5, -0.5, 0], max: [0.5, 0.5, 1]})?.point ?? null;
  }

  /** Puts it down where the mouse is. */
  put(event: MousePoint) {
    const pose = this.#pose(event);
    if (pose) this.actions.place(pose);
  }

  /**
   * Puts it down where it is seen; without the mouse in the picture in the middle of the view, or below it
   * where the middle shows no ground, beside the moving models that are there.
   */
  putHere() {
    if (this.#ghost?.visible && this.#pointed) {
      this.put(this.#pointed);
      return;
    }
    const {left, top, width, height} = this.stage.canvas.getBoundingClientRect();
    for (const down of [0.5, 0.7, 0.9]) {
      const pose = this.#pose({clientX: left + width / 2, clientY: top + height * down},
        (model) => this.store.model(model)?.static ?? false);
      if (pose) {
        this.actions.place(this.#beside(pose));
        return;
      }
    }
  }

  /** The nearest pose at which no model is, to the right or left of a place; the place without one. */
  #beside(pose: Pose7): Pose7 {
    const {placing, document} = this.store;
    if (!this.#ghost || placing?.kind !== 'model') return pose;
    place(this.#ghost, pose);
    this.#ghost.updateMatrixWorld(true);
    const own = new Box3().setFromObject(this.#ghost).expandByScalar(-CLEAR);
    if (own.isEmpty()) return pose;
    const others = (document?.models ?? []).flatMap(({name}) => this.models.bounds(name) ?? []);
    const aside = new Vector3(1, 0, 0).transformDirection(this.stage.camera.matrixWorld).setZ(0).normalize()
      .multiplyScalar(own.getSize(new Vector3()).setZ(0).length() + 2 * CLEAR);
    for (const step of STEPS_ASIDE) {
      const shift = aside.clone().multiplyScalar(step);
      const there = own.clone().translate(shift);
      if (!others.some((box) => box.intersectsBox(there))) {
        return [pose[0] + shift.x, pose[1] + shift.y, ...pose.slice(2)] as Pose7;
      }
    }
    return pose;
  }

  /** Keeps its own height over what carries it (Gazebo behaviour: over the ground). */
  #pose(event: MousePoint, accept?: (model: string) => boolean): Pose7|null {
    const {placing} = this.store;
    const place = placing && this.#landing.under(event, this.#box, accept);
    if (!place) return null;
    // Beside a wall, a whole metre may be inside of it.
    const snaps = place.level && (event.ctrlKey || event.metaKey);
    const [x, y] = snaps ? place.point.map((part) => magnetic(part)) : place.point;
    const [, , ground] = place.point;
    // What is copied may have stood on something itself.
    const stands = placing.keepHeight && placing.kind === 'model' && Math.abs(ground) > CLEAR;
    return [x, y, ground + (stands ? -this.#box.min[2] : placing.document.pose[2]), ...this.#orientation(placing.document.pose)];
  }

  #orientation(pose: Pose7) {
    return multiply(axisAngle(WORLD_AXES.z, this.#turn), orientation(pose));
  }

  /** Finds the box of the ghost as it is turned. */
  #measure() {
    const {placing} = this.store;
    if (!this.#ghost || placing?.kind !== 'model') return;
    const {position, quaternion} = this.#ghost;
    const [at, turn] = [position.clone(), quaternion.clone()];
    place(this.#ghost, [0, 0, 0, ...this.#orientation(placing.document.pose)]);
    this.#ghost.updateMatrixWorld(true);
    const box = new Box3().setFromObject(this.#ghost);
    this.#box = box.isEmpty() ? NO_BOX : {min: box.min.toArray(), max: box.max.toArray()};
    position.copy(at);
    quaternion.copy(turn);
  }

  #change() {
    if (this.#ghost) this.stage.scene.remove(this.#ghost);
    this.#dispose();
    this.#ghost = null;
    this.#turn = 0;
    this.#box = NO_BOX;
    this.#dispose = () => {};
    const {placing} = this.store;
    if (placing) {
      // Enter and Escape mean what is being placed, also after a button was pressed by a key.
      this.stage.canvas.parentElement?.focus({preventScroll: true});
      const ghost = placing.kind === 'light' ? this.#lightGhost(placing.document)
        : this.#modelGhost(placing.document);
      ghost.visible = false;
      this.stage.scene.add(ghost);
      this.#ghost = ghost;
      this.#measure();
    } else if (document.activeElement === document.body) {
      // The arrow keys drive a robot that was just placed.
      this.stage.canvas.parentElement?.focus({preventScroll: true});
    }
    this.stage.shadowsChanged();
  }

  #lightGhost(document: Light) {
    const group = lightIcon(document);
    this.#dispose = () => free(group);
    return group;
  }

  #modelGhost(document: Model) {
    const {group, ready, dispose} = standaloneModel(document, this.stock, {opacity: 0.75});
    this.#dispose = dispose;
    ready.then(() => {
      if (this.#ghost === group) this.#measure();
      this.stage.shadowsChanged();
    });
    return group;
  }
}
