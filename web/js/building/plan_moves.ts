/** Moves the items of a plan. Linked walls are stretched, openings keep their place. */
import {minus, plus, polar, same, tidy, tidyPoint} from './plane_geometry.js';
import {itemOf, refit, update, wallLength, wallYaw, withLevel} from './plan.js';
import type {Level, Opening, Plan, Wall} from '../protocol.js';
import type {Ref} from './plan.js';
import type {Point} from './plane_geometry.js';

/** The ends of a wall that move. */
type Ends = {start?: Point, end?: Point};

const ENDS: readonly ('start'|'end')[] = Object.freeze(['start', 'end']);

/** Changes the ends of several walls at once; openings keep their distance from the end that stays. */
function setEnds(plan: Plan, at: number, ends: Map<number, Ends>) {
  const level = plan.levels[at];
  const shift: Map<number, number> = new Map();
  const walls = level.walls.map((wall) => {
    const moved = ends.get(wall.id);
    if (!moved) return wall;
    const made = {...wall, ...moved};
    const stays = !moved.start || (moved.end && same(minus(moved.start, wall.start), minus(moved.end, wall.end)));
    if (!stays) shift.set(wall.id, wallLength(made) - wallLength(wall));
    return made;
  });
  const slid = (list: Opening[]) => list.map((opening) => {
    const by = shift.get(opening.wall ?? -1);
    return by ? {...opening, along: tidy(opening.along + by)} : opening;
  });
  const changes = {walls, windows: slid(level.windows), doors: slid(level.doors)};
  return refit(withLevel(plan, at, changes), at, 'walls');
}

/** The ends of walls that lie on a point: [wall, 'start'|'end']. */
function endsAt(level: Level, point: Point) {
  return level.walls.flatMap((wall) => ENDS.filter((end) => same(wall[end], point))
    .map((end) => [wall, end] as [Wall, 'start'|'end']));
}

/** Moves the end of a wall, and the ends linked with it unless `alone`. */
export function moveEnd(plan: Plan, at: number, id: number, end: 'start'|'end', point: Point,
    {alone = false} = {}) {
  const level = plan.levels[at];
  const wall = level.walls.find((one) => one.id === id);
  const ends: Map<number, Ends> = new Map([[id, {[end]: tidyPoint(point)}]]);
  if (!alone && wall) {
    for (const [other, its] of endsAt(level, wall[end])) {
      ends.set(other.id, {...ends.get(other.id), [its]: tidyPoint(point)});
    }
  }
  return setEnds(plan, at, ends);
}

/** Moves walls without changing their shape. Walls that share an end with them are stretched. */
function moveWalls(plan: Plan, at: number, ids: number[], by: Point) {
  const level = plan.levels[at];
  const ends: Map<number, Ends> = new Map();
  for (const wall of level.walls.filter(({id}) => ids.includes(id))) {
    for (const end of ENDS) {
      for (const [other, its] of endsAt(level, wall[end])) {
        ends.set(other.id, {...ends.get(other.id), [its]: tidyPoint(plus(wall[end], by))});
      }
    }
  }
  return setEnds(plan, at, ends);
}

/** Gives a wall an outer length, by moving its end. */
export function setOuterLength(plan: Plan, at: number, id: number, length: number) {
  const wall = plan.levels[at].walls.find((one) => one.id === id);
  if (!wall) return plan;
  const inner = Math.max(length - wall.thickness, 0.01);
  return moveEnd(plan, at, id, 'end', polar(wall.start, wallYaw(wall), inner));
}

/**
 * Returns a plan with moved items. Walls that are linked with a moved wall are stretched; openings
 * in walls move with their wall.
 * @param at  index of the level
 */
export function moveItems(plan: Plan, at: number, refs: Ref[], by: Point) {
  const walls = refs.filter(({kind}) => kind === 'walls').map(({id}) => id);
  let made = walls.length ? moveWalls(plan, at, walls, by) : plan;
  for (const ref of refs) {
    const item = itemOf(plan, at, ref);
    if (!item || 'start' in item) continue;
    if ('outline' in item) {
      const shifted = (loop: Point[]) => loop.map((point) => tidyPoint(plus(point, by)));
      made = update(made, at, ref,
        {outline: shifted(item.outline), holes: item.holes.map(shifted), fit: 'none'});
    } else if (!('wall' in item) || item.wall === null) {
      made = update(made, at, ref, {position: tidyPoint(plus(item.position, by))});
    }
  }
  return made;
}
