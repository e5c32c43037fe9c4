/** Closed rooms between walls, and the outline of all walls, by the faces of a plane graph. */
import {crossing, distance, inPolygon, minus, nearest, plus, same, side, signedArea} from './plane_geometry.js';
import type {Point} from './plane_geometry.js';
import type {Wall} from '../protocol.js';

/** A corner with its neighbors, and the half thickness of the wall to each. */
type Corner = {point: Point, edges: Map<number, number>};

/**
 * The rooms, the outer loop of each group of connected walls, and all corners. Outer loops are
 * clockwise and contain every corner on them.
 */
type Faces = {rooms: Room[], outer: Point[][], corners: Corner[]};

const known: WeakMap<Wall[], Faces> = new WeakMap();

interface Room {
  /** middle lines of its walls, counter-clockwise */
  outline: Point[];
  /** the faces of its walls */
  inside: Point[];
  /** outer loops of free-standing walls in it */
  holes: Point[][];
  /** m2 between the faces of the walls */
  area: number;
}

/** Returns the rooms of a list of walls. Results are cached by list. */
export const roomsOf = (walls: Wall[]): Room[] => facesOf(walls).rooms;

/**
 * The outline of a floor below all walls: the closed loop that no wall leaves, else the bounding box
 * of the walls, as Gazebo lays every floor.
 */
export function outlineOf(walls: Wall[]): Point[]|null {
  if (!walls.length) return null;
  // A wall drawn a little too far ends in the wall it crosses.
  const loop = enclosing(facesOf(walls), Math.max(...walls.map(({thickness}) => thickness)) / 2);
  if (loop) return loop;
  const [x0, y0] = [0, 1].map((axis) => Math.min(...walls.map(({start, end, thickness}) =>
    Math.min(start[axis], end[axis]) - thickness / 2)));
  const [x1, y1] = [0, 1].map((axis) => Math.max(...walls.map(({start, end, thickness}) =>
    Math.max(start[axis], end[axis]) + thickness / 2)));
  return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
}

/**
 * The outer loop that has all walls on it or inside; null where there is none, or where it passes a
 * corner twice, as about rooms that touch at a corner: no floor can have such an outline.
 * @param slack  how far walls may end outside of it, m
 */
function enclosing({outer, corners}: Faces, slack: number) {
  if (!outer.length) return null;
  const largest = outer.reduce((a, b) => signedArea(b) < signedArea(a) ? b : a);
  const on = new Set(largest);
  if (on.size < largest.length) return null;
  const loop = straightened([...largest].reverse());
  const near = (point: Point) => loop.some((corner, at) =>
    nearest(point, corner, loop[(at + 1) % loop.length]).distance <= slack);
  return corners.every(({point}) => on.has(point) || inPolygon(point, loop) || near(point)) ? loop : null;
}

function facesOf(walls: Wall[]) {
  let found = known.get(walls);
  if (!found) known.set(walls, found = faces(walls));
  return found;
}

/** Pairs of walls that come near each other, as places in the list. */
export function* neighbours(walls: Wall[]) {
  const boxes = walls.map(({start, end}, at) => ({
    at, x0: Math.min(start[0], end[0]) - 1e-3, x1: Math.max(start[0], end[0]) + 1e-3,
    y0: Math.min(start[1], end[1]) - 1e-3, y1: Math.max(start[1], end[1]) + 1e-3,
  })).sort((a, b) => a.x0 - b.x0);
  for (let i = 0; i < boxes.length; i++) {
    const a = boxes[i];
    for (let j = i + 1; j < boxes.length && boxes[j].x0 <= a.x1; j++) {
      const b = boxes[j];
      if (b.y0 <= a.y1 && a.y0 <= b.y1) yield [a.at, b.at];
    }
  }
}

function faces(walls: Wall[]): Faces {
  const corners = prune(graphOf(walls));
  const loops = loopsOf(corners);
  const inner = loops.filter(({points}) => signedArea(points) > 1e-6);
  const outer = loops.map(({points}) => points).filter((points) => signedArea(points) < -1e-6);
  const rooms = inner.map(({points, halves}) => {
    const inside = inset(points, halves);
    const room: Room = {outline: straightened(points), inside, holes: [], area: signedArea(inside)};
    return room;
  });
  for (const points of outer) {
    const loop = straightened([...points].reverse());
    const holder = rooms.filter((room) => signedArea(room.outline) > signedArea(loop) + 1e-6 &&
      loop.every((point) => inPolygon(point, room.outline)))
      .sort((a, b) => signedArea(a.outline) - signedArea(b.outline))[0];
    if (!holder) continue;
    holder.holes.push(loop);
    holder.area -= signedArea(loop);
  }
  return {rooms, outer, corners};
}

