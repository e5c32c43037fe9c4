/** Copies in rows, and equal gaps between models: their places. */
import {add, orientation, position} from './pose.js';
import type {Pose7, Vec3} from './pose.js';

/** in world axes, m */
type Bounds = {min: number[], max: number[]};

/** The most copies of one array. */
export const MOST_COPIES = 1000;
/** Between the boxes of an original and its copy, m. */
const GAP = 0.1;
/** A copy is never farther away, m: a ground plane is large. */
const FARTHEST = 10;

const AXES = {x: 0, y: 1, z: 2};

/**
 * How far apart along each axis copies do not touch.
 * @param boxes  of what is copied
 * @returns m
 */
export function clearSpacing(boxes: Bounds[]): Vec3 {
  return [0, 1, 2].map((axis) => {
    if (!boxes.length) return 1;
    const width = Math.max(...boxes.map(({max}) => max[axis])) - Math.min(...boxes.map(({min}) => min[axis]));
    return Math.round(1000 * (Math.min(width, FARTHEST) + GAP)) / 1000;
  }) as Vec3;
}

/**
 * The number of copies of an array, without the original.
 * @param counts  cells along x, y and z
 */
export const copiesIn = (counts: number[]) => counts.reduce((product, count) => product * count, 1) - 1;

/**
 * Where the copies of an array are, relative to the original, which is the first of its cells.
 * @param counts  cells along x, y and z
 * @param spacing  between two cells along x, y and z, m
 * @returns m, without the original
 */
export function arrayOffsets(counts: number[], spacing: number[]): Vec3[] {
  const offsets: Vec3[] = [];
  for (let z = 0; z < counts[2]; z++) {
    for (let y = 0; y < counts[1]; y++) {
      for (let x = 0; x < counts[0]; x++) {
        if (x || y || z) offsets.push([x * spacing[0], y * spacing[1], z * spacing[2]]);
      }
    }
  }
  return offsets;
}

/**
 * Where models must go so that the gaps between their boxes are equal. The two outermost stay.
 * @param boxes  poses and boxes in world axes
 * @returns new pose7 by name, of those that move
 */
export function distributeMoves(boxes: ({name: string, pose: number[]} & Bounds)[],
    axis: 'x'|'y'|'z'): Record<string, number[]> {
  if (boxes.length < 3) return {};
  const at = AXES[axis];
  const sorted = [...boxes].sort((a, b) => a.min[at] + a.max[at] - b.min[at] - b.max[at]);
  const [first, last] = [sorted[0], sorted[sorted.length - 1]];
  const inner = sorted.slice(1, -1);
  const room = last.min[at] - first.max[at] - inner.reduce((sum, {min, max}) => sum + max[at] - min[at], 0);
  const gap = room / (sorted.length - 1);
  const moves: Record<string, Pose7> = {};
  let next = first.max[at] + gap;
  for (const box of inner) {
    const shift = [0, 0, 0];
    shift[at] = next - box.min[at];
    next += box.max[at] - box.min[at] + gap;
    if (Math.abs(shift[at]) > 1e-9) moves[box.name] = [...add(position(box.pose), shift), ...orientation(box.pose)];
  }
  return moves;
}
