import assert from 'node:assert/strict';
import {test} from 'node:test';
import {twinned} from '../../web/js/view/twin_faces.js';

const STANDS = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const SHIFTED = [...STANDS.slice(0, 12), 0, 0, 2, 1];
const front = {positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], index: null, matrix: STANDS};
const back = {...front, index: [0, 2, 1]};

test('a sign with a front and a back at one place has its faces twice', () => {
  assert.deepEqual(twinned([front, back]), [true, true]);
});

test('a face alone, one beside it and one drawn twice the same way round are no twins', () => {
  assert.deepEqual(twinned([front]), [false]);
  assert.deepEqual(twinned([front, {...back, matrix: SHIFTED}]), [false, false]);
  assert.deepEqual(twinned([front, front]), [false, false]);
});

test('the two sides need not be divided into the same triangles', () => {
  const positions = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0];
  const side = (index) => ({positions, index, matrix: STANDS});
  assert.deepEqual(twinned([side([0, 1, 2, 0, 2, 3]), side([0, 3, 1, 1, 3, 2])]), [true, true]);
});

test('a cube is seen from outside alone already and keeps both sides', () => {
  const positions = [0, 1].flatMap((x) => [0, 1].flatMap((y) => [0, 1].map((z) => [x, y, z]))).flat();
  const index = [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3];
  assert.deepEqual(twinned([{positions, index, matrix: STANDS}]), [false]);
});
