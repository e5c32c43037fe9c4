/**
 * Where an actor is at a time. Its trajectories run one after the other, each from its first
 * waypoint on, in world axes (Gazebo behaviour); `delay_start` is waited for before each cycle
 * (SDF spec 1.7, script/delay_start).
 */
import {orientation, position, slerp} from './pose.js';
/** @import {Actor, Trajectory, Waypoint} from './protocol.js' */

/** @typedef {{time: number, pose: number[]}} Key */

/**
 * Waypoints in the order of their times; of those of one time the last counts.
 * @param {Waypoint[]} waypoints
 * @returns {Key[]}
 */
function inOrder(waypoints) {
  const byTime = new Map(waypoints.map(({time, pose}) => [time, pose]));
  return [...byTime].map(([time, pose]) => ({time, pose})).sort((a, b) => a.time - b.time);
}

/**
 * @param {Trajectory[]} trajectories
 * @returns {{keys: Key[], length: number}} times in s since the script began
 */
function script(trajectories) {
  /** @type {Key[]} */
  const keys = [];
  let length = 0;
  for (const {waypoints} of trajectories) {
    const ordered = inOrder(waypoints);
    ordered.forEach(({time, pose}, index) =>
      keys.push({time: length + (index ? time : 0), pose}));
    length += Math.max(ordered.at(-1)?.time ?? 0, 0);
  }
  return {keys, length};
}

export class ActorPath {
  #actor;
  #keys;
  #length;

  /** @param {Actor} actor */
  constructor(actor) {
    this.#actor = actor;
    ({keys: this.#keys, length: this.#length} = script(actor.trajectories));
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
    const start = position(from.pose);
    return [...position(to.pose).map((end, axis) => start[axis] + (end - start[axis]) * part),
      ...slerp(orientation(from.pose), orientation(to.pose), part)];
  }
}
