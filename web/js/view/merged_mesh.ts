/**
 * Many copies of a small geometry as one mesh, moved by the page's own processor. A software
 * renderer pays for each instance as for a draw of its own, about 30 µs (SwiftShader loops over
 * them); corners that come in one piece cost it a tenth of that.
 */
import {BufferAttribute, BufferGeometry, DynamicDrawUsage, Mesh} from 'three';
import type {Material, Matrix4, TypedArray} from 'three';

/** Geometries of more corners are cheaper as instances. */
const MOST_CORNERS = 256;
/** Attributes that follow the copy; the others are the same in each. */
const PLACED = ['position', 'normal'];

/** What is drawn of a geometry while things move. */
export const movingForm = (geometry: BufferGeometry): BufferGeometry => geometry.userData.moving ?? geometry;

/** Whether copies of a geometry can be merged. */
export function mergeable(geometry: BufferGeometry, material: Material|Material[]) {
  const {attributes, morphAttributes} = geometry;
  return !Array.isArray(material) && attributes.position.count <= MOST_CORNERS &&
    Object.keys(morphAttributes).length === 0 && PLACED.every((name) => attributes[name]) &&
    Object.values(attributes).every((one) => one instanceof BufferAttribute && !one.normalized);
}

export class MergedMesh extends Mesh {
  override matrixAutoUpdate;
  #source;
  #corners;
  #indices;
  #place;
  #direction;

  /** @param capacity  copies that find room */
  constructor(source: BufferGeometry, material: Material, capacity: number) {
    const geometry = copies(source, capacity);
    super(geometry, material);
    this.#source = source;
    this.#corners = source.attributes.position.count;
    this.#indices = source.index?.count ?? this.#corners;
    this.#place = geometry.attributes.position;
    this.#direction = geometry.attributes.normal;
    this.matrixAutoUpdate = false;
  }

  /** Draws so many copies. */
  show(count: number) {
    this.geometry.setDrawRange(0, count * this.#indices);
  }

  /** Puts a copy where its matrix says. */
  setMatrixAt(slot: number, matrix: Matrix4) {
    placeCorners(this.#source, matrix, this.#place.array, this.#direction.array, 3 * slot * this.#corners);
    this.#place.needsUpdate = this.#direction.needsUpdate = true;
  }

  override dispose() {
    this.geometry.dispose();
  }
}

/**
 * Write the moved corners and normals of a geometry.
 * @param places  receives the corners, three numbers each
 * @param directions  receives the normals
 * @param to  place of the first number
 */
export function placeCorners(source: BufferGeometry, matrix: Matrix4, places: TypedArray,
    directions: TypedArray, to: number) {
  const m = matrix.elements;
  // The inverse of a turned and scaled matrix, transposed, is the matrix with its columns divided so.
  const a = 1 / (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
  const b = 1 / (m[4] * m[4] + m[5] * m[5] + m[6] * m[6]);
  const c = 1 / (m[8] * m[8] + m[9] * m[9] + m[10] * m[10]);
  const points = source.attributes.position.array;
  const normals = source.attributes.normal.array;
  for (let at = 0; at < points.length; at += 3, to += 3) {
    const [x, y, z] = [points[at], points[at + 1], points[at + 2]];
    places[to] = m[0] * x + m[4] * y + m[8] * z + m[12];
    places[to + 1] = m[1] * x + m[5] * y + m[9] * z + m[13];
    places[to + 2] = m[2] * x + m[6] * y + m[10] * z + m[14];
    const [u, v, w] = [a * normals[at], b * normals[at + 1], c * normals[at + 2]];
    directions[to] = m[0] * u + m[4] * v + m[8] * w;
    directions[to + 1] = m[1] * u + m[5] * v + m[9] * w;
    directions[to + 2] = m[2] * u + m[6] * v + m[10] * w;
  }
}

/** One geometry that holds another one several times. */
function copies(source: BufferGeometry, count: number) {
  const geometry = new BufferGeometry();
  const corners = source.attributes.position.count;
  for (const [name, {array, itemSize}] of Object.entries(source.attributes)) {
    const all = new Float32Array(count * corners * itemSize);
    for (let n = 0; n < count; n++) all.set(array, n * corners * itemSize);
    const attribute = new BufferAttribute(all, itemSize);
    if (PLACED.includes(name)) attribute.setUsage(DynamicDrawUsage);
    geometry.setAttribute(name, attribute);
  }
  if (source.index) {
    const {array} = source.index;
    const all = new Uint32Array(count * array.length);
    for (let n = 0; n < count; n++) {
      for (let at = 0; at < array.length; at++) all[n * array.length + at] = array[at] + n * corners;
    }
    geometry.setIndex(new BufferAttribute(all, 1));
  }
  return geometry;
}
