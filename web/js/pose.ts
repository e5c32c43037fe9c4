/**
 * Poses in plain arrays: [x, y, z, qx, qy, qz, qw], m, parent from child, as the simulator's.
 * Vectors are [x, y, z]; quaternions [x, y, z, w], unit.
 */

export type Vec3 = number[];
export type Quat = number[];
export type Pose7 = number[];
/** What functions take: a list or a typed array. */
export type Numbers = ArrayLike<number>;

export const add = (a: Numbers, b: Numbers): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Numbers, b: Numbers): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Numbers, factor: number): Vec3 => [a[0] * factor, a[1] * factor,
    a[2] * factor];
export const dot = (a: Numbers, b: Numbers) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Numbers, b: Numbers): Vec3 => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Numbers) => Math.hypot(a[0], a[1], a[2]);
/** The unit vector along `a`; `a` itself when it is zero. */
export const normalized = (a: Numbers) => {
  const norm = length(a);
  return norm > 0 ? scale(a, 1 / norm) : [a[0], a[1], a[2]];
};

/** a * b: first b, then a. */
export function multiply(a: Numbers, b: Numbers): Quat {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

export const conjugate = (q: Numbers): Quat => [-q[0], -q[1], -q[2], q[3]];

export function rotate(q: Numbers, v: Numbers): Vec3 {
  const t = scale(cross(q, v), 2);
  return add(add(v, scale(t, q[3])), cross(q, t));
}

/** Rotation by `angle` rad about the unit vector `axis`. */
export function axisAngle(axis: Numbers, angle: number): Quat {
  const s = Math.sin(angle / 2);
  return [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)];
}

/** The shortest rotation that turns unit vector `a` into unit vector `b`. */
export function rotationBetween(a: Numbers, b: Numbers): Quat {
  const w = 1 + dot(a, b);
  if (w < 1e-9) {
    const side = Math.abs(a[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
    return [...normalized(cross(a, side)), 0];
  }
  const q = [...cross(a, b), w];
  return scale4(q, 1 / Math.hypot(...q));
}

const scale4 = (q: Numbers, factor: number) => [q[0] * factor, q[1] * factor, q[2] * factor,
    q[3] * factor];

export const position = (pose: Numbers) => [pose[0], pose[1], pose[2]];
export const orientation = (pose: Numbers) => [pose[3], pose[4], pose[5], pose[6]];

/** parent_from_a * a_from_b. */
export function compose(a: Numbers, b: Numbers): number[] {
  const q = orientation(a);
  return [...add(position(a), rotate(q, position(b))), ...multiply(q, orientation(b))];
}

export function inverse(pose: Numbers): number[] {
  const q = conjugate(orientation(pose));
  return [...scale(rotate(q, position(pose)), -1), ...q];
}

/** Where a point of the child frame is in the parent frame. */
export const transform = (pose: Numbers, point: Numbers): Vec3 => add(position(pose),
    rotate(orientation(pose), point));

/** Roll, pitch, yaw about fixed x, y, z (SDF's pose angles), rad. */
export function fromRpy(roll: number, pitch: number, yaw: number): Quat {
  return multiply(axisAngle([0, 0, 1], yaw),
    multiply(axisAngle([0, 1, 0], pitch), axisAngle([1, 0, 0], roll)));
}

/** The rotation a part (0..1) of the shorter way from `a` to `b`. */
export function slerp(a: number[], b: number[], part: number): Quat {
  const cosine = a.reduce((sum, value, index) => sum + value * b[index], 0);
  const end = cosine < 0 ? scale4(b, -1) : b;
  const angle = Math.acos(Math.min(Math.abs(cosine), 1));
  const [from, to] = angle < 1e-6 ? [1 - part, part]
    : [Math.sin((1 - part) * angle) / Math.sin(angle), Math.sin(part * angle) / Math.sin(angle)];
  const mixed = a.map((value, index) => from * value + to * end[index]);
  return scale4(mixed, 1 / Math.hypot(...mixed));
}

/**
 * How far, m, a point of a body has gone at most between two poses.
 * @param radius  of the body about its origin, m
 */
export function displacement(from: Numbers, to: Numbers, radius: number) {
  // Half the angle is the distance of the quaternions, of which q and -q are the same rotation.
  const sign = from[3] * to[3] + from[4] * to[4] + from[5] * to[5] + from[6] * to[6] < 0 ? -1 : 1;
  const half = Math.hypot(from[3] - sign * to[3], from[4] - sign * to[4], from[5] - sign * to[5],
    from[6] - sign * to[6]);
  return Math.hypot(from[0] - to[0], from[1] - to[1], from[2] - to[2]) + 2 * half * radius;
}
