/**
 * Meshes with fewer triangles, for browsers that draw without a graphics card. Corners in one cell of
 * a grid become one corner (vertex clustering: Rossignac and Borrel, 1993). Pure.
 */
/**
 * Triangles of all meshes of a world together, and how many a mesh keeps at least and at most: in
 * pictures at rest, and in those of a moving scene, in which a processor draws a thousand in a millisecond or two.
 */
const REST = {budget: 120000, least: 600, most: 80000};
const MOVING = {budget: 24000, least: 120, most: 20000};
/** Cells along the longest side at most: the grid takes 4 bytes for each cell. */
const MOST_CELLS = 128;
/** Cosine of the angle up to which a corner has the normal of its cell, so that curves look round. */
const ROUND = 0.6;

/** The most triangles of a mesh in a world of so many files. */
export const limitFor = (files: number, {moving = false}: {moving?: boolean} = {}) => {
  const {budget, least, most} = moving ? MOVING : REST;
  return Math.min(most, Math.max(least, Math.round(budget / Math.max(files, 1))));
};

/**
 * Three numbers for each corner; three corners for each triangle. `closed`: its triangles surround a volume and
 * face outwards, so that none is seen from behind.
 */
export type Shape = {position: Float32Array, normal: Float32Array, index: Uint32Array, closed: boolean};

/**
 * A mesh of about `limit` triangles at most; null if the mesh has at most `limit`.
 * @param position  three numbers for each corner
 * @param normal  as many
 * @param index  of the corners of the triangles; null: three corners each
 */
export function coarse(position: ArrayLike<number>, normal: ArrayLike<number>,
    index: ArrayLike<number>|null, limit: number): Shape|null {
  if ((index ?? position).length / (index ? 3 : 9) <= limit) return null;
  let cells = Math.min(MOST_CELLS, Math.max(4, Math.round(Math.sqrt(limit / 6))));
  for (;;) {
    const {shape, cornerOf, middle} = clustered(position, normal, index, cells);
    const count = shape.index.length / 3;
    if (count <= 1.2 * limit || cells <= 4) return {...shape, closed: isClosed(cornerOf, index, middle)};
    cells = Math.max(4, Math.min(cells - 1, Math.floor(cells * Math.sqrt(limit / count))));
  }
}

/**
 * Triangles between the middles of the corners in each cell; those within one cell or two go.
 * @param cells  along the longest side
 */
function clustered(position: ArrayLike<number>, normal: ArrayLike<number>,
    index: ArrayLike<number>|null, cells: number) {
  const {low, high} = bounds(position);
  const size = Math.max(high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-12) / (cells - 0.001);
  const [across, deep] = [0, 1].map((axis) => Math.floor((high[axis] - low[axis]) / size) + 1);
  const tall = Math.floor((high[2] - low[2]) / size) + 1;
  const cellOf = new Int32Array(across * deep * tall);
  const cornerOf = new Int32Array(position.length / 3);
  let found = 0;
  const [x0, y0, z0] = low;
  for (let corner = 0, at = 0; corner < cornerOf.length; corner += 1, at += 3) {
    const cell = ((position[at] - x0) / size | 0) +
      across * (((position[at + 1] - y0) / size | 0) + deep * ((position[at + 2] - z0) / size | 0));
    let place = cellOf[cell];
    if (!place) cellOf[cell] = place = found += 1;
    cornerOf[corner] = place - 1;
  }
  const middle = new Float64Array(3 * found);
  const facing = new Float64Array(3 * found);
  const members = new Uint32Array(found);
  for (let corner = 0, at = 0; corner < cornerOf.length; corner += 1, at += 3) {
    const to = 3 * cornerOf[corner];
    members[cornerOf[corner]] += 1;
    middle[to] += position[at];
    middle[to + 1] += position[at + 1];
    middle[to + 2] += position[at + 2];
    facing[to] += normal[at];
    facing[to + 1] += normal[at + 1];
    facing[to + 2] += normal[at + 2];
  }
  for (let at = 0; at < middle.length; at += 1) middle[at] /= members[Math.floor(at / 3)];
  return {shape: triangles(cornerOf, index, middle, facing), cornerOf, middle};
}

function bounds(position: ArrayLike<number>) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let axis = 0; axis < 3; axis += 1) {
    let [least, most] = [Infinity, -Infinity];
    for (let at = axis; at < position.length; at += 3) {
      const value = position[at];
      if (value < least) least = value;
      if (value > most) most = value;
    }
    [low[axis], high[axis]] = [least, most];
  }
  return {low, high};
}

/**
 * @param cornerOf  place in `middle` of each corner of the file
 * @param facing  sums of the normals
 */
