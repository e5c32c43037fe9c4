/** The ghost of what is being added: it follows the mouse over the ground, a click puts it down. */
import {rayPlane, WORLD_AXES} from '../drag_math.js';
import {magnetic} from '../drag_snap.js';
import {place} from './three_convert.js';
import {lightIcon} from './light_views.js';
import {free} from './markers.js';
import {standaloneModel} from './standalone_model.js';
import type {Group} from 'three';
import type {Light, Model} from '../protocol.js';
import type {MousePoint} from './pointer.js';
import type {ViewParts} from './view.js';

export class Placer {
  #store;
  #actions;
  #picker;
  #stage;
  #stock;
  #ghost: Group|null = null;
  #dispose = () => {};

  constructor({store, actions, picker, stage, stock}: ViewParts) {
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

  /** Puts it down in the middle of the view, or below it where the middle shows no ground. */
  putInMiddle() {
    const {left, top, width, height} = this.#stage.canvas.getBoundingClientRect();
    for (const down of [0.5, 0.7, 0.9]) {
      const pose = this.#pose({clientX: left + width / 2, clientY: top + height * down});
      if (pose) {
        this.#actions.place(pose);
        return;
      }
    }
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
