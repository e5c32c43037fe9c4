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
