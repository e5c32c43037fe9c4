/** What Ctrl does to a drag: positions, turns and sizes stick to round values, as in Gazebo. */

const METRE = 1;
const SENSITIVITY = 0.4;
const TURN = Math.PI / 4;
export const SMALLEST_SIZE = 1e-4;

/**
 * A value that sticks to whole multiples of `interval` when it comes near one.
 * @param sensitivity  how near, as a part of the interval
 */
export function magnetic(value: number, interval: number = METRE, sensitivity: number = SENSITIVITY) {
  const whole = Math.round(value / interval) * interval;
  return Math.abs(value - whole) <= sensitivity * interval + 1e-12 ? whole + 0 : value;
}

/**
 * An angle in whole steps of 45 degrees.
 * @param angle  rad
 */
export const snapTurn = (angle: number) => Math.round(angle / TURN) * TURN + 0;

/**
 * A size that sticks to whole metres but never vanishes.
 * @param size  m
 */
export const snapSize = (size: number) => Math.max(magnetic(size), SMALLEST_SIZE);
