// Rooms, outlines, snapping, and what is under the mouse.
import assert from 'node:assert/strict';
import test from 'node:test';

import {inPolygon, isSimple, labelPoint, nearest, signedArea} from '../../web/js/building/plane_geometry.js';
import {hitOf, itemsWithin, wallNear} from '../../web/js/building/hit_test.js';
import {add, emptyPlan} from '../../web/js/building/plan.js';
import {outlineOf, roomsOf} from '../../web/js/building/rooms.js';
import {snapEnd, snapFirst, snapStart} from '../../web/js/building/wall_snap.js';

const close = (found, wanted, slack = 1e-6) =>
  assert.ok(Math.abs(found - wanted) <= slack, `${found} is not ${wanted}`);

const walls = (...lines) => lines.map(([start, end, thickness = 0.2], id) => ({id, start, end, thickness}));
const ring = (corners) => corners.map((start, at) => [start, corners[(at + 1) % corners.length]]);

test('a closed room has the area between the faces of its walls', () => {
  const [room] = roomsOf(walls(...ring([[0, 0], [4, 0], [4, 3], [0, 3]])));
  close(room.area, 3.8 * 2.8);
  assert.equal(room.outline.length, 4);
});

test('walls that end in the middle of others divide a room', () => {
  const rooms = roomsOf(walls(...ring([[0, 0], [4, 0], [4, 3], [0, 3]]), [[2, 0], [2, 3]]));
  assert.equal(rooms.length, 2);
  for (const {area} of rooms) close(area, 1.8 * 2.8);
});

test('walls that cross divide a room, too', () => {
  const rooms = roomsOf(walls(...ring([[0, 0], [4, 0], [4, 4], [0, 4]]), [[2, -1], [2, 5]], [[-1, 2], [5, 2]]));
  assert.equal(rooms.length, 4);
  for (const {area} of rooms) close(area, 1.8 * 1.8);
});

test('blind walls and open chains make no room', () => {
  assert.equal(roomsOf(walls([[0, 0], [4, 0]], [[4, 0], [4, 3]], [[4, 3], [0, 3]])).length, 0);
  const [room] = roomsOf(walls(...ring([[0, 0], [4, 0], [4, 3], [0, 3]]), [[2, 0], [2, 1]]));
  close(room.area, 3.8 * 2.8);
});

test('a room within a room is taken off its area', () => {
  const rooms = roomsOf(walls(...ring([[0, 0], [8, 0], [8, 8], [0, 8]]), ...ring([[3, 3], [5, 3], [5, 5], [3, 5]])));
  const areas = rooms.map(({area}) => area).sort((a, b) => a - b);
  close(areas[0], 1.8 * 1.8);
  close(areas[1], 7.8 * 7.8 - 4);
});

test('an L-shaped room keeps its shape', () => {
  const [room] = roomsOf(walls(...ring([[0, 0], [6, 0], [6, 2], [3, 2], [3, 5], [0, 5]])));
  close(room.area, 5.8 * 1.8 + 2.8 * 3);
  assert.ok(inPolygon(labelPoint(room.outline), room.outline));
});

test('the outline of the walls is the outer one of closed walls, else their bounding box', () => {
  const shape = walls(...ring([[0, 0], [6, 0], [6, 2], [3, 2], [3, 5], [0, 5]]), [[3, 0], [3, 2]]);
  close(signedArea(outlineOf(shape)), 6 * 2 + 3 * 3);
  assert.equal(outlineOf(shape).length, 6);
  assert.deepEqual(outlineOf(walls([[0, 0], [4, 0]], [[4, 0], [4, 3]])),
    [[-0.1, -0.1], [4.1, -0.1], [4.1, 3.1], [-0.1, 3.1]]);
  assert.equal(outlineOf([]), null);
});

test('an outline is a simple one where rooms touch at a corner or are joined by a wall', () => {
  const box = (x, y) => ring([[x, y], [x + 2, y], [x + 2, y + 2], [x, y + 2]]);
  const touching = outlineOf(walls(...box(0, 0), ...box(2, 2)));
  assert.ok(isSimple(touching));
  close(signedArea(touching), 4.2 * 4.2);
  const joined = outlineOf(walls(...box(0, 0), ...box(6, 0), [[2, 1], [6, 1]]));
  assert.ok(isSimple(joined));
  close(signedArea(joined), 8.2 * 2.2);
});

test('the outline leaves out no wall', () => {
  const house = ring([[0, 0], [5, 0], [5, 5], [0, 5]]);
  const wing = ring([[10, 0], [13, 0], [13, 3], [10, 3]]);
  close(signedArea(outlineOf(walls(...house, ...wing))), 13.2 * 5.2);
  close(signedArea(outlineOf(walls(...house, [[5, 5], [8, 5]], [[8, 5], [8, 8]]))), 8.2 * 8.2);
  close(signedArea(outlineOf(walls(...house, [[1, 1], [2, 1]], [[-0.05, 3], [3, 3]]))), 25);
  const thick = {...walls([[0, 4], [9, 4]])[0], thickness: 0.6};
  close(signedArea(outlineOf([...walls([[0, 0], [0, 4]]), thick])), 9.6 * 4.4);
});

