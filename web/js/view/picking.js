/** What is under the mouse: bodies by their bounding spheres first, then by their triangles. */
import {Mesh, Raycaster, Sphere, Vector2, Vector3} from 'three';
/** @import {BufferGeometry, Intersection, Material, Object3D} from 'three' */
/** @import {Face} from '../face_math.js' */
/** @import {Item} from './batches.js' */
/** @import {Owner} from './model_views.js' */
/** @import {Ray} from '../drag_math.js' */
/** @import {Stage} from './stage.js' */

/**
 * @typedef {object} Hit
 * @property {Owner} owner     the item's
 * @property {number[]} point world
 * @property {number} distance
 * @property {Face} face  world
 */

export class Picker {
  #caster = new Raycaster();
  /** @type {Mesh<BufferGeometry, Material|Material[]>} */
  #probe = new Mesh();
  #sphere = new Sphere();
  #at = new Vector3();
  #stage;

  /** @param {Stage} stage */
  constructor(stage) {
    this.#stage = stage;
    this.#probe.matrixAutoUpdate = false;
  }

  /**
   * The ray under a point of the page.
   * @param {number} clientX
   * @param {number} clientY
   * @returns {Ray}
   */
  ray(clientX, clientY) {
    this.#aim(clientX, clientY);
    const {origin, direction} = this.#caster.ray;
    return {origin: origin.toArray(), direction: direction.toArray()};
  }

  /**
   * The nearest of some items.
   * @param {Iterable<Item>} items
   * @param {number} clientX
   * @param {number} clientY
   * @param {(owner: Owner) => boolean} [accept]
   * @returns {Hit|null}
   */
  nearest(items, clientX, clientY, accept = () => true) {
    /** @type {Hit|null} */
    let best = null;
    for (const {item, distance} of this.#candidates(items, clientX, clientY, accept)) {
      if (best && distance > best.distance) break;
      best = this.#hit(item, best) ?? best;
    }
    return best;
  }

  /**
   * All of some items, also those that others cover, nearest first.
   * @param {Iterable<Item>} items
   * @param {number} clientX
   * @param {number} clientY
   * @param {(owner: Owner) => boolean} accept
   */
  all(items, clientX, clientY, accept) {
    return this.#candidates(items, clientX, clientY, accept)
      .flatMap(({item}) => this.#hit(item, null) ?? [])
      .sort((a, b) => a.distance - b.distance);
  }

  /**
   * Items whose bounding spheres the ray enters, nearest first.
   * @param {Iterable<Item>} items
   * @param {number} clientX
   * @param {number} clientY
   * @param {(owner: Owner) => boolean} accept
   */
  #candidates(items, clientX, clientY, accept) {
    this.#aim(clientX, clientY);
    /** @type {{item: Item, distance: number}[]} */
    const candidates = [];
    for (const item of items) {
      if (!accept(item.owner)) continue;
      const distance = this.#entry(item);
      if (distance !== null) candidates.push({item, distance});
    }
    return candidates.sort((a, b) => a.distance - b.distance);
  }

  /**
   * Whether something lies between two points.
   * @param {Iterable<Item>} items
   * @param {number[]} from  world, m
   * @param {number[]} to    world, m
   * @param {(item: Item) => boolean} accept
   */
  isBetween(items, from, to, accept) {
    const {ray} = this.#caster;
    const end = new Vector3().fromArray(to);
    ray.origin.fromArray(from);
    ray.direction.copy(end).sub(ray.origin).normalize();
    const length = end.distanceTo(ray.origin);
    for (const item of items) {
      const entry = accept(item) ? this.#entry(item) : null;
      if (entry === null || entry > length) continue;
      const hit = this.#hit(item, null);
      if (hit && hit.distance < length) return true;
    }
    return false;
  }

  /**
   * Hits of three objects, e.g. handles, nearest first.
   * @param {Object3D[]} list
   * @param {number} clientX
   * @param {number} clientY
   */
  objects(list, clientX, clientY) {
    this.#aim(clientX, clientY);
    return this.#caster.intersectObjects(list, true);
  }

  /** @param {number} clientX @param {number} clientY */
  #aim(clientX, clientY) {
    const box = this.#stage.canvas.getBoundingClientRect();
    const point = new Vector2(((clientX - box.left) / box.width) * 2 - 1,
      1 - ((clientY - box.top) / box.height) * 2);
    this.#stage.camera.updateMatrixWorld();
    this.#caster.setFromCamera(point, this.#stage.camera);
    this.#caster.params.Line.threshold = 0.05;
  }

  /** Where the ray may enter the item, or null when it passes it. @param {Item} item */
  #entry({geometry, matrix}) {
    if (!geometry.boundingSphere) geometry.computeBoundingSphere();
    if (!geometry.boundingSphere) return null;
    this.#sphere.copy(geometry.boundingSphere).applyMatrix4(matrix);
    const {ray} = this.#caster;
    if (this.#sphere.containsPoint(ray.origin)) return 0;
    const at = ray.intersectSphere(this.#sphere, this.#at);
    return at ? at.distanceTo(ray.origin) : null;
  }

  /** @param {Item} item @param {Hit|null} best */
  #hit(item, best) {
    const probe = this.#probe;
    probe.geometry = item.geometry;
    probe.material = item.material;
    probe.matrixWorld.copy(item.matrix);
    /** @type {Intersection[]} */
    const hits = [];
    probe.raycast(this.#caster, hits);
    hits.sort((a, b) => a.distance - b.distance);
    const [first] = hits;
    if (!first?.face || (best && first.distance >= best.distance)) return null;
    const positions = item.geometry.getAttribute('position');
    const corners = [first.face.a, first.face.b, first.face.c].map((index) =>
      new Vector3().fromBufferAttribute(positions, index).applyMatrix4(item.matrix).toArray());
    return {owner: item.owner, point: first.point.toArray(), distance: first.distance,
      face: {corners}};
  }
}
