/** Points, lines and polygons in the plane: metres, y up, angles in radians. */

/** x and y in m. */
export type Point = number[];

export const distance = (a: Point, b: Point) => Math.hypot(b[0] - a[0], b[1] - a[1]);
export const direction = (a: Point, b: Point) => Math.atan2(b[1] - a[1], b[0] - a[0]);
export const plus = (a: Point, b: Point) => [a[0] + b[0], a[1] + b[1]];
export const minus = (a: Point, b: Point) => [a[0] - b[0], a[1] - b[1]];
export const polar = (from: Point, angle: number, length: number) =>
  [from[0] + Math.cos(angle) * length, from[1] + Math.sin(angle) * length];

/** To a tenth of a millimetre, so that what is typed stays what it is. */
export const tidy = (value: number) => Math.round(value * 1e4) / 1e4 + 0;
export const tidyPoint = ([x, y]: Point) => [tidy(x), tidy(y)];

/** Two points that are one; ends of walls this close are linked. */
export const same = (a: Point, b: Point) =>
    Math.abs(a[0] - b[0]) < 1e-4 && Math.abs(a[1] - b[1]) < 1e-4;

/** A point turned about the origin. */
export function turned([x, y]: Point, angle: number): Point {
  const cos = Math.cos(angle);
  const sin = Math.sin(angle);
  return [cos * x - sin * y, sin * x + cos * y];
}

/** A point of the plane in axes that stand at `origin`, turned by `angle`. */
export const toLocal = (point: Point, origin: Point, angle: number) => turned(minus(point, origin),
    -angle);
export const fromLocal = (point: Point, origin: Point, angle: number) => plus(turned(point, angle),
    origin);

/**
 * The nearest point of a line from a to b.
 * @returns `along` from a, within the line
 */
export function nearest(point: Point, a: Point, b: Point): {along: number, distance: number,
    point: Point} {
  const length = distance(a, b);
  if (length < 1e-9) return {along: 0, distance: distance(point, a), point: a};
  const t = ((point[0] - a[0]) * (b[0] - a[0]) + (point[1] - a[1]) * (b[1] - a[1])) / length;
  const along = Math.min(Math.max(t, 0), length);
  const foot = [a[0] + (b[0] - a[0]) * along / length, a[1] + (b[1] - a[1]) * along / length];
  return {along, distance: distance(point, foot), point: foot};
}

/** On which side of the line a-b a point lies: metres, above 0 on the left. */
export function side(a: Point, b: Point, point: Point) {
  const length = distance(a, b);
  return ((b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])) / (length || 1);
}

/** Where two endless lines meet, null for parallel ones. */
export function crossing(a: Point, b: Point, c: Point, d: Point) {
  const rx = b[0] - a[0];
  const ry = b[1] - a[1];
  const sx = d[0] - c[0];
  const sy = d[1] - c[1];
  const by = rx * sy - ry * sx;
  if (Math.abs(by) < 1e-12) return null;
  const t = ((c[0] - a[0]) * sy - (c[1] - a[1]) * sx) / by;
  return [a[0] + rx * t, a[1] + ry * t];
}

/** The area in a loop, above 0 where it runs counter-clockwise. */
export function signedArea(loop: Point[]) {
  let sum = 0;
  for (let at = 0; at < loop.length; at++) {
    const [x, y] = loop[at];
    const [nextX, nextY] = loop[(at + 1) % loop.length];
    sum += x * nextY - nextX * y;
  }
  return sum / 2;
}

export function inPolygon([x, y]: Point, loop: Point[]) {
  let inside = false;
  for (let at = 0, before = loop.length - 1; at < loop.length; before = at++) {
    const [ax, ay] = loop[at];
    const [bx, by] = loop[before];
    if ((ay > y) !== (by > y) && x < (bx - ax) * (y - ay) / (by - ay) + ax) inside = !inside;
  }
  return inside;
}

/** A point well inside a polygon, where a label can stand. */
export function labelPoint(loop: Point[]) {
  const area = signedArea(loop);
  let x = 0;
  let y = 0;
  for (let at = 0; at < loop.length; at++) {
    const a = loop[at];
    const b = loop[(at + 1) % loop.length];
    const weight = a[0] * b[1] - b[0] * a[1];
    x += (a[0] + b[0]) * weight;
    y += (a[1] + b[1]) * weight;
  }
  const centre = [x / (6 * area), y / (6 * area)];
  if (inPolygon(centre, loop)) return centre;
  // The middle of the longest stretch of a level line through the polygon.
  const ys = loop.map((point) => point[1]).sort((p, q) => p - q);
  const level = (ys[0] + ys[ys.length - 1]) / 2 + 1e-7;
  const hits = [];
  for (let at = 0; at < loop.length; at++) {
    const a = loop[at];
    const b = loop[(at + 1) % loop.length];
    if ((a[1] > level) !== (b[1] > level)) {
      hits.push(a[0] + (b[0] - a[0]) * (level - a[1]) / (b[1] - a[1]));
    }
  }
  hits.sort((p, q) => p - q);
  let best = [hits[0], hits[1]];
  for (let at = 0; at + 1 < hits.length; at += 2) {
    if (hits[at + 1] - hits[at] > best[1] - best[0]) best = [hits[at], hits[at + 1]];
  }
  return [(best[0] + best[1]) / 2, level];
}

/** True when no two edges of a loop cross or touch, besides neighbours. */
export function isSimple(loop: Point[]) {
  const count = loop.length;
  if (count < 3 || Math.abs(signedArea(loop)) < 1e-4) return false;
  for (let i = 0; i < count; i++) {
    for (let j = i + 1; j < count; j++) {
      if (j === i + 1 || (i === 0 && j === count - 1)) continue;
      if (segmentsMeet(loop[i], loop[(i + 1) % count], loop[j], loop[(j + 1) % count])) {
        return false;
      }
    }
  }
  return true;
}

function segmentsMeet(a: Point, b: Point, c: Point, d: Point) {
  const between = (p: Point, q: Point, r: Point) => Math.sign(side(p, q, r));
  return between(a, b, c) * between(a, b, d) <= 0 && between(c, d, a) * between(c, d, b) <= 0;
}
