/** What is under the mouse: bodies by their bounding spheres first, then by their triangles. */
import {Mesh, Raycaster, Sphere, Vector2, Vector3} from 'three';

/**
 * @typedef {object} Hit
 * @property {any} owner      the item's
 * @property {number[]} point world
 * @property {number} distance
 * @property {{corners: number[][]}} face  world
 */

export class Picker {
  #caster = new Raycaster();
  #probe = new Mesh();
  #sphere = new Sphere();
  #at = new Vector3();
  #stage;

  /** @param {import('./stage.js').Stage} stage */
  constructor(stage) {
    this.#stage = stage;
    this.#probe.matrixAutoUpdate = false;
  }

  /** The ray under a point of the page. @returns {import('../drag_math.js').Ray} */
  ray(clientX, clientY) {
    this.#aim(clientX, clientY);
    const {origin, direction} = this.#caster.ray;
    return {origin: origin.toArray(), direction: direction.toArray()};
  }

  /**
   * The nearest of some items.
   * @param {Iterable<import('./batches.js').Item>} items
   * @param {(owner: any) => boolean} [accept]
   * @returns {Hit|null}
   */
  nearest(items, clientX, clientY, accept = () => true) {
    this.#aim(clientX, clientY);
    const candidates = [];
    for (const item of items) {
      if (!accept(item.owner)) continue;
      const distance = this.#entry(item);
      if (distance !== null) candidates.push({item, distance});
    }
    candidates.sort((a, b) => a.distance - b.distance);
    let best = null;
    for (const {item, distance} of candidates) {
      if (best && distance > best.distance) break;
      best = this.#hit(item, best) ?? best;
    }
    return best;
  }

  /** Hits of three objects, e.g. handles, nearest first. */
  objects(list, clientX, clientY) {
    this.#aim(clientX, clientY);
    return this.#caster.intersectObjects(list, true);
  }

  #aim(clientX, clientY) {
    const box = this.#stage.canvas.getBoundingClientRect();
    const point = new Vector2(((clientX - box.left) / box.width) * 2 - 1,
      1 - ((clientY - box.top) / box.height) * 2);
    this.#stage.camera.updateMatrixWorld();
    this.#caster.setFromCamera(point, this.#stage.camera);
    this.#caster.params.Line.threshold = 0.05;
  }

  /** Where the ray may enter the item, or null when it passes it. */
  #entry({geometry, matrix}) {
    if (!geometry.boundingSphere) geometry.computeBoundingSphere();
    this.#sphere.copy(geometry.boundingSphere).applyMatrix4(matrix);
    const {ray} = this.#caster;
    if (this.#sphere.containsPoint(ray.origin)) return 0;
    const at = ray.intersectSphere(this.#sphere, this.#at);
    return at ? at.distanceTo(ray.origin) : null;
  }

  #hit(item, best) {
    const probe = this.#probe;
    probe.geometry = item.geometry;
    probe.material = item.material;
    probe.matrixWorld.copy(item.matrix);
    const hits = [];
    probe.raycast(this.#caster, hits);
    hits.sort((a, b) => a.distance - b.distance);
    const [first] = hits;
    if (!first || (best && first.distance >= best.distance)) return null;
    const positions = item.geometry.getAttribute('position');
    const corners = [first.face.a, first.face.b, first.face.c].map((index) =>
      new Vector3().fromBufferAttribute(positions, index).applyMatrix4(item.matrix).toArray());
    return {owner: item.owner, point: first.point.toArray(), distance: first.distance,
      face: {corners}};
  }
}
