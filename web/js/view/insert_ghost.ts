/** The ghost of what is being added: it follows the mouse over the ground, a click puts it down. */
import {rayPlane, WORLD_AXES} from '../drag_math.js';
import {magnetic} from '../drag_snap.js';
import {place} from './three_convert.js';
import {lightIcon} from './light_views.js';
import {free} from './markers.js';
import {standaloneModel} from './standalone_model.js';
import {Box3, Vector3} from 'three';
import type {Group} from 'three';
import type {Pose7} from '../pose.js';
import type {Light, Model} from '../protocol.js';
import type {MousePoint} from './pointer.js';
import type {ViewParts} from './view.js';

/** Things whose boxes overlap by less only touch, m. */
const CLEAR = 0.01;
/** Places that are tried beside a taken one, in widths. */
const STEPS_ASIDE = [0, 1, -1, 2, -2, 3, -3, 4, -4];

export class Placer {
  #store;
  #actions;
  #picker;
  #stage;
  #stock;
  #models;
  #ghost: Group|null = null;
  /** Where the mouse was last. */
  #pointed: MousePoint|null = null;
  #dispose = () => {};

  constructor({store, actions, picker, stage, stock, models}: ViewParts) {
    this.#models = models;
    this.#store = store;
    this.#actions = actions;
    this.#picker = picker;
    this.#stage = stage;
    this.#stock = stock;
    store.listen('placing', () => this.#change());
  }

  /** Goes where the mouse is; with Ctrl to whole metres when near. */
  follow(event: MousePoint) {
    const pose = this.#pose(event);
    if (!this.#ghost || !pose) return;
    this.#pointed = event;
    this.#ghost.visible = true;
    place(this.#ghost, pose);
    this.#stage.shadowsChanged();
  }

  /** The mouse has left the picture. */
  hide() {
    if (!this.#ghost?.visible) return;
    this.#ghost.visible = false;
    this.#stage.shadowsChanged();
  }

  /** The point of the ground under the mouse. */
  groundAt({clientX, clientY}: MousePoint) {
    return rayPlane(this.#picker.ray(clientX, clientY), [0, 0, 0], WORLD_AXES.z);
  }

  /** Puts it down where the mouse is. */
  put(event: MousePoint) {
    const pose = this.#pose(event);
    if (pose) this.#actions.place(pose);
  }

  /**
   * Puts it down where it is seen; without the mouse in the picture in the middle of the view, or below it
   * where the middle shows no ground, beside the models that are there.
   */
  putHere() {
    if (this.#ghost?.visible && this.#pointed) {
      this.put(this.#pointed);
      return;
    }
    const {left, top, width, height} = this.#stage.canvas.getBoundingClientRect();
    for (const down of [0.5, 0.7, 0.9]) {
      const pose = this.#pose({clientX: left + width / 2, clientY: top + height * down});
      if (pose) {
        this.#actions.place(this.#beside(pose));
        return;
      }
    }
  }

  /** The nearest pose at which no model is, to the right or left of a place; the place without one. */
  #beside(pose: Pose7): Pose7 {
    const {placing, document} = this.#store;
    if (!this.#ghost || placing?.kind !== 'model') return pose;
    place(this.#ghost, pose);
    this.#ghost.updateMatrixWorld(true);
    const own = new Box3().setFromObject(this.#ghost).expandByScalar(-CLEAR);
    if (own.isEmpty()) return pose;
    const others = (document?.models ?? []).flatMap(({name}) => this.#models.bounds(name) ?? []);
    const aside = new Vector3(1, 0, 0).transformDirection(this.#stage.camera.matrixWorld).setZ(0).normalize()
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

  /** Keeps its own height and turn (Gazebo behaviour). */
  #pose({clientX, clientY, ctrlKey, metaKey}: MousePoint) {
    const {placing} = this.#store;
    if (!placing) return null;
    const ray = this.#picker.ray(clientX, clientY);
    const hit = rayPlane(ray, [0, 0, 0], WORLD_AXES.z);
    if (!hit) return null;
    const [x, y] = ctrlKey || metaKey ? hit.map((part) => magnetic(part)) : hit;
    return [x, y, ...placing.document.pose.slice(2)];
  }

  #change() {
    if (this.#ghost) this.#stage.scene.remove(this.#ghost);
    this.#dispose();
    this.#ghost = null;
    this.#dispose = () => {};
    const {placing} = this.#store;
    if (placing) {
      // Enter and Escape mean what is being placed, also after a button was pressed by a key.
      this.#stage.canvas.parentElement?.focus({preventScroll: true});
      const ghost = placing.kind === 'light' ? this.#lightGhost(placing.document)
        : this.#modelGhost(placing.document);
      ghost.visible = false;
      this.#stage.scene.add(ghost);
      this.#ghost = ghost;
    } else if (document.activeElement === document.body) {
      // The arrow keys drive a robot that was just placed.
      this.#stage.canvas.parentElement?.focus({preventScroll: true});
    }
    this.#stage.shadowsChanged();
  }

  #lightGhost(document: Light) {
    const group = lightIcon(document);
    this.#dispose = () => free(group);
    return group;
  }

  #modelGhost(document: Model) {
    const {group, ready, dispose} = standaloneModel(document, this.#stock, {opacity: 0.75});
    this.#dispose = dispose;
    ready.then(() => this.#stage.shadowsChanged());
    return group;
  }
}
