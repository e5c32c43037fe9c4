/** The path data of what a plan holds, in pixels of the sheet: 100 a metre, y down. */
import {fromLocal} from './plane_geometry.js';
import {placeOf, wallLength, wallYaw} from './plan.js';
import type {Floor, Level, Opening, Stairs} from '../protocol.js';
import type {Point} from './plane_geometry.js';

export const SCALE = 100;

const round = (value: number) => Math.round(value * 1000) / 1000;

/** A point of the plan on the sheet. */
export const onSheet = ([x, y]: Point) => [round(x * SCALE), round(-y * SCALE)];

export const pathOf = (points: Point[], closed = true) =>
  points.map((point, at) => `${at ? 'L' : 'M'}${onSheet(point).join(' ')}`).join('') + (closed ? 'Z' : '');

/** The footprint of a wall as it is built: longer than its middle line by its thickness. */
export function wallPath(wall: {start: Point, end: Point, thickness: number}) {
  const [length, half, yaw] = [wallLength(wall), wall.thickness / 2, wallYaw(wall)];
  return pathOf([[-half, -half], [length + half, -half], [length + half, half], [-half, half]]
    .map((point) => fromLocal(point, wall.start, yaw)));
}

/** The parts of an opening's sign: the gap, and the lines in it. */
export function openingPaths(kind: string, opening: Opening, level: Level) {
  const {point, yaw, wall} = placeOf(opening, level);
  const [half, deep] = [opening.width / 2, (wall?.thickness ?? opening.depth) / 2 + 0.005];
  const at = (x: number, y: number) => fromLocal([x, y], point, yaw);
  const frame = pathOf([at(-half, -deep), at(half, -deep), at(half, deep), at(-half, deep)]);
  if (kind === 'windows') {
    return {frame, lines: pathOf([at(-half, 0), at(half, 0)], false)};
  }
  const [leafX, leafY] = onSheet(at(-half, opening.width));
  const [endX, endY] = onSheet(at(half, 0));
  const radius = round(opening.width * SCALE);
  return {frame, lines: `${pathOf([at(-half, 0), at(-half, opening.width)], false)}` +
    `M${leafX} ${leafY}A${radius} ${radius} 0 0 1 ${endX} ${endY}`};
}

/** The outline of stairs, their steps, and an arrow that points up. */
export function stairsPaths(stairs: Omit<Stairs, 'id'>) {
  const at = (x: number, y: number) => fromLocal([x, y], stairs.position, stairs.yaw);
  const [x, y] = [stairs.width / 2, stairs.depth / 2];
  const steps = [];
  for (let step = 1; step < stairs.steps; step++) {
    const v = -y + stairs.depth * step / stairs.steps;
    steps.push(pathOf([at(-x, v), at(x, v)], false));
  }
  const head = Math.min(x, y) * 0.5;
  return {
    frame: pathOf([at(-x, -y), at(x, -y), at(x, y), at(-x, y)]),
    lines: steps.join(''),
    arrow: pathOf([at(0, -y * 0.8), at(0, y * 0.8)], false) +
      pathOf([at(-head, y * 0.8 - head), at(0, y * 0.8), at(head, y * 0.8 - head)], false),
  };
}

export const floorPath = (floor: Floor) => [floor.outline, ...floor.holes].map((loop) =>
    pathOf(loop)).join('');
