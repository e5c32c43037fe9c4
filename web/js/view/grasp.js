/** What a drag of the manipulator holds, and what has become of it. */
import {alongAxis, WORLD_AXES} from '../drag_math.js';
import {conjugate, length, multiply, orientation, rotate, subtract} from '../pose.js';
/** @import {AxisName, GizmoMode} from './gizmo.js' */
/** @import {Pose7, Vec3} from '../pose.js' */
/** @import {Ray} from '../drag_math.js' */

/**
 * What is dragged, and how.
 * @typedef {object} Grasp
 * @property {string} name
 * @property {GizmoMode} mode
 * @property {AxisName|null} handle  axis of the handle, null: the body
 * @property {Pose7} first          when the drag began
 * @property {Pose7} start          when the drag began, or its base was changed
 * @property {Vec3} point           grasped, world
 * @property {Ray} ray              when the drag began
 * @property {Vec3} size            for scaling: extent along the own axes
 * @property {Record<string, Pose7>} others  start poses of the models that move along
 * @property {string} how           axis and frame in force; a change restarts the drag
 * @property {boolean} sent         the simulator was notified
 */

/** What a drag has led to: new poses by name, or factors of the size.
 * @typedef {{poses: Record<string, Pose7>, factors?: undefined}|{factors: Vec3, poses?: undefined}} DragResult */

/**
 * Whether a drag has left everything as it was: that is no step of the history.
 * @param {Grasp} grasp
 * @param {DragResult} dragResult
 */
export function isNothing(grasp, {poses, factors}) {
  if (factors) return factors.every((factor) => factor === 1);
  if (grasp.sent) return false;
  return poses[grasp.name].every((part, i) => Math.abs(part - grasp.first[i]) < 1e-9);
}

/**
 * One of the own axes of what is dragged, or of the world's.
 * @param {Grasp} grasp
 * @param {AxisName} name
 * @param {boolean} world
 */
export const axisOf = (grasp, name, world) =>
  world ? WORLD_AXES[name] : rotate(orientation(grasp.first), WORLD_AXES[name]);

/**
 * With a handle the drag is along its axis: from the point of it under the mouse.
 * @param {Grasp} grasp
 * @param {Vec3} point
 */
export function graspedPoint(grasp, point) {
  const axis = grasp.handle && axisOf(grasp, grasp.handle, false);
  const along = axis && alongAxis(grasp.ray, point, axis);
  return axis && along ? point.map((part, index) => part + along * axis[index]) : point;
}

/**
 * What a drag has come to: position and way, angle, or size.
 * @param {Grasp} grasp
 * @param {DragResult} dragResult
 */
export function numbersOf(grasp, {poses, factors}) {
  /** @param {ArrayLike<number>} vector */
  const vector = (vector) => ['x', 'y', 'z'].map((axis, at) => `${axis} ${vector[at].toFixed(3)}`).join('  ');
  if (factors) return `${vector(grasp.size.map((part, at) => part * factors[at]))} m`;
  const pose = poses[grasp.name];
  if (grasp.mode === 'rotate') {
    const turn = multiply(orientation(pose), conjugate(orientation(grasp.first)));
    const degrees = 2 * Math.atan2(Math.hypot(turn[0], turn[1], turn[2]), Math.abs(turn[3])) * 180 / Math.PI;
    return `${degrees.toFixed(1)}°`;
  }
  const way = subtract(pose, grasp.first);
  return `${vector(pose)} m   moved ${length(way).toFixed(3)} m`;
}
