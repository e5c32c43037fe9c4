/** Where a thing lands under the mouse: on the first surface that is seen there, or in front of a wall. */
import {rayPlane, WORLD_AXES} from '../drag_math.js';
import {normal} from '../face_math.js';
import {dot, normalized, scale} from '../pose.js';
import {ViewPart} from './view_part.js';
import type {Vec3} from '../pose.js';
import type {MousePoint} from './pointer.js';

/** A surface less steep than 45 degrees carries things, as does every one that is level. */
const LEVEL = Math.SQRT1_2;
/** Between a thing and the wall behind it, m. */
const CLEAR = 0.01;

/** A place, and whether it is on level ground instead of in front of a wall. */
type Place = {point: Vec3, level: boolean};

/**
 * How far a box must stay away from a wall.
 * @param box  about the origin of the thing, along the world's axes, m
 * @param away  unit vector from the wall, horizontal
 */
function standOff(box: {min: Vec3, max: Vec3}, away: Vec3): number {
  const nearest = away.reduce((sum, part, axis) => sum + part * (part > 0 ? box.min : box.max)[axis], 0);
  return Math.max(0, -nearest) + CLEAR;
}

export class Landing extends ViewPart {

  /**
   * The place for a thing under the mouse; null where there is nothing but sky. Parts of the model that is being
   * built may be inside each other: they go to the ground.
   * @param box  of the thing, about its origin, along the world's axes, m
   * @param accept  whether a model counts as a surface
   */
  under({clientX, clientY}: MousePoint, box: {min: Vec3, max: Vec3}, accept: (model: string) => boolean = () => true):
      Place|null {
    const ray = this.picker.ray(clientX, clientY);
    const hit = this.store.modelEditing ? null
      : this.picker.nearest(this.batches.items(), clientX, clientY, ({model}) => model !== undefined && accept(model));
    if (!hit) {
      const point = rayPlane(ray, [0, 0, 0], WORLD_AXES.z);
      return point && {point, level: true};
    }
    const outward = normal(hit.face);
    const facing = dot(outward, ray.direction) > 0 ? scale(outward, -1) : outward;
    if (hit.owner.plane || facing[2] > LEVEL) return {point: hit.point, level: true};
    const away = normalized([facing[0], facing[1], 0]);
    const shift = Math.hypot(...away) > 0 ? standOff(box, away) : 0;
    const [x, y] = hit.point.map((part, axis) => part + shift * away[axis]);
    return {point: [x, y, this.#below([x, y, hit.point[2] - (shift ? 0 : CLEAR)])], level: false};
  }

  /** The height of the surface below a point; 0 without one. */
  #below(point: Vec3) {
    const down = {origin: point, direction: [0, 0, -1]};
    return this.picker.along(this.batches.items(), down, (owner) => owner.model !== undefined)?.point[2] ?? 0;
  }
}
