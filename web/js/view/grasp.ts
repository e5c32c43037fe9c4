/** What a drag of the manipulator holds, and what has become of it. */
import {alongAxis, WORLD_AXES} from '../drag_math.js';
import {conjugate, length, multiply, orientation, rotate, subtract} from '../pose.js';
import type {AxisName, GizmoMode} from './gizmo.js';
import type {Pose7, Vec3} from '../pose.js';
import type {Ray} from '../drag_math.js';

/** What is dragged, and how. */
export interface Grasp {
  name: string;
  mode: GizmoMode;
  /** axis of the handle, null: the body */
  handle: AxisName|null;
  /** when the drag began */
  first: Pose7;
  /** when the drag began, or its base was changed */
  start: Pose7;
  /** grasped, world */
  point: Vec3;
  /** when the drag began */
  ray: Ray;
  /** for scaling: extent along the own axes */
  size: Vec3;
  /** start poses of the models that move along */
  others: Record<string, Pose7>;
  /** axis and frame in force; a change restarts the drag */
  how: string;
  /** the simulator was notified */
  sent: boolean;
}

/** What a drag has led to: new poses by name, or factors of the size. */
export type DragResult = {poses: Record<string, Pose7>, factors?: undefined}|{factors: Vec3,
    poses?: undefined};

/** Whether a drag has left everything as it was: that is no step of the history. */
export function isNothing(grasp: Grasp, {poses, factors}: DragResult) {
  if (factors) return factors.every((factor) => factor === 1);
  if (grasp.sent) return false;
  return poses[grasp.name].every((part, i) => Math.abs(part - grasp.first[i]) < 1e-9);
}

/** One of the own axes of what is dragged, or of the world's. */
export const axisOf = (grasp: Grasp, name: AxisName, world: boolean) =>
  world ? WORLD_AXES[name] : rotate(orientation(grasp.first), WORLD_AXES[name]);

/** With a handle the drag is along its axis: from the point of it under the mouse. */
export function graspedPoint(grasp: Grasp, point: Vec3) {
  const axis = grasp.handle && axisOf(grasp, grasp.handle, false);
  const along = axis && alongAxis(grasp.ray, point, axis);
  return axis && along ? point.map((part, index) => part + along * axis[index]) : point;
}

/** What a drag has come to: position and way, angle, or size. */
export function numbersOf(grasp: Grasp, {poses, factors}: DragResult) {
  const vector = (vector: ArrayLike<number>) => ['x', 'y', 'z'].map((axis, at) =>
      `${axis} ${vector[at].toFixed(3)}`).join('  ');
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