/** Corners by number, and for each corner its neighbours with the half thickness of the wall. */
function graphOf(walls: Wall[]) {
  const cuts = walls.map(({start, end}) => [start, end]);
  for (const [i, j] of neighbours(walls)) {
    for (const point of meetings(walls[i], walls[j])) {
      cuts[i].push(point);
      cuts[j].push(point);
    }
  }
  const corners: Corner[] = [];
  const cornerOf = numbering(corners);
  walls.forEach((wall, at) => {
    const along = cuts[at].map((point) => ({point, at: distance(wall.start, point)}))
      .sort((a, b) => a.at - b.at).map(({point}) => cornerOf(point));
    for (let n = 0; n + 1 < along.length; n++) {
      const [a, b] = [along[n], along[n + 1]];
      if (a === b) continue;
      corners[a].edges.set(b, wall.thickness / 2);
      corners[b].edges.set(a, wall.thickness / 2);
    }
  });
  return corners;
}

/** Returns a function that numbers points. Equal points get one number; a grid of 1 cm finds them. */
function numbering(corners: Corner[]) {
  const cells: Map<number, number[]> = new Map();
  const cellOf = (column: number, row: number) => column * 4194304 + row;
  return (point: Point) => {
    const [x, y] = [point[0] * 100, point[1] * 100];
    // The next cell may hold the same point if the distance to it is below 0.2 mm.
    for (let column = Math.floor(x - 0.02); column <= Math.floor(x + 0.02); column++) {
      for (let row = Math.floor(y - 0.02); row <= Math.floor(y + 0.02); row++) {
        for (const at of cells.get(cellOf(column, row)) ?? []) {
          if (same(corners[at].point, point)) return at;
        }
      }
    }
    const cell = cellOf(Math.floor(x), Math.floor(y));
    cells.set(cell, [...(cells.get(cell) ?? []), corners.length]);
    corners.push({point, edges: new Map()});
    return corners.length - 1;
  };
}

/** Returns the points that two walls have in common. */
function meetings(a: Wall, b: Wall) {
  const found: Point[] = [];
  const on = (wall: Wall, point: Point) => Math.abs(side(wall.start, wall.end, point)) < 1e-4 &&
    distance(wall.start, point) + distance(point, wall.end) < distance(wall.start, wall.end) + 1e-4;
  for (const point of [b.start, b.end]) if (on(a, point)) found.push(point);
  for (const point of [a.start, a.end]) if (on(b, point)) found.push(point);
  if (found.length) return found;
  const point = crossing(a.start, a.end, b.start, b.end);
  return point && on(a, point) && on(b, point) ? [point] : [];
}

/** Removes dead ends, because they enclose nothing. */
function prune(corners: Corner[]) {
  const ends = corners.map((_, at) => at).filter((at) => corners[at].edges.size === 1);
  for (let at = ends.pop(); at !== undefined; at = ends.pop()) {
    for (const next of corners[at].edges.keys()) {
      corners[next].edges.delete(at);
      if (corners[next].edges.size === 1) ends.push(next);
    }
    corners[at].edges.clear();
  }
  return corners;
}

/** All faces: at each corner the next edge to the right is taken. */
function loopsOf(corners: Corner[]) {
  const turns = corners.map(({point, edges}) => [...edges.keys()].sort((a, b) => {
    const [p, q] = [minus(corners[a].point, point), minus(corners[b].point, point)];
    return Math.atan2(p[1], p[0]) - Math.atan2(q[1], q[0]);
  }));
  const seen = new Set();
  const step = (from: number, to: number) => from * corners.length + to;
  const loops: {points: Point[], halves: number[]}[] = [];
  corners.forEach((_, first) => {
    for (const second of turns[first]) {
      if (seen.has(step(first, second))) continue;
      const points: Point[] = [];
      const halves: number[] = [];
      let [from, to] = [first, second];
      while (!seen.has(step(from, to))) {
        seen.add(step(from, to));
        points.push(corners[from].point);
        halves.push(corners[from].edges.get(to) ?? 0);
        const around = turns[to];
        const next = around[(around.indexOf(from) - 1 + around.length) % around.length];
        [from, to] = [to, next];
      }
      loops.push({points, halves});
    }
  });
  return loops;
}

/** The loop moved inwards by half of each wall. */
function inset(points: Point[], halves: number[]) {
  const count = points.length;
  const lines = points.map((a, at) => {
    const b = points[(at + 1) % count];
    const length = distance(a, b);
    const off = [-(b[1] - a[1]) / length * halves[at], (b[0] - a[0]) / length * halves[at]];
    return [plus(a, off), plus(b, off)];
  });
  const loop = lines.map((line, at) => {
    const before = lines[(at - 1 + count) % count];
    return crossing(before[0], before[1], line[0], line[1]) ?? line[0];
  });
  return signedArea(loop) > 0 ? loop : points;
}

/** Without the corners at which nothing turns. */
function straightened(loop: Point[]) {
  const left = loop.filter((point, at) => Math.abs(side(
    loop[(at + loop.length - 1) % loop.length], loop[(at + 1) % loop.length], point)) > 1e-4);
  return left.length >= 3 ? left : loop;
}
