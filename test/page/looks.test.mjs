import assert from 'node:assert/strict';
import {test} from 'node:test';
import {first, FIRST_PITCHES, forward, HOME, originScale, right, up} from '../../web/js/camera_math.js';
import {groundHeight} from '../../web/js/view/ground.js';
import {nameTurns} from '../../web/js/view/orientation_cube.js';
import {near} from './near.mjs';
import {model} from './scene.mjs';

const still = [0, 0, 0.5, 0, 0, 0, 1];

test('the ground is the highest level plane of a static model', () => {
  const ground = (z, turn = [0, 0, 0, 1]) => {
    const made = model('ground', 1, [0, 0, z, ...turn]);
    made.static = true;
    made.links[0].visuals[0].geometry = {type: 'plane', normal: [0, 0, 1], size: [100, 100]};
    return made;
  };
  assert.equal(groundHeight([model('a', 1, still)]), null);
  assert.equal(groundHeight([ground(0), ground(0.3), model('a', 2, still)]), 0.3);
  assert.equal(groundHeight([ground(0, [Math.SQRT1_2, 0, 0, Math.SQRT1_2])]), null);
});

/** Where the corners of a box are in a picture, -1..1 across and upwards. */
function corners(view, {min, max}, fov, aspect) {
  const [ahead, side] = [forward(view), right(view)];
  const part = (lever, axis) => lever.reduce((sum, value, at) => sum + value * axis[at], 0);
  return [min[0], max[0]].flatMap((x) => [min[1], max[1]].flatMap((y) => [min[2], max[2]].map((z) => {
    const lever = [x, y, z].map((value, at) => value - view.position[at]);
    const depth = part(lever, ahead) * Math.tan(fov / 2);
    return [part(lever, side) / depth / aspect, part(lever, up(view)) / depth];
  })));
}

test('the first view shows all there is in its middle, from the side from which Gazebo looks', () => {
  const box = {min: [3, -2, 0], max: [9, 2, 3]};
  for (const pitch of FIRST_PITCHES) {
    for (const aspect of [1.6, 0.5]) {
      const view = first(box, 0.7, aspect, pitch);
      near([view.yaw, view.pitch], [HOME.yaw, pitch]);
      const seen = corners(view, box, 0.7, aspect);
      const [across, upwards] = [0, 1].map((axis) => seen.map((corner) => corner[axis]));
      for (const list of [across, upwards]) {
        assert.ok(Math.abs(Math.min(...list) + Math.max(...list)) < 0.05, 'as much room on both sides');
      }
      const fullest = Math.max(...across, ...upwards);
      assert.ok(fullest > 0.7 && fullest < 0.85, `${fullest}`);
    }
  }
});

test('a tiny thing is not looked at from within', () => {
  const view = first({min: [0, 0, 0], max: [0.01, 0.01, 0.01]}, 0.7, 1.6);
  assert.ok(Math.hypot(...view.position) > 0.6, `${view.position}`);
});

test('the axes at the origin are small from near and a metre long from afar', () => {
  assert.equal(originScale(20), 1);
  assert.ok(originScale(1) < 0.2);
});

test('the name on the cube\'s top is upright from wherever one looks', () => {
  assert.deepEqual(nameTurns(0), {top: 90, bottom: -90});
  assert.equal(nameTurns(Math.PI / 2).top, 0);
  assert.equal(nameTurns(Math.PI).top, -90);
});
