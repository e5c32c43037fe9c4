/** What of a level lies under the mouse. */
import {distance, fromLocal, inPolygon, nearest, toLocal} from './plane_geometry.js';
import {itemOf, placeOf, wallLength, wallYaw} from './plan.js';
import {REACH} from './wall_snap.js';
import type {AnyItem, ItemOf, Kind, Ref} from './plan.js';
import type {Level, Opening, Plan, Stairs, Wall} from '../protocol.js';
import type {Point} from './plane_geometry.js';

/** How far above stairs their turning handle stands, in metres. */
const STEM = 0.4;

/** The handles of what is selected. */
export function handlesOf(item: AnyItem): {part: string, point: Point}[] {
  if ('start' in item) {
    return [{part: 'start', point: item.start}, {part: 'end', point: item.end}];
  }
  if ('steps' in item) {
    const [x, y] = [item.width / 2, item.depth / 2];
    const corners = [[-x, -y], [x, -y], [x, y], [-x, y]].map((corner, at) =>
      ({part: `corner${at}`, point: fromLocal(corner, item.position, item.yaw)}));
    return [...corners, {part: 'rotate', point: fromLocal([0, y + STEM], item.position, item.yaw)}];
  }
  if ('outline' in item) {
    return item.outline.map((point, at) => ({part: `vertex${at}`, point}));
  }
  return item.wall === null
    ? [{part: 'rotate', point: fromLocal([0, STEM], item.position, item.yaw)}] : [];
}

/**
 * The item under a point: handles of the selection first, then openings, stairs, walls, floors.
 * @param at  level
 * @param options  metres
 */
export function hitOf(plan: Plan, at: number, point: Point,
    {tolerance = 0.05, selection = []}: {tolerance?: number,
    selection?: Ref[]} = {}): {ref: Ref, part: string}|null {
  for (const ref of selection) {
    const item = itemOf(plan, at, ref);
    const handle = item && handlesOf(item)
      .find((one) => distance(one.point, point) <= tolerance * 1.6);
    if (handle) return {ref, part: handle.part};
  }
  const level = plan.levels[at];
  const body = (kind: Kind, item: {id: number}) => ({ref: {kind, id: item.id}, part: 'body'});
  for (const kind of ['doors', 'windows'] as const) {
    const found = level[kind].findLast((item) => onOpening(item, level, point, tolerance));
    if (found) return body(kind, found);
  }
  const wall = wallUnder(level, point, tolerance);
  if (wall) return body('walls', wall);
  const stairs = level.stairs.findLast((item) => onStairs(item, point));
  if (stairs) return body('stairs', stairs);
  const floor = level.floors.findLast((item) => inPolygon(point, item.outline) &&
    !item.holes.some((hole) => inPolygon(point, hole)));
  return floor ? body('floors', floor) : null;
}

function wallUnder(level: Level, point: Point, tolerance: number) {
  let best: Wall|null = null;
  let least = Infinity;
  for (const wall of level.walls) {
    const {distance: away} = nearest(point, wall.start, wall.end);
    const over = away - wall.thickness / 2;
    if (over <= tolerance && over < least) {
      least = over;
      best = wall;
    }
  }
  return best;
}

function onOpening(opening: Opening, level: Level, point: Point, tolerance: number) {
  const {point: middle, yaw, wall} = placeOf(opening, level);
  const [x, y] = toLocal(point, middle, yaw);
  const depth = Math.max(opening.depth, wall?.thickness ?? 0);
  return Math.abs(x) <= opening.width / 2 && Math.abs(y) <= depth / 2 + tolerance;
}

function onStairs(stairs: Stairs, point: Point) {
  const [x, y] = toLocal(point, stairs.position, stairs.yaw);
  return Math.abs(x) <= stairs.width / 2 && Math.abs(y) <= stairs.depth / 2;
}

/** The wall an opening at this point would stick to: within 0.3 m. */
export function wallNear(level: Level, point: Point, reach = REACH): {wall: Wall, along: number}|null {
  let best = null;
  let least = reach;
  for (const wall of level.walls) {
    const {along, distance: away} = nearest(point, wall.start, wall.end);
    if (away <= least) {
      least = away;
      best = {wall, along};
    }
  }
  return best;
}

/** The items with something inside a box that was drawn with the mouse. */
export function itemsWithin(level: Level, a: Point, b: Point) {
  const inside = ([x, y]: Point) => x >= Math.min(a[0], b[0]) && x <= Math.max(a[0], b[0]) &&
    y >= Math.min(a[1], b[1]) && y <= Math.max(a[1], b[1]);
  const refs: <K extends Kind>(kind: K, items: ItemOf[K][], wanted: (item: ItemOf[K]) => boolean) =>
    Ref[] = (kind, items, wanted) => items.filter(wanted).map(({id}) => ({kind, id}));
  return [
    ...refs('walls', level.walls, (wall) => inside(wall.start) && inside(wall.end)),
    ...refs('windows', level.windows, (item) => inside(placeOf(item, level).point)),
    ...refs('doors', level.doors, (item) => inside(placeOf(item, level).point)),
    ...refs('stairs', level.stairs, (item) => inside(item.position)),
    ...refs('floors', level.floors, (item) => item.outline.every(inside)),
  ];
}

/** Clear distances from an opening's edges to both ends of its wall. */
export function openingDistances(opening: Opening, wall: Wall) {
  return {
    start: opening.along - opening.width / 2,
    end: wallLength(wall) - opening.along - opening.width / 2,
    yaw: wallYaw(wall),
  };
}
