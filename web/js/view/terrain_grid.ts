/**
 * Terrains as the simulator sends them, made into a grid: neighbours share their corners, so that the
 * light goes over smoothly from one to the next, and a sixth of the memory is enough.
 */

/** Corners in a triangle list, x y z each. */
type Corners = Float32Array;

/**
 * The grid behind a terrain's triangles: (a, b, d) of each cell row by row, then (a, d, c); a, b are
 * neighbours along x, a, c along y. Source: formats/mesh/terrain.py.
 * @returns heights row by row from the least x and y, `at`; null for triangles that form no grid
 */
export function gridOf(corners: Corners): {columns: number, rows: number, heights: Float32Array,
    at: number[], step: number[]}|null {
  const cells = corners.length / 18;
  if (cells < 1 || !Number.isInteger(cells)) return null;
  const at = [corners[0], corners[1]];
  const last = corners.length / 2 - 3;
  const step = [corners[3] - corners[0], corners[7] - corners[1]];
  const columns = Math.round((corners[last] - at[0]) / step[0]) + 1;
  const rows = Math.round((corners[last + 1] - at[1]) / step[1]) + 1;
  if (!(step[0] > 0 && step[1] > 0) || (columns - 1) * (rows - 1) !== cells) return null;
  const heights = new Float32Array(columns * rows);
  for (let n = 0; n < corners.length; n += 3) {
    const column = Math.round((corners[n] - at[0]) / step[0]);
    const row = Math.round((corners[n + 1] - at[1]) / step[1]);
    heights[row * columns + column] = corners[n + 2];
  }
  return {columns, rows, heights, at, step};
}

/**
 * Corners that cells share, their normals, and for textures: `uv` in metres from the corner of least x
 * and greatest y.
 * @param corners  of triangles as the simulator sends them
 * @returns null for triangles that are no terrain's
 */
export function sharedCorners(corners: Corners): {position: Float32Array, normal: Float32Array,
    uv: Float32Array, index: Uint32Array}|null {
  const grid = gridOf(corners);
  if (!grid) return null;
  const {columns, rows, heights, at, step} = grid;
  const count = columns * rows;
  const position = new Float32Array(3 * count);
  const normal = new Float32Array(3 * count);
  const uv = new Float32Array(2 * count);
  for (let row = 0, n = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++, n++) {
      const x = column * step[0];
      const y = row * step[1];
      position.set([at[0] + x, at[1] + y, heights[n]], 3 * n);
      uv.set([x, y - (rows - 1) * step[1]], 2 * n);
      const west = column ? 1 : 0;
      const east = column < columns - 1 ? 1 : 0;
      const south = row ? 1 : 0;
      const north = row < rows - 1 ? 1 : 0;
      const alongX = (heights[n + east] - heights[n - west]) / ((west + east) * step[0]);
      const alongY = (heights[n + north * columns] - heights[n - south * columns]) /
        ((south + north) * step[1]);
      const length = Math.hypot(alongX, alongY, 1);
      normal.set([-alongX / length, -alongY / length, 1 / length], 3 * n);
    }
  }
  return {position, normal, uv, index: triangles(columns, rows)};
}

function triangles(columns: number, rows: number) {
  const index = new Uint32Array(6 * (columns - 1) * (rows - 1));
  for (let row = 0, n = 0; row < rows - 1; row++) {
    for (let column = 0; column < columns - 1; column++, n += 6) {
      const a = row * columns + column;
      index.set([a, a + 1, a + columns + 1, a, a + columns + 1, a + columns], n);
    }
  }
  return index;
}
