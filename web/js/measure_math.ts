/** Distances and angles between points in the world. */
import {dot, length, subtract} from './pose.js';
import type {Vec3} from './pose.js';

/** A length in words. */
export function lengthText(metres: number) {
  return metres < 1 ? `${(metres * 100).toFixed(1)} cm` : `${metres.toFixed(3)} m`;
}

/**
 * What two or three points say: the distance with its parts, or the angle at the second one.
 * @returns a text for each line between them; the last may be of the angle
 */
export function measures(points: Vec3[]): string[] {
  const texts = points.slice(1).map((point, at) => {
    const way = subtract(point, points[at]);
    const parts = ['x', 'y', 'z'].map((axis, index) => `${axis} ${way[index].toFixed(3)}`);
    return `${lengthText(length(way))}  (${parts.join(', ')})`;
  });
  if (points.length === 3) texts.push(`${angle(points).toFixed(1)}°`);
  return texts;
}

/** Degrees at the second of three points. */
export function angle([a, b, c]: Vec3[]) {
  const [one, other] = [subtract(a, b), subtract(c, b)];
  const size = length(one) * length(other);
  if (size === 0) return 0;
  return Math.acos(Math.min(1, Math.max(-1, dot(one, other) / size))) * 180 / Math.PI;
}
