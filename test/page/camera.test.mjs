import assert from 'node:assert/strict';
import {test} from 'node:test';
import * as camera from '../../web/js/camera_math.js';
import {add, fromRpy, length, normalized, rotate, scale, subtract} from '../../web/js/pose.js';
import {near} from './near.mjs';

const WIDTH = 1600;
const HEIGHT = 900;
const FOV = camera.verticalFov(WIDTH / HEIGHT);

/** Where a point is in the picture, px from the middle; y down. */
function pixel(view, point) {
  const lever = subtract(point, view.position);
  const part = (axis) => axis.reduce((sum, value, i) => sum + value * lever[i], 0);
  const depth = part(camera.forward(view));
  const focal = HEIGHT / 2 / Math.tan(FOV / 2);
  return [part(camera.right(view)) / depth * focal, -part(camera.up(view)) / depth * focal];
}

test('the first view looks at the origin from 5 -5 2', () => {
  near(camera.HOME.position, [5, -5, 2]);
  near(pixel(camera.HOME, [0, 0, 0]), [0, 0], 1e-6);
});

test('the picture is 60 degrees wide whatever its shape', () => {
  for (const aspect of [1, 16 / 9, 0.7]) {
    const half = Math.tan(camera.verticalFov(aspect) / 2) * aspect;
    assert.ok(Math.abs(2 * Math.atan(half) - Math.PI / 3) < 1e-12);
  }
});

test('panning keeps the point under the mouse', () => {
  const point = [1, 0.5, 0.2];
  const before = pixel(camera.HOME, point);
  const unit = camera.metresPerPixel(camera.HOME, point, FOV, HEIGHT);
  const after = pixel(camera.pan(camera.HOME, 30, -20, unit), point);
  near(after, [before[0] + 30, before[1] - 20], 1e-6);
});

test('panning with an axis held goes along it alone', () => {
  const moved = camera.pan(camera.HOME, 100, 40, 0.01, 'y');
  near(subtract(moved.position, camera.HOME.position).filter((_, i) => i !== 1), [0, 0]);
  assert.notEqual(moved.position[1], camera.HOME.position[1]);
});

test('orbiting keeps the pivot in its place in the picture, and the distance', () => {
  const pivot = [1, 0, 0.5];
  const before = pixel(camera.HOME, pivot);
  const view = camera.orbit(camera.HOME, pivot, 120, -35);
  near(pixel(view, pivot), before, 1e-6);
  assert.ok(Math.abs(length(subtract(view.position, pivot)) -
    length(subtract(camera.HOME.position, pivot))) < 1e-9);
});

test('orbiting turns 0.004 rad for each pixel', () => {
  const view = camera.orbit(camera.HOME, [0, 0, 0], 100, 0);
  assert.ok(Math.abs(view.yaw - camera.HOME.yaw + 0.4) < 1e-12);
  assert.equal(view.pitch, camera.HOME.pitch);
});

test('orbiting with a key held is yaw or pitch alone', () => {
  assert.equal(camera.orbit(camera.HOME, [0, 0, 0], 50, 60, 'yaw').pitch, camera.HOME.pitch);
  assert.equal(camera.orbit(camera.HOME, [0, 0, 0], 50, 60, 'pitch').yaw, camera.HOME.yaw);
});

test('the camera never goes over the top', () => {
  const view = camera.orbit(camera.HOME, [0, 0, 0], 0, 100000);
  assert.ok(view.pitch > -Math.PI / 2);
  assert.ok(camera.up(view)[2] > 0);
});

test('zooming goes towards the point under the mouse and stops before it', () => {
  const point = [1, 1, 0];
  const before = pixel(camera.HOME, point);
  const view = camera.zoom(camera.HOME, point, 0.5);
  near(pixel(view, point), before, 1e-6);
  assert.ok(length(subtract(camera.zoom(camera.HOME, point, 0).position, point)) > 0.01);
});

test('the view of a camera pose looks along its x', () => {
  const view = {position: [1, 2, 3], yaw: 2.5, pitch: -0.6};
  const pose = [...view.position, ...fromRpy(0, -view.pitch, view.yaw)];
  near(rotate(pose.slice(3), [1, 0, 0]), camera.forward(view));
  const back = camera.fromPose(pose);
  near([...back.position, back.yaw, back.pitch], [1, 2, 3, 2.5, -0.6]);
});

test('views from the sides look at the centre from as far as before', () => {
  const centre = [1, 2, 0];
  const distance = length(subtract(camera.HOME.position, centre));
  for (const side of ['top', 'bottom', 'front', 'back', 'left', 'right']) {
    const view = camera.fromSide(camera.HOME, side, centre);
    near(add(view.position, scale(camera.forward(view), distance)), centre, 1e-2);
  }
  near(normalized(camera.forward(camera.fromSide(camera.HOME, 'top', centre))), [0, 0, -1], 1e-3);
});

test('framing shows the whole box', () => {
  const box = {min: [4, 4, 0], max: [8, 5, 3]};
  const view = camera.framing(camera.HOME, box, FOV, WIDTH / HEIGHT);
  for (const x of [4, 8]) {
    for (const y of [4, 5]) {
      for (const z of [0, 3]) {
        const [across, along] = pixel(view, [x, y, z]);
        assert.ok(Math.abs(across) <= WIDTH / 2 && Math.abs(along) <= HEIGHT / 2);
      }
    }
  }
});

test('framing looks from the same direction, so that the horizon stays after Top', () => {
  const box = {min: [4, 4, 0], max: [8, 5, 3]};
  const top = camera.fromSide(camera.HOME, 'top', [0, 0, 0]);
  const view = camera.framing(top, box, FOV, WIDTH / HEIGHT);
  assert.equal(view.yaw, top.yaw);
  near(camera.forward(view), camera.forward(top));
});

test('a flight takes the shorter way round', () => {
  const from = {position: [0, 0, 0], yaw: 3, pitch: 0};
  const to = {position: [1, 0, 0], yaw: -3, pitch: 0.5};
  assert.ok(camera.between(from, to, 0.5).yaw > 3);
  near(camera.between(from, to, 1).position, [1, 0, 0]);
  near(camera.between(from, to, 0).position, [0, 0, 0]);
});
