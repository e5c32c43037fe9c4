/** Putting a face of one model against a face of another (Gazebo's snap tool). */
import {
  add, compose, cross, normalized, orientation, position, rotationBetween, scale, subtract,
} from './pose.js';
import type {Vec3} from './pose.js';

/** Three corners, world. */
export type Face = {corners: Vec3[]};

export const centroid = ({corners: [a, b, c]}: Face) => scale(add(add(a, b), c), 1 / 3);
export const normal = ({corners: [a, b, c]}: Face) =>
  normalized(cross(subtract(b, a), subtract(c, a)));

/**
 * Where a model goes when its face lies on another: centroids meet, normals oppose.
 * @param pose  pose7 of the model of the first face
 * @returns pose7
 */
export function snapped(pose: number[], from: Face, onto: Face): number[] {
  const turn = rotationBetween(normal(from), scale(normal(onto), -1));
  const lever = subtract(position(pose), centroid(from));
  const turned = compose([0, 0, 0, ...turn], [...lever, ...orientation(pose)]);
  return [...add(centroid(onto), position(turned)), ...orientation(turned)];
}
