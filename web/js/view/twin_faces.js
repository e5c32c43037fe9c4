/**
 * Faces that a mesh file has twice, once for each side, as SketchUp writes them. Drawn from both sides
 * they would fight for the same pixels. Pure.
 */

/** Larger files are not searched: it would be felt. */
const MOST_TRIANGLES = 100000;
/** Middles nearer than this, in sizes of the whole, are one place. */
const FINE = 1e-5;

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

/** @param {number[][]} corners  @returns {number[]} */
function normalOf([a, b, c]) {
  const [u, v] = [b, c].map((corner) => corner.map((part, axis) => part - a[axis]));
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
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
  /** @param {number[][]} triangle */
  const keyOf = (triangle) => [0, 1, 2].map((axis) =>
    Math.round((triangle[0][axis] + triangle[1][axis] + triangle[2][axis]) / 3 / grid)).join();
  /** @type {Map<string, number[][]>} */
  const normals = new Map();
  for (const list of placed) {
    for (const triangle of list) {
      const key = keyOf(triangle);
      normals.set(key, [...normals.get(key) ?? [], normalOf(triangle)]);
    }
  }
  return placed.map((list) => {
    const twins = list.filter((triangle) => {
      const normal = normalOf(triangle);
      return normals.get(keyOf(triangle))?.some((other) =>
        other.reduce((sum, part, axis) => sum + part * normal[axis], 0) < 0);
    });
    return twins.length > list.length / 2;
  });
}
