/** Terrains: the grid behind their triangles, its normals, and where textures lie. */
import assert from 'node:assert/strict';
import test from 'node:test';
import {gridOf, sharedCorners} from '../../web/js/view/terrain_grid.js';
import {near} from './near.mjs';

/** As the simulator writes them: (a, b, d) of all cells, then (a, d, c). */
function triangles(columns, rows, height, [x0, y0], [dx, dy]) {
  const point = (column, row) => [x0 + column * dx, y0 + row * dy, height(column, row)];
  const first = [];
  const second = [];
  for (let row = 0; row < rows - 1; row++) {
    for (let column = 0; column < columns - 1; column++) {
      const [a, b] = [point(column, row), point(column + 1, row)];
      const [c, d] = [point(column, row + 1), point(column + 1, row + 1)];
      first.push(...a, ...b, ...d);
      second.push(...a, ...d, ...c);
    }
  }
  return new Float32Array([...first, ...second]);
}

test('the grid is found in the triangles', () => {
  const grid = gridOf(triangles(4, 3, (column, row) => column + 10 * row, [-3, 5], [2, 0.5]));
  assert.deepEqual([grid.columns, grid.rows, grid.at, grid.step], [4, 3, [-3, 5], [2, 0.5]]);
  assert.deepEqual([...grid.heights], [0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23]);
});

test('what is no terrain is refused', () => {
  for (const corners of [new Float32Array(), new Float32Array(9), new Float32Array(18),
    triangles(3, 3, () => 0, [0, 0], [1, 1]).slice(18)]) {
    assert.equal(gridOf(corners), null);
    assert.equal(sharedCorners(corners), null);
  }
});

test('neighbours share corners, whose normals are those of the slope', () => {
  const made = sharedCorners(triangles(5, 4, (column) => 3 * column, [0, 0], [4, 1]));
  assert.deepEqual([made.position.length, made.index.length], [3 * 20, 6 * 4 * 3]);
  for (let n = 0; n < 60; n += 3) near(made.normal.slice(n, n + 3), [-0.6, 0, 0.8], 1e-6);
});

test('each cell is made of the triangles that were sent', () => {
  const sent = triangles(4, 3, (column, row) => column * column - row, [1, 2], [1, 1]);
  const made = sharedCorners(sent);
  const text = (corners) => {
    const found = [];
    for (let n = 0; n < corners.length; n += 9) found.push(Array.from(corners.slice(n, n + 9)).join());
    return found.sort();
  };
  const drawn = Array.from(made.index).flatMap((n) =>
    Array.from(made.position.slice(3 * n, 3 * n + 3)));
  assert.deepEqual(text(drawn), text(Array.from(sent)));
});

test('textures begin at the corner of least x and greatest y', () => {
  const {uv} = sharedCorners(triangles(3, 3, () => 0, [-2, -4], [2, 4]));
  const at = (n) => [...uv.slice(2 * n, 2 * n + 2)];
  assert.deepEqual([at(0), at(2), at(6), at(8)], [[0, -8], [4, -8], [0, 0], [4, 0]]);
});