function triangles(cornerOf: Int32Array, index: ArrayLike<number>|null, middle: Float64Array,
    facing: Float64Array) {
  const count = (index ?? cornerOf).length / 3;
  const kept: number[] = [];
  const seen = new Set();
  const cells = middle.length / 3;
  for (let triangle = 0; triangle < count; triangle += 1) {
    const at = 3 * triangle;
    const a = cornerOf[index ? index[at] : at];
    const b = cornerOf[index ? index[at + 1] : at + 1];
    const c = cornerOf[index ? index[at + 2] : at + 2];
    if (a === b || b === c || c === a) continue;
    // Many triangles become the same one; the other side of a thin wall has another order of corners.
    const key = a < b && a < c ? (a * cells + b) * cells + c
      : b < c ? (b * cells + c) * cells + a : (c * cells + a) * cells + b;
    if (seen.has(key)) continue;
    seen.add(key);
    kept.push(a, b, c);
  }
  return withSharedCorners(kept, middle, facing);
}

/**
 * Whether triangles surround a volume and face outwards. Each edge is then passed as often in one direction as in
 * the other. Only a sum of hashes is kept of the edges, which is 0 then, and else with a probability of 2^-32.
 * @param cornerOf  place in `middle` of each corner of the file
 */
function isClosed(cornerOf: Int32Array, index: ArrayLike<number>|null, middle: Float64Array) {
  const count = (index ?? cornerOf).length;
  const [x0, y0, z0] = middle;
  let [edges, volume, sizes] = [0, 0, 0];
  for (let at = 0; at < count; at += 3) {
    const a = cornerOf[index ? index[at] : at];
    const b = cornerOf[index ? index[at + 1] : at + 1];
    const c = cornerOf[index ? index[at + 2] : at + 2];
    if (a === b || b === c || c === a) continue;
    edges = (edges + edgeHash(a, b) + edgeHash(b, c) + edgeHash(c, a)) | 0;
    const [i, j, k] = [3 * a, 3 * b, 3 * c];
    const [bx, by, bz] = [middle[j] - x0, middle[j + 1] - y0, middle[j + 2] - z0];
    const [cx, cy, cz] = [middle[k] - x0, middle[k + 1] - y0, middle[k + 2] - z0];
    const part = (middle[i] - x0) * (by * cz - bz * cy) + (middle[i + 1] - y0) * (bz * cx - bx * cz) +
      (middle[i + 2] - z0) * (bx * cy - by * cx);
    volume += part;
    sizes += Math.abs(part);
  }
  // A sheet with two sides has no volume, but for errors of rounding.
  return edges === 0 && volume > 1e-6 * sizes;
}

/** A number for an edge, negative in the other direction. */
function edgeHash(from: number, to: number) {
  const hash = Math.imul(Math.min(from, to), 0x9e3779b1) ^ Math.imul(Math.max(from, to) + 1, 0x85ebca6b);
  const mixed = Math.imul(hash ^ hash >>> 15, 0x2c1b3c6d);
  return from < to ? mixed ^ mixed >>> 13 : -(mixed ^ mixed >>> 13);
}

/**
 * Corners of curved surfaces are shared by their triangles: a processor that draws computes each once.
 * Corners at edges belong to one triangle, with its normal.
 * @param kept  places in `middle`, three for each triangle
 */
function withSharedCorners(kept: number[], middle: Float64Array, facing: Float64Array): Omit<Shape, 'closed'> {
  const cells = middle.length / 3;
  const mean = new Float32Array(facing.length);
  for (let at = 0; at < facing.length; at += 3) writeUnit(mean, at, facing[at], facing[at + 1], facing[at + 2]);
  const sharedAt = new Int32Array(cells).fill(-1);
  const index = new Uint32Array(kept.length);
  const position: number[] = [];
  const normal: number[] = [];
  const flat = [0, 0, 0];
  for (let at = 0; at < kept.length; at += 3) {
    const [a, b, c] = [3 * kept[at], 3 * kept[at + 1], 3 * kept[at + 2]];
    const [ux, uy, uz] = [middle[b] - middle[a], middle[b + 1] - middle[a + 1], middle[b + 2] - middle[a + 2]];
    const [vx, vy, vz] = [middle[c] - middle[a], middle[c + 1] - middle[a + 1], middle[c + 2] - middle[a + 2]];
    writeUnit(flat, 0, uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    for (let corner = at; corner < at + 3; corner += 1) {
      const cell = 3 * kept[corner];
      const isRound = mean[cell] * flat[0] + mean[cell + 1] * flat[1] + mean[cell + 2] * flat[2] > ROUND;
      if (isRound && sharedAt[kept[corner]] >= 0) {
        index[corner] = sharedAt[kept[corner]];
        continue;
      }
      index[corner] = position.length / 3;
      position.push(middle[cell], middle[cell + 1], middle[cell + 2]);
      if (isRound) {
        sharedAt[kept[corner]] = index[corner];
        normal.push(mean[cell], mean[cell + 1], mean[cell + 2]);
      } else normal.push(flat[0], flat[1], flat[2]);
    }
  }
  return {position: Float32Array.from(position), normal: Float32Array.from(normal), index};
}

/** Write a vector of length 1 at a place; zeros stay. */
function writeUnit(into: {[index: number]: number}, at: number, x: number, y: number, z: number) {
  const size = Math.sqrt(x * x + y * y + z * z) || 1;
  into[at] = x / size;
  into[at + 1] = y / size;
  into[at + 2] = z / size;
}