test('the end of a wall snaps to 15 degrees and, with its thickness, to 0.25 m', () => {
  const {point, on} = snapEnd([0, 0], [3.93, 0.2], {thickness: 0.15});
  assert.equal(on, 'grid');
  assert.deepEqual(point, [3.85, 0]);
  const slanted = snapEnd([1, 1], [3, 2.1], {thickness: 0.15}).point;
  close(Math.atan2(slanted[1] - 1, slanted[0] - 1), Math.PI / 6, 1e-4);
  close(Math.hypot(slanted[0] - 1, slanted[1] - 1) + 0.15, 2.5, 1e-3);
});

test('free drawing takes the point as it is', () => {
  assert.deepEqual(snapEnd([0, 0], [3.9321, 0.2], {free: true}), {point: [3.9321, 0.2], on: 'free'});
});

test('ends within 0.3 m draw the end of a wall, but never its own start', () => {
  const there = walls([[4, 3], [4, 6]], [[0, 0], [0, -2]]);
  assert.deepEqual(snapEnd([0, 0], [3.8, 2.9], {walls: there}), {point: [4, 3], on: 'end'});
  assert.equal(snapEnd([0, 0], [3.6, 2.9], {walls: there}).on, 'grid');
  assert.equal(snapEnd([0, 0], [0.2, 0.1], {walls: there}).on, 'grid');
  assert.deepEqual(snapStart([3.9, 5.8], {walls: there}), [4, 6]);
  assert.deepEqual(snapStart([3.9, 5.8], {walls: there, free: true}), [3.9, 5.8]);
});

test('a wall ends on the middle line of a wall in its way, and starts on one under the mouse', () => {
  const there = walls([[4, -5], [4, 5]]);
  assert.deepEqual(snapEnd([0, 0], [3.75, 0.1], {walls: there}), {point: [4, 0], on: 'wall'});
  assert.equal(snapEnd([0, 0], [3.6, 0.1], {walls: there}).on, 'grid');
  assert.equal(snapEnd([4, 0], [4.2, 1], {walls: there}).on, 'grid');
  assert.deepEqual(snapStart([4.08, 1.234], {walls: there}), [4, 1.234]);
  assert.deepEqual(snapStart([4.3, 1], {walls: there}), [4.3, 1]);
});

test('the first wall starts on the grid of 0.25 m, unless it starts on another wall or snapping is off', () => {
  const there = walls([[4, -5], [4, 5]]);
  assert.deepEqual(snapFirst([1.526, -2.113]), [1.5, -2]);
  assert.deepEqual(snapFirst([4.08, 1.234], {walls: there}), [4, 1.234]);
  assert.deepEqual(snapFirst([1.526, -2.113], {free: true}), [1.526, -2.113]);
});

test('polygons that cross themselves are told', () => {
  assert.equal(isSimple([[0, 0], [1, 0], [1, 1], [0, 1]]), true);
  assert.equal(isSimple([[0, 0], [1, 1], [1, 0], [0, 1]]), false);
  assert.equal(isSimple([[0, 0], [1, 0]]), false);
});

test('the nearest point of a line is within it', () => {
  assert.deepEqual(nearest([5, 1], [0, 0], [4, 0]).point, [4, 0]);
  assert.equal(nearest([1, 1], [0, 0], [4, 0]).along, 1);
});

function furnished() {
  let plan = add(emptyPlan(), 0, 'walls', {start: [0, 0], end: [4, 0]}).plan;
  plan = add(plan, 0, 'doors', {wall: 0, along: 2}).plan;
  plan = add(plan, 0, 'stairs', {position: [2, 3], yaw: Math.PI / 2}).plan;
  return add(plan, 0, 'floors', {outline: [[-1, -1], [5, -1], [5, 5], [-1, 5]]}).plan;
}

test('what lies on top is hit first', () => {
  const plan = furnished();
  const at = (x, y, options) => hitOf(plan, 0, [x, y], options)?.ref;
  assert.deepEqual(at(2.1, 0), {kind: 'doors', id: 0});
  assert.deepEqual(at(1, 0.05), {kind: 'walls', id: 0});
  assert.deepEqual(at(3.6, 3.4), {kind: 'stairs', id: 0});
  assert.deepEqual(at(2, 4.5), {kind: 'floors', id: 0});
  assert.equal(at(9, 9), undefined);
});

test('handles belong to what is selected', () => {
  const plan = furnished();
  const wall = {kind: 'walls', id: 0};
  assert.equal(hitOf(plan, 0, [4, 0], {selection: [wall]}).part, 'end');
  assert.equal(hitOf(plan, 0, [4, 0]).part, 'body');
  const stairs = {kind: 'stairs', id: 0};
  assert.equal(hitOf(plan, 0, [2 - 1.75 - 0.4, 3], {selection: [stairs]}).part, 'rotate');
});

test('an opening sticks to walls within 0.3 m', () => {
  const [level] = furnished().levels;
  assert.equal(wallNear(level, [1, 0.29]).along, 1);
  assert.equal(wallNear(level, [1, 0.31]), null);
});

test('a box drawn with the mouse selects what is whole inside it', () => {
  const [level] = furnished().levels;
  const found = itemsWithin(level, [-0.5, -0.5], [4.5, 4]).map(({kind}) => kind).sort();
  assert.deepEqual(found, ['doors', 'stairs', 'walls']);
});
