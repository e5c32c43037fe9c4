/** Aligning models by their bounding boxes, as Gazebo's align tool. */
import {add, orientation, position} from './pose.js';

const AXES = {x: 0, y: 1, z: 2};

function edge(box, axis, at) {
  if (at === 'min') return box.min[axis];
  if (at === 'max') return box.max[axis];
  return (box.min[axis] + box.max[axis]) / 2;
}

const OPPOSITE = {min: 'max', max: 'min', center: 'center'};

/**
 * Where models must go so that one edge of each bounding box lines up with that of a target.
 * @param {{name: string, pose: number[], min: number[], max: number[]}[]} boxes
 *        in the order of selection; poses and boxes in world axes
 * @param {{axis: 'x'|'y'|'z', at: 'min'|'center'|'max', reverse?: boolean,
 *          relative?: 'first'|'last'}} choice  reverse: against the target's opposite edge
 * @returns {Record<string, number[]>} new pose7 by name, of those that move
 */
export function alignMoves(boxes, {axis, at, reverse = false, relative = 'first'}) {
  if (boxes.length < 2) return {};
  const target = relative === 'first' ? boxes[0] : boxes[boxes.length - 1];
  const index = AXES[axis];
  const goal = edge(target, index, at);
  const moves = {};
  for (const box of boxes) {
    if (box === target) continue;
    const shift = [0, 0, 0];
    shift[index] = goal - edge(box, index, reverse ? OPPOSITE[at] : at);
    if (shift[index] === 0) continue;
    moves[box.name] = [...add(position(box.pose), shift), ...orientation(box.pose)];
  }
  return moves;
}
