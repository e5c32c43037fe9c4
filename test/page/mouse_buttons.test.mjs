import assert from 'node:assert/strict';
import {test} from 'node:test';
import {isDown} from '../../web/js/mouse_buttons.js';

test('a button is down as long as its bit is set', () => {
  // Left, middle and right are 0, 1, 2 as `button`, and 1, 4, 2 in `buttons`.
  assert.deepEqual([0, 1, 2].map((button) => isDown({buttons: 1}, button)), [true, false, false]);
  assert.deepEqual([0, 1, 2].map((button) => isDown({buttons: 6}, button)), [false, true, true]);
  assert.equal(isDown({buttons: 0}, 0), false);
});
