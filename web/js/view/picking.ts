/** What is under the mouse: bodies by their bounding spheres first, then by their triangles. */
import {Mesh, Raycaster, Sphere, Vector2, Vector3} from 'three';
import type {BufferGeometry, Intersection, Material, Object3D} from 'three';
import type {Face} from '../face_math.js';
import type {Item} from './batches.js';
import type {Owner} from './model_views.js';
import type {Ray} from '../drag_math.js';
import type {Stage} from './stage.js';

interface Hit {
  /** the item's */
  owner: Owner;
  /** world */
  point: number[];
  distance: number;
  /** world */
  face: Face;
}

export class Picker {
  #caster = new Raycaster();
  #probe: Mesh<BufferGeometry, Material|Material[]> = new Mesh();
  #sphere = new Sphere();
  #at = new Vector3();
  #stage;

  constructor(stage: Stage) {
    this.#stage = stage;
    this.#probe.matrixAutoUpdate = false;
  }

  /** The ray under a point of the page. */
  ray(clientX: number, clientY: number): Ray {
    this.#aim(clientX, clientY);
    const {origin, direction} = this.#caster.ray;
    return {origin: origin.toArray(), direction: direction.toArray()};
  }

  /** The nearest of some items. */
  nearest(items: Iterable<Item>, clientX: number, clientY: number, accept: (owner: Owner) =>
      boolean = () => true): Hit|null {
    this.#aim(clientX, clientY);
    return this.#nearest(items, accept);
  }

  /** The nearest of some items along a ray, world, m. */
  along(items: Iterable<Item>, {origin, direction}: Ray, accept: (owner: Owner) => boolean): Hit|null {
    this.#caster.ray.origin.fromArray(origin);
    this.#caster.ray.direction.fromArray(direction);
    return this.#nearest(items, accept);
  }

  #nearest(items: Iterable<Item>, accept: (owner: Owner) => boolean) {
    let best: Hit|null = null;
    for (const {item, distance} of this.#candidates(items, accept)) {
      if (best && distance > best.distance) break;
      best = this.#hit(item, best) ?? best;
    }
    return best;
  }

  /** All of some items, also those that others cover, nearest first. */
  all(items: Iterable<Item>, clientX: number, clientY: number, accept: (owner: Owner) => boolean) {
    this.#aim(clientX, clientY);
    return this.#candidates(items, accept)
      .flatMap(({item}) => this.#hit(item, null) ?? [])
      .sort((a, b) => a.distance - b.distance);
  }

  /** Items whose bounding spheres the ray enters, nearest first. */
  #candidates(items: Iterable<Item>, accept: (owner: Owner) => boolean) {
    const candidates: {item: Item, distance: number}[] = [];
    for (const item of items) {
      if (!accept(item.owner)) continue;
      const distance = this.#entry(item);
      if (distance !== null) candidates.push({item, distance});
    }
    return candidates.sort((a, b) => a.distance - b.distance);
  }

  /**
   * Whether something lies between two points.
   * @param from  world, m
   * @param to  world, m
   */
  isBetween(items: Iterable<Item>, from: number[], to: number[], accept: (item: Item) => boolean) {
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

  /** Hits of three objects, e.g. handles, nearest first. */
  objects(list: Object3D[], clientX: number, clientY: number) {
    this.#aim(clientX, clientY);
    // Objects that are new since the last picture are drawn, and so placed, with the next one.
    for (const object of list) object.updateMatrixWorld();
    return this.#caster.intersectObjects(list, true);
  }

  #aim(clientX: number, clientY: number) {
    const box = this.#stage.canvas.getBoundingClientRect();
    const point = new Vector2(((clientX - box.left) / box.width) * 2 - 1,
      1 - ((clientY - box.top) / box.height) * 2);
    this.#stage.camera.updateMatrixWorld();
    this.#caster.setFromCamera(point, this.#stage.camera);
    this.#caster.params.Line.threshold = 0.05;
  }

  /** Where the ray may enter the item, or null when it passes it. */
  #entry({geometry, matrix}: Item) {
    if (!geometry.boundingSphere) geometry.computeBoundingSphere();
    if (!geometry.boundingSphere) return null;
    this.#sphere.copy(geometry.boundingSphere).applyMatrix4(matrix);
    const {ray} = this.#caster;
    if (this.#sphere.containsPoint(ray.origin)) return 0;
    const at = ray.intersectSphere(this.#sphere, this.#at);
    return at ? at.distanceTo(ray.origin) : null;
  }

  #hit(item: Item, best: Hit|null) {
    const probe = this.#probe;
    probe.geometry = item.geometry;
    probe.material = item.material;
    probe.matrixWorld.copy(item.matrix);
    const hits: Intersection[] = [];
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
