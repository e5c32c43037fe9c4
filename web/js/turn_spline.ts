/**
 * Interpolates orientations between waypoints by Shoemake's spline (1985). It does not depend on the
 * duration of segments (ignition::math::RotationSpline). So turns swing by some degrees about
 * straight parts of a path, and widely if the yaw passes from pi to -pi, because these quaternions
 * are far from each other. Cameras use the same rules (turn_spline.py).
 */
import {conjugate, multiply, slerp} from './pose.js';
import type {Quat} from './pose.js';

/** Ends of which no member (m, or of a quaternion) differs by more are one (ignition::math). */
const CLOSED = 1e-3;

/** Below this the sine of an angle stands for the angle. */
const SMALL = 1e-3;

/** The axis, as long as half the angle; 0 to pi, as the quaternion says. */
function log(turn: Quat) {
  const half = Math.acos(Math.max(-1, Math.min(turn[3], 1)));
  const sine = Math.sin(half);
  const factor = Math.abs(sine) >= SMALL ? half / sine : 1;
  return turn.slice(0, 3).map((value) => value * factor);
}

function exp([x, y, z]: number[]): Quat {
  const half = Math.hypot(x, y, z);
  const sine = Math.sin(half);
  const factor = Math.abs(sine) >= SMALL ? sine / half : 1;
  return [x * factor, y * factor, z * factor, Math.cos(half)];
}

/** From `a` to `b`, not to -`b`, which is the same orientation. */
function alongArc(a: Quat, b: Quat, part: number): Quat {
  const cosine = a.reduce((sum, value, index) => sum + value * b[index], 0);
  const angle = Math.acos(Math.max(-1, Math.min(cosine, 1)));
  const [from, to] = Math.abs(cosine) < 1 - SMALL
    ? [Math.sin((1 - part) * angle) / Math.sin(angle), Math.sin(part * angle) / Math.sin(angle)]
    : [1 - part, part];
  const mixed = a.map((value, index) => from * value + to * b[index]);
  const size = Math.hypot(...mixed);
  const [x, y, z, w] = mixed.map((value) => value / size);
  return size < 1e-12 ? [0, 0, 0, 1] : [x, y, z, w];
}

/**
 * Points with the one before the first and the one after the last. Of a closed path, whose ends
 * are one point, these are from its other end; else the ends again.
 */
export function withNeighbours<P extends number[]>(points: P[]): P[] {
  const last = points.length - 1;
  const closed = last > 0
    && points[0].every((value, n) => Math.abs(value - points[last][n]) <= CLOSED);
  return [points[closed ? last - 1 : 0], ...points, points[closed ? 1 : last]];
}

/** The inner control point at each orientation. */
export function controlsOf(turns: Quat[]): Quat[] {
  if (turns.length < 2) return turns;
  const around = withNeighbours(turns);
  return turns.map((turn, n) => {
    const back = conjugate(turn);
    const [ahead, behind] = [around[n + 2], around[n]].map((other) => log(multiply(back, other)));
    return multiply(turn, exp(ahead.map((value, axis) => -0.25 * (value + behind[axis]))));
  });
}

/** The orientation at a part, 0 to 1, of a segment. */
export const onTurn = (from: {turn: Quat, control: Quat}, to: {turn: Quat, control: Quat},
    part: number) => alongArc(slerp(from.turn, to.turn, part),
  alongArc(from.control, to.control, part), 2 * part * (1 - part));
