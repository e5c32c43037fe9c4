/** Aligning models by their bounding boxes, as Gazebo's align tool. */
import {add, orientation, position} from './pose.js';
/** @import {Pose7, Vec3} from './pose.js' */

/** @typedef {'min'|'center'|'max'} Edge */

/**
 * @typedef {object} AlignChoice
 * @property {'x'|'y'|'z'} axis
 * @property {Edge} at
 * @property {boolean} [reverse]  against the opposite edge of the target
 * @property {'first'|'last'} [relative]  which of the selected models is the target
 */

const AXES = {x: 0, y: 1, z: 2};

/**
 * @param {{min: Vec3, max: Vec3}} box
 * @param {number} axis
 * @param {Edge} at
 */
function edge(box, axis, at) {
  if (at === 'min') return box.min[axis];
  if (at === 'max') return box.max[axis];
  return (box.min[axis] + box.max[axis]) / 2;
}

/** @type {Record<Edge, Edge>} */
const OPPOSITE = {min: 'max', max: 'min', center: 'center'};

/**
 * Where models must go so that one edge of each bounding box lines up with that of a target.
 * @param {{name: string, pose: number[], min: number[], max: number[]}[]} boxes
 *        in the order of selection; poses and boxes in world axes
 * @param {AlignChoice} choice
 * @returns {Record<string, number[]>} new pose7 by name, of those that move
 */
export function alignMoves(boxes, {axis, at, reverse = false, relative = 'first'}) {
  if (boxes.length < 2) return {};
  const target = relative === 'first' ? boxes[0] : boxes[boxes.length - 1];
  const index = AXES[axis];
  const goal = edge(target, index, at);
  /** @type {Record<string, Pose7>} */
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
