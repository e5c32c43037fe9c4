/**
 * Where an actor is at a time. Its trajectories run one after the other, each from its first
 * waypoint on, in world axes; a spline of the trajectory's `tension` joins their positions, another
 * one their orientations (`turn_spline.js`). One without waypoints lasts as long as the animation
 * that it names. All this is as in Gazebo; but an actor is at its `<pose>` in trajectories without
 * waypoints, in Gazebo at the world's origin. The distance along a path restarts at 0 with each
 * cycle; in Gazebo it does not in a loop of one trajectory. Each cycle begins after `delay_start`
 * (SDF spec 1.7, script/delay_start).
 */
import {length, orientation, position, subtract} from './pose.js';
import {controlsOf, onTurn, withNeighbours} from './turn_spline.js';
import type {Actor, Trajectory, Waypoint} from './protocol.js';

/**
 * time: s since the trajectory began; slope: of the spline, m for a whole segment; turn: the
 * orientation; control: of the spline of turns
 */
type Key = {time: number, pose: number[], slope: number[], turn: number[], control: number[]};

/** Into which a segment is divided to measure it. */
const CHORDS = 32;

/** Waypoints in the order of their times; of those of one time the last counts. */
function inOrder(waypoints: Waypoint[]) {
  const byTime = new Map(waypoints.map(({time, pose}) => [time, pose]));
  return [...byTime].map(([time, pose]) => ({time, pose})).sort((a, b) => a.time - b.time);
}

/**
 * Returns the slopes of a cardinal spline. They do not depend on the duration of the segments
 * (ignition::math::Spline).
 * @param tension  0: Catmull-Rom; 1: straight, with a halt at each point
 */
function slopes(points: number[][], tension: number) {
  const around = withNeighbours(points);
  return points.map((_, index) => around[index + 2].map(
    (value, axis) => 0.5 * (1 - tension) * (value - around[index][axis])));
}

/**
 * @param part  of the segment, 0 to 1
 * @returns position on the spline
 */
function onSpline(from: Key, to: Key, part: number): number[] {
  const [start, end] = [position(from.pose), position(to.pose)];
  const rest = 1 - part;
  const ahead = part * part * (3 - 2 * part);
  return start.map((value, axis) => value + ahead * (end[axis] - value) +
    part * rest * (rest * from.slope[axis] - part * to.slope[axis]));
}

/** m along the path from the first waypoint to the ends of all chords. */
function distancesOf(keys: Key[]) {
  const found = [0];
  let at = position(keys[0].pose);
  for (let n = 1; n < keys.length; n++) {
    for (let chord = 1; chord <= CHORDS; chord++) {
      const there = onSpline(keys[n - 1], keys[n], chord / CHORDS);
      found.push(found[found.length - 1] + length(subtract(there, at)));
      at = there;
    }
  }
  return found;
}

/**
 * What the limbs do.
 * type: name of the animation; time: s since it began; distance: m along the path since then,
 * where the animation advances by it; onPath: whether a path says how far the actor has come
 */
export type Stride = {type: string, time: number, distance: number|null, onPath: boolean};

/** A trajectory within the script, from `begin` on for `length`, s. */
class Leg {
  begin;
  keys: Key[];
  length;
  #type;
  #distances: number[] = [];

  /** @param duration  of its animation, s */
  constructor({type, waypoints, tension}: Trajectory, begin: number, duration: number,
      measured: boolean) {
    const ordered = inOrder(waypoints);
    const along = slopes(ordered.map(({pose}) => position(pose)), tension);
    const turns = ordered.map(({pose}) => orientation(pose));
    const controls = controlsOf(turns);
    this.#type = type;
    this.begin = begin;
    this.keys = ordered.map(({time, pose}, n) => ({time: n ? time : 0, pose, slope: along[n],
      turn: turns[n], control: controls[n]}));
    this.length = ordered.length ? Math.max(ordered[ordered.length - 1].time, 0) : duration;
    if (measured && this.keys.length) this.#distances = distancesOf(this.keys);
  }

  /** Returns the number of the segment at a time since `begin` and the share of it already walked, 0 to 1. */
  #segmentAt(time: number) {
    const next = this.keys.findIndex((key) => key.time > time);
    if (next <= 0) return {n: next < 0 ? this.keys.length - 1 : 0, part: 0};
    const [from, to] = [this.keys[next - 1].time, this.keys[next].time];
    return {n: next - 1, part: (time - from) / (to - from)};
  }

  /**
   * @param time  since `begin`
   * @returns pose7 in the world
   */
  poseAt(time: number): number[] {
    const {n, part} = this.#segmentAt(time);
    const [from, to] = [this.keys[n], this.keys[n + 1]];
    return part ? [...onSpline(from, to, part), ...onTurn(from, to, part)] : [...from.pose];
  }

  /** @param time  since `begin` */
  strideAt(time: number): Stride {
    const onPath = this.keys.length > 0;
    const stride = {type: this.#type, time: onPath ? time : Math.min(time, this.length), onPath};
    if (!this.#distances.length) return {...stride, distance: null};
    const {n, part} = this.#segmentAt(time);
    const chord = Math.floor(part * CHORDS);
    const last = this.#distances.length - 1;
    const [from, to] = [chord, chord + 1]
      .map((one) => this.#distances[Math.min(n * CHORDS + one, last)]);
    return {...stride, distance: from + (to - from) * (part * CHORDS - chord)};
  }
}

export class ActorPath {
  #actor;
  #legs: Leg[] = [];
  #length = 0;

  /** @param durations  of its animations by name, s */
  constructor(actor: Actor, durations: Map<string, number>) {
    this.#actor = actor;
    const byDistance = new Set(actor.animations.filter((one) => one.interpolate_x)
      .map(({name}) => name));
    for (const one of actor.trajectories) {
      const leg = new Leg(one, this.#length, durations.get(one.type) ?? 0, byDistance.has(one.type));
      if (!leg.keys.length && !(leg.length > 0)) continue;
      this.#legs.push(leg);
      this.#length += leg.length;
    }
  }

  /** Whether time makes any difference to where it is. */
  get moves() {
    return this.#actor.auto_start && this.#legs.some(({keys}) => keys.length > 0);
  }

  /**
   * How long the script has been running, s; null before it begins for the first time. Without a
   * trajectory nothing ends it.
   * @param time  sim time, s
   */
  scriptTime(time: number) {
    const {auto_start: starts, delay_start: delay, loop} = this.#actor;
    const since = time - Math.max(delay, 0);
    if (!starts || since < 0) return null;
    if (!this.#length) return since;
    if (!loop) return Math.min(since, this.#length);
    const cycle = this.#length + Math.max(delay, 0);
    return Math.min(since % cycle, this.#length);
  }

  /** @param at  script time, s */
  #legAt(at: number) {
    return this.#legs.filter(({begin}) => begin <= at).at(-1);
  }

  /**
   * What the limbs do: the animation that the trajectory of the time names, from the trajectory's
   * own begin (Gazebo behaviour); null before the script begins.
   * @param time  sim time, s
   */
  strideAt(time: number): Stride|null {
    const at = this.scriptTime(time);
    if (at === null) return null;
    const leg = this.#legAt(at);
    return leg?.strideAt(at - leg.begin) ?? {type: '', time: at, distance: null, onPath: false};
  }

  /**
   * @param time  sim time, s
   * @returns pose7 in the world
   */
  poseAt(time: number): number[] {
    const at = this.scriptTime(time);
    const leg = at === null ? undefined : this.#legAt(at);
    if (at === null || !leg?.keys.length) return [...this.#actor.pose];
    return leg.poseAt(at - leg.begin);
  }
}
