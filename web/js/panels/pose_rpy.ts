/**
 * Roll, pitch, yaw (fixed axes x, y, z, as SDF writes poses) and poses of seven numbers
 * [x, y, z, qx, qy, qz, qw]. Pure.
 */
import {fromRpy} from '../pose.js';

/**
 * @param q  unit quaternion x, y, z, w
 * @returns roll, pitch, yaw in rad; roll 0 where the pitch is a right angle
 */
export function rpyOf([x, y, z, w]: number[]): number[] {
  const sine = 2 * (w * y - z * x);
  if (Math.abs(sine) > 1 - 1e-9) {
    const sign = Math.sign(sine);
    return [0, (sign * Math.PI) / 2, -sign * 2 * Math.atan2(x, w)].map(clean);
  }
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    Math.asin(sine),
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  ].map(clean);
}

function clean(angle: number) {
  const turned = Math.atan2(Math.sin(angle), Math.cos(angle));
  return Math.abs(turned) < 1e-12 ? 0 : turned;
}

/** @returns x, y, z, roll, pitch, yaw of a pose of seven numbers */
export function sixOf(pose: number[]): number[] {
  return [...pose.slice(0, 3), ...rpyOf(pose.slice(3, 7))];
}

/** @returns the pose of seven numbers of x, y, z, roll, pitch, yaw */
export function sevenOf(six: number[]): number[] {
  return [...six.slice(0, 3), ...fromRpy(six[3], six[4], six[5])];
}
