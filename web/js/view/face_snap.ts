/** The snap tool (N): a face of one model against a face of another, with two clicks. */
import {BufferAttribute, BufferGeometry, DoubleSide, Mesh, Vector3} from 'three';
import {snapped} from '../face_math.js';
import {through} from './markers.js';
import {ViewPart} from './view_part.js';
import type {Face} from '../face_math.js';
import type {MousePoint} from './pointer.js';
import type {ViewParts} from './view.js';

function triangle(color: number) {
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

export class FaceSnap extends ViewPart {
  #hovered = triangle(0xff2a2a);
  #chosen = triangle(0xff9f1c);
  /** The face that was chosen first, in its link's frame: the link may go on moving. */
  #first: {model: string, link: number, corners: Vector3[]}|null = null;

  constructor(parts: ViewParts) {
    super(parts);
    const {store, stage} = parts;
    stage.scene.add(this.#hovered, this.#chosen);
    store.listen('mode', () => this.#reset());
    for (const event of ['document', 'entity'] as const) {
      store.listen(event, () => this.follow());
    }
  }

  /** Keeps the chosen face on its link; gives it up when that has gone. */
  follow() {
    if (!this.#first) return;
    const face = this.#chosenFace(this.#first);
    if (!face) this.#first = null;
    this.#mark(this.#chosen, face);
  }

  /** Marks the face under the mouse. */
  hover(event: MousePoint) {
    this.#mark(this.#hovered, this.#under(event)?.face ?? null);
  }

  leave() {
    this.#mark(this.#hovered, null);
  }

  /** The first click chooses the model to move, the second its target. */
  async click(event: MousePoint) {
    const hit = this.#under(event);
    if (!hit) return;
    const {model, linkId, plane} = hit.owner;
    const first = this.#first;
    const face = first && this.#chosenFace(first);
    if (!first || !face || first.model === model) {
      if (plane) return;
      const within = this.models.linkMatrix(linkId)?.clone().invert();
      if (!within) return;
      this.#first = {model, link: linkId, corners: hit.face.corners.map((corner) =>
        new Vector3().fromArray(corner).applyMatrix4(within))};
      this.store.select([model]);
      this.#mark(this.#chosen, hit.face);
      return;
    }
    const name = first.model;
    // As it is shown: both faces are.
    const before = this.models.shownPose(name);
    if (!before) return;
    const pose = snapped(before, face, hit.face);
    this.store.setMode('select');
    await this.models.carry({[name]: pose}, this.actions.move({[name]: pose}, 'snap'));
  }

  /** In the world, where its link is shown now. */
  #chosenFace({model, link, corners}: {model: string, link: number, corners: Vector3[]}): Face|null {
    const matrix = this.store.model(model)?.links.some(({id}) => id === link) &&
      this.models.linkMatrix(link);
    if (!matrix) return null;
    return {corners: corners.map((corner) => corner.clone().applyMatrix4(matrix).toArray())};
  }

  #under({clientX, clientY}: MousePoint) {
    return this.picker.nearest(this.batches.items(), clientX, clientY,
      (owner) => owner.model !== undefined);
  }

  #mark(mesh: Mesh, face: Face|null) {
    if (!face && !mesh.visible) return;
    mesh.visible = face !== null;
    if (face) {
      const corners = mesh.geometry.getAttribute('position');
      corners.array.set(face.corners.flat());
      corners.needsUpdate = true;
    }
    this.stage.invalidate();
  }

  #reset() {
    this.#first = null;
    this.#mark(this.#hovered, null);
    this.#mark(this.#chosen, null);
  }
}
