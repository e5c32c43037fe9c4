/**
 * What a drag with the mouse makes of a pose or a size. Rays are {origin, direction}, world axes,
 * unit direction.
 */
import {
  add, axisAngle, cross, dot, multiply, normalized, orientation, position, scale, subtract,
} from './pose.js';
import {magnetic, SMALLEST_SIZE, snapSize, snapTurn} from './drag_snap.js';
/** @import {Model} from './protocol.js' */
/** @import {Pose7, Vec3} from './pose.js' */

/** @typedef {{origin: Vec3, direction: Vec3}} Ray */

export const WORLD_AXES = Object.freeze({x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1]});
const PARALLEL = 1e-4;
/** Cosine of ray and axis below which a ring is taken as seen edge-on. */
const EDGE_ON = 0.05;

/**
 * Where a ray meets a plane, or null when it runs along it or away from it.
 * @param {Ray} ray
 * @param {Vec3} point
 * @param {Vec3} normal
 */
export function rayPlane(ray, point, normal) {
  const slope = dot(ray.direction, normal);
  if (Math.abs(slope) < PARALLEL) return null;
  const distance = dot(subtract(point, ray.origin), normal) / slope;
  return distance < 0 ? null : add(ray.origin, scale(ray.direction, distance));
}

/**
 * How far along an axis (m from `point`) the ray passes nearest to it; null when parallel.
 * @param {Ray} ray
 * @param {Vec3} point
 * @param {Vec3} axis
 */
export function alongAxis(ray, point, axis) {
  const cosine = dot(axis, ray.direction);
  const divisor = 1 - cosine * cosine;
  if (divisor < PARALLEL) return null;
  const between = subtract(point, ray.origin);
  return (cosine * dot(between, ray.direction) - dot(between, axis)) / divisor;
}

/** @param {Vec3} axis */
const isWorldAxis = (axis) => axis.some((part) => Math.abs(Math.abs(part) - 1) < 1e-9);

/**
 * A dragged position.
 * @param {number[]} start  pose7 when the drag began
 * @param {number[]} grab   the point that was grasped, world
 * @param {Ray} ray         under the mouse now
 * @param {{axis?: number[]|null, snap?: boolean}} [how]  without an axis: in the horizontal plane
 *        at the grasped height. Snapping is to whole metres of the position, or, along an axis that
 *        is none of the world's, of the distance.
 * @returns {number[]|null} pose7; null where the ray says nothing
 */
export function translated(start, grab, ray, {axis = null, snap = false} = {}) {
  /** @type {Vec3} */
  let shift;
  let touched = [true, true, false];
  if (axis) {
    const distance = alongAxis(ray, grab, axis);
    if (distance === null) return null;
    const oblique = !isWorldAxis(axis);
    shift = scale(axis, snap && oblique ? magnetic(distance) : distance);
    touched = oblique ? [false, false, false] : axis.map((part) => Math.abs(part) > 0.5);
  } else {
    const hit = rayPlane(ray, grab, WORLD_AXES.z);
    if (!hit) return null;
    shift = subtract(hit, grab);
    shift[2] = 0;
  }
  const moved = add(position(start), shift);
  const place = moved.map((part, index) => (snap && touched[index] ? magnetic(part) : part));
  return [...place, ...orientation(start)];
}

/**
 * A dragged turn about an axis through the pose's own position.
 * @param {Pose7} start
 * @param {Ray} from  when the drag began
 * @param {Ray} ray   now
 * @param {number[]} axis  unit, world
 * @returns {number[]|null} pose7
 */
export function rotated(start, from, ray, axis, {snap = false} = {}) {
  const angle = turnBetween(position(start), axis, from, ray);
  if (angle === null) return null;
  const turn = axisAngle(axis, snap ? snapTurn(angle) : angle);
  return [...position(start), ...multiply(turn, orientation(start))];
}

/**
 * @param {Vec3} centre
 * @param {Vec3} axis
 * @param {Ray} from
 * @param {Ray} ray
 */
function turnBetween(centre, axis, from, ray) {
  const a = spoke(centre, axis, from);
  const b = spoke(centre, axis, ray);
  if (!a || !b) return null;
  return Math.atan2(dot(cross(a, b), axis), dot(a, b));
}

/**
 * From the centre to where the ray meets the plane of the turn. Seen edge-on that point runs off to
 * infinity: then to a point of the near side of the ring.
 * @param {Vec3} centre
 * @param {Vec3} axis
 * @param {Ray} ray
 */
function spoke(centre, axis, ray) {
  if (Math.abs(dot(ray.direction, axis)) < EDGE_ON) {
    const offset = subtract(ray.origin, centre);
    const across = normalized(cross(ray.direction, axis));
    return add(scale(across, dot(offset, across)),
      scale(ray.direction, -0.15 * Math.hypot(...offset)));
  }
  const hit = rayPlane(ray, centre, axis);
  return hit && subtract(hit, centre);
}

/** The kinds of models by what their sizes allow. @typedef {'free'|'round'|'ball'} Roundness */

/** @type {Record<string, Roundness>} */
const ROUNDNESS = {sphere: 'ball', cylinder: 'round', capsule: 'round', cone: 'round'};

/** @param {Model} model @returns {Roundness} what a model's geometries allow together */
export function roundness(model) {
  const kinds = model.links.flatMap((link) => [...link.visuals, ...link.collisions])
    .map(({geometry}) => ROUNDNESS[geometry.type] ?? 'free');
  if (kinds.includes('ball')) return 'ball';
  return kinds.includes('round') ? 'round' : 'free';
}

/**
 * Factors for a drag by `distance` m outwards along one of the model's axes: the face follows the
 * mouse, its opposite goes the other way. Spheres and cylinders stay round (Gazebo behaviour).
 * @param {number[]} size   present extent in the model's frame, m
 * @param {0|1|2} axis
 * @param {number} distance m
 * @param {{snap?: boolean, uniform?: boolean, kind?: Roundness}} [how]
 * @returns {number[]} factors on x, y, z
 */
export function scaled(size, axis, distance, {snap = false, uniform = false, kind = 'free'} = {}) {
  const now = Math.max(size[axis], SMALLEST_SIZE);
  const wanted = Math.max(now + 2 * distance, SMALLEST_SIZE);
  const factor = (snap ? snapSize(wanted) : wanted) / now;
  if (uniform || kind === 'ball') return [factor, factor, factor];
  if (kind === 'round' && axis < 2) return [factor, factor, 1];
  return [0, 1, 2].map((index) => (index === axis ? factor : 1));
}
