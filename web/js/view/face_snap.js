/** The snap tool (N): a face of one model against a face of another, with two clicks. */
import {BufferAttribute, BufferGeometry, DoubleSide, Mesh} from 'three';
import {snapped} from '../face_math.js';
import {through} from './markers.js';
/** @import {Face} from '../face_math.js' */
/** @import {MousePoint} from './pointer.js' */
/** @import {ViewParts} from './view.js' */

/** @param {number} color */
function triangle(color) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(9), 3));
  const material = through(color, 0.75);
  material.side = DoubleSide;
  const mesh = new Mesh(geometry, material);
  mesh.renderOrder = 80;
  mesh.visible = false;
  mesh.frustumCulled = false;
  return mesh;
}

export class FaceSnap {
  #store;
  #actions;
  #batches;
  #models;
  #picker;
  #stage;
  #hovered = triangle(0xff2a2a);
  #chosen = triangle(0xff9f1c);
  /** The face that was chosen first. @type {{model: string, face: Face}|null} */
  #first = null;

  /** @param {ViewParts} viewParts */
  constructor({store, actions, batches, models, picker, stage}) {
    this.#store = store;
    this.#actions = actions;
    this.#batches = batches;
    this.#models = models;
    this.#picker = picker;
    this.#stage = stage;
    stage.scene.add(this.#hovered, this.#chosen);
    store.listen('mode', () => this.#reset());
  }

  /** Marks the face under the mouse. @param {MousePoint} event */
  hover(event) {
    this.#mark(this.#hovered, this.#under(event)?.face ?? null);
  }

  leave() {
    this.#mark(this.#hovered, null);
  }

  /** The first click chooses what moves, the second where to. @param {MousePoint} event */
  async click(event) {
    const hit = this.#under(event);
    if (!hit) return;
    const {model} = hit.owner;
    if (!this.#first || this.#first.model === model) {
      if (hit.owner.plane) return;
      this.#first = {model, face: hit.face};
      this.#store.select([model]);
      this.#mark(this.#chosen, hit.face);
      return;
    }
    const {model: name, face} = this.#first;
    const before = this.#store.worldPose(name);
    if (!before) return;
    const pose = snapped(before, face, hit.face);
    this.#store.setMode('select');
    await this.#models.carry({[name]: pose}, this.#actions.move({[name]: pose}, 'snap'));
  }

  /** @param {MousePoint} mousePoint */
  #under({clientX, clientY}) {
    return this.#picker.nearest(this.#batches.items(), clientX, clientY,
      (owner) => owner.model !== undefined);
  }

  /** @param {Mesh} mesh @param {Face|null} face */
  #mark(mesh, face) {
    if (!face && !mesh.visible) return;
    mesh.visible = face !== null;
    if (face) {
      const corners = mesh.geometry.getAttribute('position');
      corners.array.set(face.corners.flat());
      corners.needsUpdate = true;
    }
    this.#stage.invalidate();
  }

  #reset() {
    this.#first = null;
    this.#mark(this.#hovered, null);
    this.#mark(this.#chosen, null);
  }
}
