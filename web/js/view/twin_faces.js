/**
 * Faces that a mesh file has twice, once for each side, as SketchUp writes them. Drawn from both sides
 * they would fight for the same pixels. Pure.
 */

/** Larger files are not searched: it would be felt. */
const MOST_TRIANGLES = 100000;
/** Corners nearer than this, in sizes of the whole, are one place. */
const FINE = 1e-5;
/** Cosine between normals that look opposite ways. */
const OPPOSITE = -0.999;

/**
 * A mesh: coordinates, three indices a triangle or null, and the column-major matrix that places it.
 * @typedef {{positions: ArrayLike<number>, index: ArrayLike<number>|null, matrix: ArrayLike<number>}} Faces
 */

/** @param {Faces} faces */
const countOf = ({positions, index}) => Math.floor((index ? index.length : positions.length / 3) / 3);

/** @param {Faces} faces @param {number} triangle @returns {number[][]} its corners as they are placed */
function corners({positions, index, matrix}, triangle) {
  return [0, 1, 2].map((corner) => {
    const at = 3 * (index ? index[3 * triangle + corner] : 3 * triangle + corner);
    return [0, 1, 2].map((row) => matrix[row] * positions[at] + matrix[4 + row] * positions[at + 1] +
      matrix[8 + row] * positions[at + 2] + matrix[12 + row]);
  });
}

/** @param {number[][]} corners  @returns {number[]} of length 1 */
function normalOf([a, b, c]) {
  const [u, v] = [b, c].map((corner) => corner.map((part, axis) => part - a[axis]));
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.hypot(...normal) || 1;
  return normal.map((part) => part / length);
}

/**
 * Which parts of a file have most of their faces twice.
 * @param {Faces[]} parts
 * @returns {boolean[]}
 */
export function twinned(parts) {
  if (parts.reduce((sum, part) => sum + countOf(part), 0) > MOST_TRIANGLES) return parts.map(() => false);
  const placed = parts.map((part) => Array.from({length: countOf(part)}, (_, at) => corners(part, at)));
  let largest = 0;
  for (const list of placed) {
    for (const triangle of list) {
      for (const corner of triangle) largest = Math.max(largest, ...corner.map(Math.abs));
    }
  }
  const grid = largest * FINE || 1;
  /** @param {number[]} corner */
  const keyOf = (corner) => corner.map((part) => Math.round(part / grid)).join();
  // By corners: the two sides need not be divided into the same triangles.
  /** @type {Map<string, number[][]>} */
  const normals = new Map();
  for (const triangle of placed.flat()) {
    const normal = normalOf(triangle);
    for (const corner of triangle) {
      const key = keyOf(corner);
      const known = normals.get(key);
      if (known) known.push(normal);
      else normals.set(key, [normal]);
    }
  }
  return placed.map((list) => {
    const twins = list.filter((triangle) => {
      const normal = normalOf(triangle);
      return triangle.every((corner) => normals.get(keyOf(corner))?.some((other) =>
        other.reduce((sum, part, axis) => sum + part * normal[axis], 0) < OPPOSITE));
    });
    return twins.length > list.length / 2;
  });
}
