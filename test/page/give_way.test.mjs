/** Slow pictures wait for what a hand does beside them, and not for ever. */
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {GiveWay} from '../../web/js/view/give_way.js';

test('slow pictures wait for a press beside the view', () => {
  const way = new GiveWay();
  way.pictured(140, 1000);
  assert.equal(way.waits(1001), false);
  way.hand('press', 1010);
  assert.deepEqual([1011, 1150, 1211].map((now) => way.waits(now)), [true, true, false]);
});

test('a movement is waited for shorter than a press, and takes nothing from it', () => {
  const way = new GiveWay();
  way.pictured(140, 1000);
  way.hand('press', 1000);
  way.hand('move', 1010);
  assert.deepEqual([way.waits(1199), way.waits(1201)], [true, false]);
});

test('a hand that rests on what it will press is waited for', () => {
  const way = new GiveWay();
  way.pictured(140, 1000);
  way.hand('move', 1000);
  assert.deepEqual([way.waits(1150), way.waits(1170)], [true, false]);
});

test('quick pictures wait for nobody', () => {
  const way = new GiveWay();
  way.pictured(12, 1000);
  way.hand('press', 1010);
  assert.equal(way.waits(1011), false);
});

test('a hand that never rests does not stop the pictures', () => {
  const way = new GiveWay();
  way.pictured(140, 1000);
  for (let now = 1000; now < 1500; now += 20) way.hand('move', now);
  assert.deepEqual([way.waits(1390), way.waits(1401)], [true, false]);
});
