import assert from 'node:assert/strict';
import {test} from 'node:test';
import {
  alongAxis, rayPlane, rotated, roundness, scaled, translated, WORLD_AXES,
} from '../../web/js/drag_math.js';
import {axisAngle, normalized, rotate, subtract} from '../../web/js/pose.js';
import {near, sameTurn} from './near.mjs';

const START = [0, 0, 0.5, 0, 0, 0, 1];
const down = (x, y) => ({origin: [x, y, 10], direction: [0, 0, -1]});
const towards = (origin, point) => ({origin, direction: normalized(subtract(point, origin))});

test('a ray meets a plane before it, none behind it or along it', () => {
  near(rayPlane(down(1, 2), [0, 0, 0], [0, 0, 1]), [1, 2, 0]);
  assert.equal(rayPlane({origin: [0, 0, 1], direction: [0, 0, 1]}, [0, 0, 0], [0, 0, 1]), null);
  assert.equal(rayPlane({origin: [0, 0, 1], direction: [1, 0, 0]}, [0, 0, 0], [0, 0, 1]), null);
});

test('a body dragged freely keeps its height and goes where the mouse is', () => {
  near(translated(START, [0.1, 0.2, 1], down(3.1, -1.8)), [3, -2, 0.5, 0, 0, 0, 1]);
});

test('along an axis only that coordinate changes', () => {
  near(translated(START, [0, 0, 1], down(3.3, 2), {axis: WORLD_AXES.x}),
    [3.3, 0, 0.5, 0, 0, 0, 1]);
  const ray = towards([5, -5, 2], [0, 0, 2.5]);
  near(translated(START, [0, 0, 0.5], ray, {axis: WORLD_AXES.z}).slice(0, 2), [0, 0]);
  assert.ok(translated(START, [0, 0, 0.5], ray, {axis: WORLD_AXES.z})[2] > 2.4);
});

test('snapping draws the position to whole metres and leaves the height', () => {
  near(translated(START, [0, 0, 1], down(2.9, 1.5), {snap: true}), [3, 1.5, 0.5, 0, 0, 0, 1]);
});

test('snapping along an axis of a turned body draws the distance to whole metres', () => {
  const axis = rotate(axisAngle([0, 0, 1], Math.PI / 6), [1, 0, 0]);
  const pose = translated(START, [0, 0, 0.5], down(2.1 * axis[0], 2.1 * axis[1]),
    {axis, snap: true});
  near(pose.slice(0, 3), [2 * axis[0], 2 * axis[1], 0.5]);
});

test('an axis that points at the eye says nothing', () => {
  assert.equal(alongAxis(down(1, 1), [0, 0, 0], [0, 0, 1]), null);
  assert.equal(translated(START, [0, 0, 1], down(3, 2), {axis: WORLD_AXES.z}), null);
});

test('a ring follows the angle of the mouse about the centre', () => {
  const pose = rotated(START, down(1, 0), down(0, 1), WORLD_AXES.z);
  near(pose.slice(0, 3), START.slice(0, 3));
  sameTurn(pose.slice(3), axisAngle([0, 0, 1], Math.PI / 2));
});

test('a snapped turn goes in steps of 45 degrees from the start', () => {
  const start = [0, 0, 0.5, ...axisAngle([0, 0, 1], 0.2)];
  const pose = rotated(start, down(1, 0), down(Math.cos(0.9), Math.sin(0.9)), WORLD_AXES.z,
    {snap: true});
  sameTurn(pose.slice(3), axisAngle([0, 0, 1], 0.2 + Math.PI / 4));
});

test('a ring seen edge-on still turns, and the right way', () => {
  const eye = [0, -5, 0.5];
  const pose = rotated(START, towards(eye, [0, 0, 0.5]), towards(eye, [0.5, 0, 0.5]),
    WORLD_AXES.z);
  assert.ok(rotate(pose.slice(3), [0, -1, 0])[0] > 0.1);
});

test('a face follows the mouse: the size grows by twice the distance', () => {
  near(scaled([1, 2, 1], 1, 0.5), [1, 1.5, 1]);
});

test('a snapped size goes to whole metres', () => {
  near(scaled([1.5, 1, 1], 0, 0.2, {snap: true}), [2 / 1.5, 1, 1]);
});

test('a sphere stays a sphere and a cylinder keeps its round', () => {
  near(scaled([1, 1, 1], 2, 0.5, {kind: 'ball'}), [2, 2, 2]);
  near(scaled([1, 1, 1], 0, 0.5, {kind: 'round'}), [2, 2, 1]);
  near(scaled([1, 1, 1], 2, 0.5, {kind: 'round'}), [1, 1, 2]);
  near(scaled([1, 1, 1], 2, 0.5, {uniform: true}), [2, 2, 2]);
});

test('nothing is scaled through zero', () => {
  assert.ok(scaled([1, 1, 1], 0, -3)[0] > 0);
});

test('what a model may be scaled to comes from all of its shapes', () => {
  const model = (...types) => ({links: [{visuals: types.map((type) => ({geometry: {type}})),
    collisions: []}]});
  assert.equal(roundness(model('box')), 'free');
  assert.equal(roundness(model('box', 'cylinder')), 'round');
  assert.equal(roundness(model('cylinder', 'sphere')), 'ball');
});
