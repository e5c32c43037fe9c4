/**
 * What is wrong with a plan, told while it is drawn; the simulator looks again before it builds.
 */
import {crossing, isSimple, side} from './plane_geometry.js';
import {linkName, OPENING_KINDS, placeOf, wallLength} from './plan.js';
import {neighbours} from './rooms.js';
import type {Issue} from '../connection.js';
import type {Level, Opening, Wall} from '../protocol.js';
import type {Ref} from './plan.js';

const SHORTEST = 0.01;
const SLACK = 1e-6;
const known: WeakMap<Level, Fault[]> = new WeakMap();

/** What is wrong with a plan; `at` and `refs`: the level and items, where they are known. */
export type Fault = {severity: Issue['severity'], message: string, refs?: Ref[], at?: number};

/** The faults of a level; the same level gives the same answer without work. */
export function faultsOf(level: Level): Fault[] {
  let found = known.get(level);
  if (!found) {
    found = [...wallFaults(level.walls), ...openingFaults(level), ...floorFaults(level)];
    known.set(level, found);
  }
  return found;
}

const byWalls: WeakMap<Wall[], Fault[]> = new WeakMap();

function wallFaults(walls: Wall[]) {
  let found = byWalls.get(walls);
  if (found) return found;
  found = [];
  for (const wall of walls) {
    if (wallLength(wall) < SHORTEST) {
      found.push(fault('error', 'Wall_%0 has zero length', {kind: 'walls', id: wall.id}));
    }
  }
  for (const [i, j] of neighbours(walls)) {
    const how = meeting(walls[i], walls[j]);
    if (how) {
      found.push(fault('warning', `Wall_%0 and Wall_%1 ${how}`,
        {kind: 'walls', id: walls[i].id}, {kind: 'walls', id: walls[j].id}));
    }
  }
  byWalls.set(walls, found);
  return found;
}

/** 'cross', 'overlap', or '' for walls that merely end at one another. */
export function meeting(a: Wall, b: Wall) {
  if (wallLength(a) < SHORTEST || wallLength(b) < SHORTEST) return '';
  const sides = [side(a.start, a.end, b.start), side(a.start, a.end, b.end)];
  if (Math.max(...sides.map(Math.abs)) < 1e-4) {
    const length = wallLength(a);
    const along = [b.start, b.end].map((point) => ((a.end[0] - a.start[0]) *
      (point[0] - a.start[0]) + (a.end[1] - a.start[1]) * (point[1] - a.start[1])) / length);
    const shared = Math.min(Math.max(...along), length) - Math.max(Math.min(...along), 0);
    return shared > SHORTEST ? 'overlap' : '';
  }
  const others = [side(b.start, b.end, a.start), side(b.start, b.end, a.end)];
  const inside = [sides, others].every((pair) =>
    Math.min(...pair) < -SHORTEST && Math.max(...pair) > SHORTEST);
  return inside && crossing(a.start, a.end, b.start, b.end) ? 'cross' : '';
}

/** Why an opening does not fit into a wall; '' where it does. */
export function openingFault(opening: Opening, wall: Wall) {
  const length = wallLength(wall);
  const [left, right] = [opening.along - opening.width / 2, opening.along + opening.width / 2];
  if (opening.width > length + SLACK) {
    return `is ${metres(opening.width)} wide, but the wall is only ${metres(length)} long`;
  }
  if (left < -SLACK || right > length + SLACK) return 'extends beyond the end of the wall';
  if (opening.elevation + opening.height > wall.height + SLACK) {
    return `ends at ${metres(opening.elevation + opening.height)}, above the wall height of ${metres(wall.height)}`;
  }
  return '';
}

/** True when two openings of one wall share more than an edge. */
const overlap = (a: Opening, b: Opening) => a.wall !== null && a.wall === b.wall &&
  Math.abs(a.along - b.along) < (a.width + b.width) / 2 - SLACK &&
  a.elevation + a.height > b.elevation + SLACK && b.elevation + b.height > a.elevation + SLACK;

/** Every opening of a level, with its ref. */
const openingsOf = (level: Level) => OPENING_KINDS.flatMap((kind) =>
  level[kind].map((item) => ({ref: {kind, id: item.id}, item})));

/** Why an opening cannot stay where it is; '' where it can, or where it stands free. */
export function openingTrouble(level: Level, opening: Opening|undefined) {
  const wall = level.walls.find(({id}) => id === opening?.wall);
  if (!wall || !opening) return '';
  const other = openingsOf(level).some(({item}) => item !== opening && overlap(item, opening));
  return openingFault(opening, wall) || (other ? 'overlaps another opening' : '');
}

function openingFaults(level: Level) {
  const found: Fault[] = [];
  const byWall: Map<number, {ref: Ref, item: Opening}[]> = new Map();
  for (const entry of openingsOf(level)) {
    const {wall} = placeOf(entry.item, level);
    if (!wall) continue;
    const why = openingFault(entry.item, wall);
    if (why) found.push({severity: 'error', message: `${linkName(entry.ref)} ${why}`, refs: [entry.ref]});
    const others = byWall.get(wall.id) ?? [];
    for (const other of others) {
      if (overlap(entry.item, other.item)) {
        found.push({severity: 'error', refs: [other.ref, entry.ref],
          message: `${linkName(other.ref)} and ${linkName(entry.ref)} overlap`});
      }
    }
    byWall.set(wall.id, [...others, entry]);
  }
  return found;
}

function floorFaults(level: Level) {
  return level.floors.filter((floor) => !isSimple(floor.outline)).map(({id}) =>
    fault('error', 'Floor_%0 intersects itself', {kind: 'floors', id}));
}

function fault(severity: 'error'|'warning', words: string, ...refs: Ref[]) {
  return {severity, refs, message: words.replace(/%(\d)/g, (_, at) => String(refs[Number(at)].id))};
}

export const metres = (value: number) => `${Math.round(value * 1000) / 1000} m`;

