/**
 * What a drag with the mouse makes of a pose or a size. Rays are {origin, direction}, world axes,
 * unit direction.
 */
import {
  add, axisAngle, cross, dot, multiply, normalized, orientation, position, scale, subtract,
} from './pose.js';
import {magnetic, SMALLEST_SIZE, snapSize, snapTurn} from './drag_snap.js';
import type {Model} from './protocol.js';
import type {Pose7, Vec3} from './pose.js';

export type Ray = {origin: Vec3, direction: Vec3};

export const WORLD_AXES = Object.freeze({x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1]});
const PARALLEL = 1e-4;
/** Cosine of ray and axis below which a ring is taken as seen edge-on. */
const EDGE_ON = 0.05;

/** Where a ray meets a plane, or null when it runs along it or away from it. */
export function rayPlane(ray: Ray, point: Vec3, normal: Vec3) {
  const slope = dot(ray.direction, normal);
  if (Math.abs(slope) < PARALLEL) return null;
  const distance = dot(subtract(point, ray.origin), normal) / slope;
  return distance < 0 ? null : add(ray.origin, scale(ray.direction, distance));
}

/** How far along an axis (m from `point`) the ray passes nearest to it; null when parallel. */
export function alongAxis(ray: Ray, point: Vec3, axis: Vec3) {
  const cosine = dot(axis, ray.direction);
  const divisor = 1 - cosine * cosine;
  if (divisor < PARALLEL) return null;
  const between = subtract(point, ray.origin);
  return (cosine * dot(between, ray.direction) - dot(between, axis)) / divisor;
}

const isWorldAxis = (axis: Vec3) => axis.some((part) => Math.abs(Math.abs(part) - 1) < 1e-9);

/**
 * A dragged position.
 * @param start  pose7 when the drag began
 * @param grab  the point that was grasped, world
 * @param ray  under the mouse now
 * @param how  without an axis: in the horizontal plane
 * at the grasped height. Snapping is to whole metres of the position, or, along an axis that
 * is none of the world's, of the distance.
 * @returns pose7; null where the ray says nothing
 */
export function translated(start: number[], grab: number[], ray: Ray, {axis = null,
    snap = false}: {axis?: number[]|null, snap?: boolean} = {}): number[]|null {
  let shift: Vec3;
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
 * @param from  when the drag began
 * @param ray  now
 * @param axis  unit, world
 * @returns pose7
 */
export function rotated(start: Pose7, from: Ray, ray: Ray, axis: number[], {snap = false} = {}):
    number[]|null {
  const angle = turnBetween(position(start), axis, from, ray);
  if (angle === null) return null;
  const turn = axisAngle(axis, snap ? snapTurn(angle) : angle);
  return [...position(start), ...multiply(turn, orientation(start))];
}

function turnBetween(centre: Vec3, axis: Vec3, from: Ray, ray: Ray) {
  const a = spoke(centre, axis, from);
  const b = spoke(centre, axis, ray);
  if (!a || !b) return null;
  return Math.atan2(dot(cross(a, b), axis), dot(a, b));
}

/**
 * From the centre to where the ray meets the plane of the turn. Seen edge-on that point runs off to
 * infinity: then to a point of the near side of the ring.
 */
function spoke(centre: Vec3, axis: Vec3, ray: Ray) {
  if (Math.abs(dot(ray.direction, axis)) < EDGE_ON) {
    const offset = subtract(ray.origin, centre);
    const across = normalized(cross(ray.direction, axis));
    return add(scale(across, dot(offset, across)),
      scale(ray.direction, -0.15 * Math.hypot(...offset)));
  }
  const hit = rayPlane(ray, centre, axis);
  return hit && subtract(hit, centre);
}

/** The kinds of models by what their sizes allow. */
type Roundness = 'free'|'round'|'ball';

const ROUNDNESS: Record<string, Roundness> = {sphere: 'ball', cylinder: 'round', capsule: 'round',
    cone: 'round'};

/** @returns what a model's geometries allow together */
export function roundness(model: Model): Roundness {
  const kinds = model.links.flatMap((link) => [...link.visuals, ...link.collisions])
    .map(({geometry}) => ROUNDNESS[geometry.type] ?? 'free');
  if (kinds.includes('ball')) return 'ball';
  return kinds.includes('round') ? 'round' : 'free';
}

/**
 * Factors for a drag by `distance` m outwards along one of the model's axes: the face follows the
 * mouse, its opposite goes the other way. Spheres and cylinders stay round (Gazebo behaviour).
 * @param size  present extent in the model's frame, m
 * @param distance  m
 * @returns factors on x, y, z
 */
export function scaled(size: number[], axis: 0|1|2, distance: number, {snap = false, uniform = false,
    kind = 'free'}: {snap?: boolean, uniform?: boolean, kind?: Roundness} = {}): number[] {
  const now = Math.max(size[axis], SMALLEST_SIZE);
  const wanted = Math.max(now + 2 * distance, SMALLEST_SIZE);
  const factor = (snap ? snapSize(wanted) : wanted) / now;
  if (uniform || kind === 'ball') return [factor, factor, factor];
  if (kind === 'round' && axis < 2) return [factor, factor, 1];
  return [0, 1, 2].map((index) => (index === axis ? factor : 1));
}
