/**
 * Different small meshes of one material as one mesh, for software renderers: each draw costs them
 * about as much as thousands of corners.
 */
import {BufferAttribute, BufferGeometry, DynamicDrawUsage, Mesh} from 'three';
import {movingForm, placeCorners} from './merged_mesh.js';
import type {Material, Matrix4} from 'three';

/** Meshes of more corners are drawn alone, and left out when they are not in sight. */
const MOST_CORNERS = 5000;
/** Room for more corners than there are, so that not each new mesh needs new buffers. */
const SPARE = 1.5;

/** A mesh and where it is. */
type Placed = {geometry: BufferGeometry, matrix: Matrix4};

/** Whether a geometry has only corners and normals, not too many, and one opaque material. */
export function mixable({attributes, morphAttributes, groups, drawRange}: BufferGeometry,
    material: Material|Material[]) {
  const {position, normal} = attributes;
  return !Array.isArray(material) && !material.transparent && !material.vertexColors && groups.length === 0 &&
    Object.keys(attributes).length === 2 && Object.keys(morphAttributes).length === 0 &&
    position instanceof BufferAttribute && normal instanceof BufferAttribute && !normal.normalized &&
    position.count <= MOST_CORNERS && drawRange.start === 0 && drawRange.count === Infinity;
}

const indicesOf = ({index, attributes}: BufferGeometry) => index?.count ?? attributes.position.count;

/** The buffers of some meshes in one. */
class Buffers {
  geometry = new BufferGeometry();
  /** Whether they have to be written again. */
  stale = true;
  #form;
  /** Place of the first corner of each mesh. */
  #starts: number[] = [];

  /** @param form  what is drawn of a mesh */
  constructor(form: (geometry: BufferGeometry) => BufferGeometry) {
    this.#form = form;
  }

  /** Puts a mesh where its matrix says. */
  move(slot: number, {geometry, matrix}: Placed) {
    const {position, normal} = this.geometry.attributes as Record<string, BufferAttribute>;
    const start = 3 * this.#starts[slot];
    const form = this.#form(geometry);
    placeCorners(form, matrix, position.array, normal.array, start);
    for (const attribute of [position, normal]) {
      attribute.addUpdateRange(start, 3 * form.attributes.position.count);
      attribute.needsUpdate = true;
    }
  }

  write(meshes: Placed[]) {
    if (!this.stale) return;
    this.stale = false;
    const placed = meshes.map(({geometry, matrix}) => ({geometry: this.#form(geometry), matrix}));
    const corners = placed.reduce((sum, {geometry}) => sum + geometry.attributes.position.count, 0);
    const indices = placed.reduce((sum, {geometry}) => sum + indicesOf(geometry), 0);
    this.#makeRoom(corners, indices);
    const {attributes: {position, normal}, index} = this.geometry as BufferGeometry & {index: BufferAttribute};
    this.#starts = [];
    let [corner, at] = [0, 0];
    for (const {geometry, matrix} of placed) {
      this.#starts.push(corner);
      placeCorners(geometry, matrix, position.array, normal.array, 3 * corner);
      const count = indicesOf(geometry);
      for (let n = 0; n < count; n++) index.array[at + n] = corner + (geometry.index ? geometry.index.array[n] : n);
      corner += geometry.attributes.position.count;
      at += count;
    }
    for (const attribute of [position, normal, index] as BufferAttribute[]) {
      attribute.clearUpdateRanges();
      attribute.needsUpdate = true;
    }
    this.geometry.setDrawRange(0, indices);
  }

  #makeRoom(corners: number, indices: number) {
    const {attributes: {position}, index} = this.geometry;
    if (position && index && position.count >= corners && index.count >= indices) return;
    this.geometry.dispose();
    this.geometry = new BufferGeometry();
    for (const name of ['position', 'normal']) {
      const numbers = new Float32Array(3 * Math.ceil(SPARE * corners));
      this.geometry.setAttribute(name, new BufferAttribute(numbers, 3).setUsage(DynamicDrawUsage));
    }
    this.geometry.setIndex(new BufferAttribute(new Uint32Array(Math.ceil(SPARE * indices)), 1));
  }
}

export class MixedMesh extends Mesh<BufferGeometry, Material> {
  override matrixAutoUpdate;
  #full = new Buffers((geometry) => geometry);
  #moving = new Buffers(movingForm);
  #shown = this.#full;
  #meshes: Placed[] = [];

  constructor(material: Material) {
    super(new BufferGeometry(), material);
    this.matrixAutoUpdate = false;
    this.frustumCulled = false;
  }

  /** Draws these meshes from the next picture on; the list is kept. */
  show(meshes: Placed[]) {
    this.#meshes = meshes;
    this.#full.stale = this.#moving.stale = true;
  }

  /** Puts a mesh where its matrix says. */
  move(slot: number) {
    const [shown, other] = this.#shown === this.#full ? [this.#full, this.#moving] : [this.#moving, this.#full];
    other.stale = true;
    if (!shown.stale) shown.move(slot, this.#meshes[slot]);
  }

  /** Writes the buffers, before a picture. @param moving  draw the plainer forms */
  prepare(moving: boolean) {
    this.#shown = moving ? this.#moving : this.#full;
    this.#shown.write(this.#meshes);
    this.geometry = this.#shown.geometry;
  }

  override dispose() {
    this.#full.geometry.dispose();
    this.#moving.geometry.dispose();
  }
}
