import assert from 'node:assert/strict';
import {test} from 'node:test';
import {alignMoves} from '../../web/js/align.js';
import {centroid, normal, snapped} from '../../web/js/face_math.js';
import {equivalentBox, principal} from '../../web/js/inertia_math.js';
import {newLight, shapeModel} from '../../web/js/new_entities.js';
import {axisAngle, transform} from '../../web/js/pose.js';
import {near} from './near.mjs';

const box = (name, x, size) => ({name, pose: [x, 0, 0.5, 0, 0, 0, 1],
  min: [x - size / 2, -0.5, 0], max: [x + size / 2, 0.5, 1]});

test('aligning puts edges on the edge of the first selected', () => {
  const moves = alignMoves([box('a', 0, 1), box('b', 3, 2)], {axis: 'x', at: 'min'});
  assert.deepEqual(Object.keys(moves), ['b']);
  near(moves.b, [0.5, 0, 0.5, 0, 0, 0, 1]);
});

test('aligning in reverse puts a box beside the target', () => {
  const moves = alignMoves([box('a', 0, 1), box('b', 3, 2)],
    {axis: 'x', at: 'max', reverse: true});
  near(moves.b.slice(0, 1), [1.5]);
});

test('aligning to the last moves the others, and what is aligned stays out', () => {
  const moves = alignMoves([box('a', 0, 1), box('b', 3, 1), box('c', 3, 1)],
    {axis: 'x', at: 'center', relative: 'last'});
  assert.deepEqual(Object.keys(moves), ['a']);
  assert.deepEqual(alignMoves([box('a', 0, 1)], {axis: 'x', at: 'min'}), {});
});

test('a face laid on another meets it back to back', () => {
  const pose = [4, 1, 0.5, ...axisAngle([0, 0, 1], 0.7)];
  const local = {corners: [[0.5, -0.5, -0.5], [0.5, 0.5, -0.5], [0.5, 0.5, 0.5]]};
  const from = {corners: local.corners.map((corner) => transform(pose, corner))};
  const onto = {corners: [[0, 0, 1], [1, 0, 1], [0, 1, 1]]};
  const moved = snapped(pose, from, onto);
  const after = {corners: local.corners.map((corner) => transform(moved, corner))};
  near(centroid(after), centroid(onto));
  near(normal(after), [0, 0, -1]);
});

test('a box has its own size as the box of its inertia', () => {
  const [x, y, z] = [2, 1, 0.5];
  const mass = 3;
  const made = equivalentBox({mass, ixx: mass / 12 * (y * y + z * z), ixy: 0, ixz: 0,
    iyy: mass / 12 * (x * x + z * z), iyz: 0, izz: mass / 12 * (x * x + y * y)});
  near(made.size, [x, y, z]);
  assert.equal(equivalentBox({mass: 0, ixx: 1, ixy: 0, ixz: 0, iyy: 1, iyz: 0, izz: 1}), null);
});

test('principal axes make the matrix again, and are right-handed', () => {
  const matrix = [[2, 0.3, -0.4], [0.3, 3, 0.5], [-0.4, 0.5, 4]];
  const {values, vectors} = principal(matrix);
  for (const [i, row] of matrix.entries()) {
    near(row.map((_, j) => values.reduce((sum, value, k) =>
      sum + value * vectors[k][i] * vectors[k][j], 0)), row);
  }
  const [a, b, c] = vectors;
  const triple = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
    a[2] * (b[0] * c[1] - b[1] * c[0]);
  assert.ok(Math.abs(triple - 1) < 1e-9);
});

test('shapes stand on the ground with unit sizes', () => {
  assert.equal(shapeModel('box').pose[2], 0.5);
  assert.equal(shapeModel('sphere').links[0].visuals[0].geometry.radius, 0.5);
});

test('a new light has a name of its own', () => {
  assert.equal(newLight('spot', []).name, 'user_spot_light_0');
  assert.equal(newLight('spot', ['user_spot_light_0']).name, 'user_spot_light_1');
  assert.equal(newLight('directional', []).cast_shadows, true);
});
