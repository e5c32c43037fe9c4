/** Aligning models by their bounding boxes, as Gazebo's align tool. */
import {add, orientation, position} from './pose.js';
import type {Pose7, Vec3} from './pose.js';

type Edge = 'min'|'center'|'max';

export interface AlignChoice {
  axis: 'x'|'y'|'z';
  at: Edge;
  /** against the opposite edge of the target */
  reverse?: boolean;
  /** which of the selected models is the target */
  relative?: 'first'|'last';
}

const AXES = {x: 0, y: 1, z: 2};

function edge(box: {min: Vec3, max: Vec3}, axis: number, at: Edge) {
  if (at === 'min') return box.min[axis];
  if (at === 'max') return box.max[axis];
  return (box.min[axis] + box.max[axis]) / 2;
}

const OPPOSITE: Record<Edge, Edge> = {min: 'max', max: 'min', center: 'center'};

/**
 * Where models must go so that one edge of each bounding box lines up with that of a target.
 * @param boxes  in the order of selection; poses and boxes in world axes
 * @returns new pose7 by name, of those that move
 */
export function alignMoves(boxes: {name: string, pose: number[], min: number[], max: number[]}[],
    {axis, at, reverse = false, relative = 'first'}: AlignChoice): Record<string, number[]> {
  if (boxes.length < 2) return {};
  const target = relative === 'first' ? boxes[0] : boxes[boxes.length - 1];
  const index = AXES[axis];
  const goal = edge(target, index, at);
  const moves: Record<string, Pose7> = {};
  for (const box of boxes) {
    if (box === target) continue;
    const shift = [0, 0, 0];
    shift[index] = goal - edge(box, index, reverse ? OPPOSITE[at] : at);
    if (shift[index] === 0) continue;
    moves[box.name] = [...add(position(box.pose), shift), ...orientation(box.pose)];
  }
  return moves;
}
