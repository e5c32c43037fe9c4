/** Outlines of an SVG drawing as polygons that SDF can extrude. */

/** The most corners of a drawing: more make the collision slow. */
const MOST_CORNERS = 2000;
/** Points on each curve of a path. */
const DIVISIONS = 12;

/** corners of a closed polygon */
export type Loop = [number, number][];

/**
 * The filled outlines of a drawing, scaled to a width, with the middle of the drawing at the origin
 * and y up. The largest one is the first, as SDF has it.
 * @param loops  in the drawing's units, y down
 * @param width  of the drawing, m
 * @returns m
 */
export function scaledLoops(loops: Loop[], width: number): Loop[] {
  const corners = loops.flat();
  const [xs, ys] = [0, 1].map((axis) => corners.map((corner) => corner[axis]));
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  if (!(right > left && bottom > top)) throw new Error('The drawing has no closed outline.');
  const scale = width / (right - left);
  const round = (value: number) => Math.round(value * 1e6) / 1e6;
  const scaled = loops.map((loop) => withoutRepeats(loop.map(([x, y]) =>
      [round((x - (left + right) / 2) * scale), round(((top + bottom) / 2 - y) * scale)] as [number,
      number]), 1e-4 * width))
    .filter((loop) => loop.length > 2 && Math.abs(area(loop)) > 0)
    .sort((a, b) => Math.abs(area(b)) - Math.abs(area(a)));
  const count = scaled.reduce((sum, loop) => sum + loop.length, 0);
  if (!count) throw new Error('The drawing has no closed outline.');
  if (count > MOST_CORNERS) {
    throw new Error(`The drawing has ${count} corners; at most ${MOST_CORNERS} are possible. Simplify its paths.`);
  }
  return scaled;
}

/**
 * Without corners next to the one before, and without the end that repeats the beginning.
 * @param least  distance of two corners
 */
function withoutRepeats(loop: Loop, least: number) {
  const far = (a: [number, number], b: [number, number]|undefined) =>
    !b || Math.hypot(a[0] - b[0], a[1] - b[1]) >= least;
  const kept: Loop = [];
  for (const corner of loop) if (far(corner, kept.at(-1))) kept.push(corner);
  while (kept.length > 1 && !far(kept[kept.length - 1], kept[0])) kept.pop();
  return kept;
}

/** Positive counter-clockwise with y up. */
function area(loop: Loop) {
  return loop.reduce((sum, [x, y], at) => {
    const [nextX, nextY] = loop[(at + 1) % loop.length];
    return sum + (x * nextY - nextX * y) / 2;
  }, 0);
}

/**
 * The outlines in a file: paths, rectangles, circles, ellipses and polygons, with their transforms.
 * @returns in the drawing's units, y down
 */
export async function loopsOfSvg(text: string): Promise<Loop[]> {
  const {SVGLoader} = await import('three/addons/loaders/SVGLoader.js');
  const root = new DOMParser().parseFromString(text, 'image/svg+xml').documentElement;
  if (root.nodeName !== 'svg') throw new Error('The file is not an SVG drawing.');
  const {paths} = new SVGLoader().parse(text);
  return paths.flatMap(({subPaths}) => subPaths.map((path) =>
    path.getPoints(DIVISIONS).map(({x, y}) => [x, y] as [number, number])));
}
