/**
 * Where an actor is at a time. Its trajectories run one after the other, each from its first
 * waypoint on, in world axes; a spline of the trajectory's `tension` joins their positions (Gazebo
 * behaviour), the shorter way of turning their orientations; Gazebo joins these by a spline, too,
 * whose turns swing by a few degrees about straight parts of a path. Unlike in Gazebo, trajectories
 * without waypoints take no time, and limbs move by time where an animation says `interpolate_x`.
 * `delay_start` is waited for before each cycle (SDF spec 1.7, script/delay_start).
 */
import {orientation, position, slerp} from './pose.js';
/** @import {Actor, Trajectory, Waypoint} from './protocol.js' */

/**
 * @typedef {{time: number, pose: number[], slope: number[]}} Key
 *   slope: of the spline, m for a whole segment
 */

/** m; ends of a path that are no further apart are one point (ignition::math::Vector3). */
const CLOSED = 1e-3;

/**
 * Waypoints in the order of their times; of those of one time the last counts.
 * @param {Waypoint[]} waypoints
 */
function inOrder(waypoints) {
  const byTime = new Map(waypoints.map(({time, pose}) => [time, pose]));
  return [...byTime].map(([time, pose]) => ({time, pose})).sort((a, b) => a.time - b.time);
}

/**
 * Slopes of a cardinal spline, which do not heed how long segments take (ignition::math::Spline).
 * @param {number[][]} points
 * @param {number} tension  0: Catmull-Rom; 1: straight, with a halt at each point
 */
function slopes(points, tension) {
  const last = points.length - 1;
  const closed = last > 0 &&
    points[0].every((value, axis) => Math.abs(value - points[last][axis]) <= CLOSED);
  return points.map((_, index) => {
    const before = points[index > 0 ? index - 1 : closed ? last - 1 : 0];
    const after = points[index < last ? index + 1 : closed ? 1 : last];
    return after.map((value, axis) => 0.5 * (1 - tension) * (value - before[axis]));
  });
}

/**
 * @param {Key} from
 * @param {Key} to
 * @param {number} part  of the segment, 0 to 1
 * @returns {number[]} position on the spline
 */
function onSpline(from, to, part) {
  const [start, end] = [position(from.pose), position(to.pose)];
  const rest = 1 - part;
  const ahead = part * part * (3 - 2 * part);
  return start.map((value, axis) => value + ahead * (end[axis] - value) +
    part * rest * (rest * from.slope[axis] - part * to.slope[axis]));
}

/** @typedef {{time: number, type: string}} Begin  of a trajectory, with its animation's name */

/** @typedef {{type: string, time: number}} Stride  type: name of the animation; s since it began */

/**
 * @param {Trajectory[]} trajectories
 * @returns {{keys: Key[], begins: Begin[], length: number}} times in s since the script began
 */
function script(trajectories) {
  /** @type {Key[]} */
  const keys = [];
  /** @type {Begin[]} */
  const begins = [];
  let length = 0;
  for (const {type, waypoints, tension} of trajectories) {
    if (waypoints.length) begins.push({time: length, type});
    const ordered = inOrder(waypoints);
    const along = slopes(ordered.map(({pose}) => position(pose)), tension);
    ordered.forEach(({time, pose}, index) =>
      keys.push({time: length + (index ? time : 0), pose, slope: along[index]}));
    length += Math.max(ordered.at(-1)?.time ?? 0, 0);
  }
  return {keys, begins, length};
}

export class ActorPath {
  #actor;
  #keys;
  #begins;
  #length;

  /** @param {Actor} actor */
  constructor(actor) {
    this.#actor = actor;
    ({keys: this.#keys, begins: this.#begins, length: this.#length} = script(actor.trajectories));
  }

  /** Whether time makes any difference to where it is. */
  get moves() {
    return this.#actor.auto_start && this.#keys.length > 0;
  }

  /**
   * How long the script has been running, s; null before it begins for the first time. Without a
   * trajectory nothing ends it.
   * @param {number} time  sim time, s
   */
  scriptTime(time) {
    const {auto_start: starts, delay_start: delay, loop} = this.#actor;
    const since = time - Math.max(delay, 0);
    if (!starts || since < 0) return null;
    if (!this.#length) return since;
    if (!loop) return Math.min(since, this.#length);
    const cycle = this.#length + Math.max(delay, 0);
    return Math.min(since % cycle, this.#length);
  }

  /**
   * What the limbs do: the animation that the trajectory of the time names, from the trajectory's
   * own begin (Gazebo behaviour); null before the script begins.
   * @param {number} time  sim time, s
   * @returns {Stride|null}
   */
  strideAt(time) {
    const at = this.scriptTime(time);
    if (at === null) return null;
    const running = this.#begins.filter((begin) => begin.time <= at).at(-1);
    return {type: running?.type ?? '', time: at - (running?.time ?? 0)};
  }

  /** @param {number} time  sim time, s @returns {number[]} pose7 in the world */
  poseAt(time) {
    const at = this.scriptTime(time);
    if (at === null || !this.#keys.length) return [...this.#actor.pose];
    const keys = this.#keys;
    const next = keys.findIndex((key) => key.time > at);
    if (next === 0) return [...keys[0].pose];
    if (next < 0) return [...keys[keys.length - 1].pose];
    const [from, to] = [keys[next - 1], keys[next]];
    const part = (at - from.time) / (to.time - from.time);
    return [...onSpline(from, to, part),
      ...slerp(orientation(from.pose), orientation(to.pose), part)];
  }
}
