import assert from 'node:assert/strict';
import {test} from 'node:test';
import {magnetic, SMALLEST_SIZE, snapSize, snapTurn} from '../../web/js/drag_snap.js';

test('a value within 40 % of a whole metre sticks to it', () => {
  assert.equal(magnetic(2.39), 2);
  assert.equal(magnetic(1.61), 2);
  assert.equal(magnetic(-0.4), 0);
});

test('a value half-way between two metres is left alone', () => {
  assert.equal(magnetic(2.5), 2.5);
  assert.equal(magnetic(-1.45), -1.45);
});

test('a turn goes to the nearest 45 degrees', () => {
  assert.equal(snapTurn(0.3), 0);
  assert.equal(snapTurn(0.5), Math.PI / 4);
  assert.equal(snapTurn(-3), -Math.PI);
});

test('a size sticks to whole metres but never to nothing', () => {
  assert.equal(snapSize(1.2), 1);
  assert.equal(snapSize(0.2), SMALLEST_SIZE);
  assert.equal(snapSize(0.5), 0.5);
});
