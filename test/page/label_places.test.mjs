import assert from 'node:assert/strict';
import {test} from 'node:test';
import {spread} from '../../web/js/building/label_places.js';
import {hullOf} from '../../web/js/convex_hull.js';

const SIZE = 10;

test('labels at one place end up one above the other', () => {
  const placed = spread([0, 1, 2].map((at) => ({x: 0, y: 0, text: `${at}.00 m`})), SIZE);
  assert.equal(placed[0].y, 0);
  const heights = placed.map(({y}) => y).sort((a, b) => a - b);
  assert.ok(heights[1] - heights[0] >= 1.25 * SIZE && heights[2] - heights[1] >= 1.25 * SIZE);
});

test('labels that are apart stay where they are', () => {
  const labels = [{x: 0, y: 0, text: '1 m'}, {x: 200, y: 0, text: '2 m'}, {x: 0, y: 40, text: '3 m'}];
  assert.deepEqual(spread(labels, SIZE), labels);
});

test('the outline of points in the plane is their hull', () => {
  const hull = hullOf([[0, 0], [2, 0], [1, 0.5], [2, 2], [0, 2], [1, 1], [0, 0]]);
  assert.deepEqual(hull, [[0, 0], [2, 0], [2, 2], [0, 2]]);
});
