/** Where the end of a wall goes while it is drawn or dragged. */
import {crossing, direction, distance, nearest, polar, same, tidyPoint} from './plane_geometry.js';
import type {Point} from './plane_geometry.js';
import type {Wall} from '../protocol.js';

export const SNAP_ANGLE = Math.PI / 12;
/** Metres between the places where walls on free ground start, and between their lengths. */
const SNAP_LENGTH = 0.25;
const ENDS: readonly ('start'|'end')[] = Object.freeze(['start', 'end']);
/** Metres within which an end is drawn to another one, and an opening to a wall. */
export const REACH = 0.3;
/** Metres within which a click is one on the spot: the second of a double click draws no wall. */
const SPOT = 0.12;

/** The nearest end of a wall within reach, or null. */
function nearEnd(walls: Wall[], point: Point, wanted: (wall: Wall,
    end: 'start'|'end') => boolean = () => true) {
  let best = null;
  let least = REACH;
  for (const wall of walls) {
    for (const end of ENDS) {
      const away = distance(wall[end], point);
      if (away <= least && wanted(wall, end)) {
        least = away;
        best = wall[end];
      }
    }
  }
  return best;
}

/**
 * The end of a wall that starts at `from`: on another end, else at a multiple of 15 degrees, on a wall
 * in the way or with an outer length (thickness and all) of a multiple of 0.25 m; `free` takes the
 * point as it is.
 */
export function snapEnd(from: Point, point: Point, {walls = [], thickness = 0.15,
    free = false}: {walls?: Wall[], thickness?: number, free?: boolean} = {}):
    {point: Point, on: 'end'|'wall'|'grid'|'free'} {
  if (free) return {point: tidyPoint(point), on: 'free'};
  const end = nearEnd(walls, point, (wall, name) => distance(wall[name], from) > 1e-4);
  if (end) return {point: end, on: 'end'};
  const met = onWall(from, point, walls);
  if (met) return {point: tidyPoint(met), on: 'wall'};
  return {point: snapPolar(from, point, thickness), on: 'grid'};
}

/** As `snapEnd` without foreign ends; `from` itself for a point on the spot. */
export function snapPolar(from: Point, point: Point, thickness: number) {
  if (distance(from, point) < SPOT) return tidyPoint(from);
  const angle = Math.round(direction(from, point) / SNAP_ANGLE) * SNAP_ANGLE;
  const steps = Math.round((distance(from, point) + thickness) / SNAP_LENGTH);
  const length = steps * SNAP_LENGTH - thickness;
  return length < 0.05 ? tidyPoint(from) : tidyPoint(polar(from, angle, length));
}

/** Where the ray of 15 degrees meets a wall within reach of the mouse, so that rooms close. */
function onWall(from: Point, point: Point, walls: Wall[]) {
  if (distance(from, point) < SPOT) return null;
  const ahead = polar(from, Math.round(direction(from, point) / SNAP_ANGLE) * SNAP_ANGLE, 1);
  let best = null;
  let least = REACH;
  for (const wall of walls) {
    if (nearest(from, wall.start, wall.end).distance < 1e-3) continue;
    const met = crossing(from, ahead, wall.start, wall.end);
    if (!met || nearest(met, wall.start, wall.end).distance > 1e-6) continue;
    const away = distance(met, point);
    if (away < least) {
      least = away;
      best = met;
    }
  }
  return best;
}

/** The start of a wall: on another end, else in the middle of a wall that is there, else on the grid. */
export function snapFirst(point: Point, options: {walls?: Wall[], free?: boolean} = {}) {
  const start = snapStart(point, options);
  return options.free || !same(start, tidyPoint(point)) ? start : tidyPoint([
    Math.round(point[0] / SNAP_LENGTH) * SNAP_LENGTH, Math.round(point[1] / SNAP_LENGTH) * SNAP_LENGTH]);
}

/** A corner: on the end of a wall, else in the middle of a wall that is there, else as it is. */
export function snapStart(point: Point, {walls = [], free = false}: {walls?: Wall[],
    free?: boolean} = {}) {
  if (free) return tidyPoint(point);
  const end = nearEnd(walls, point);
  if (end) return end;
  const under = walls.map((wall) => ({wall, ...nearest(point, wall.start, wall.end)}))
    .find(({wall, distance: away}) => away <= wall.thickness / 2 + 0.02);
  return tidyPoint(under?.point ?? point);
}
