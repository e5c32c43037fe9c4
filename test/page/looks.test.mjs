import assert from 'node:assert/strict';
import {test} from 'node:test';
import {first, forward, HOME} from '../../web/js/camera_math.js';
import {groundHeight} from '../../web/js/view/ground.js';
import {tinted} from '../../web/js/view/tints.js';
import {near} from './near.mjs';
import {model} from './scene.mjs';

const still = [0, 0, 0.5, 0, 0, 0, 1];

test('a plain grey box is tinted, what somebody has painted is not', () => {
  const grey = model('a', 1, still);
  const [visual] = grey.links[0].visuals;
  const shown = tinted(grey, visual);
  assert.notDeepEqual(shown.material.diffuse, visual.material.diffuse);
  assert.equal(visual.material.diffuse[0], 0.7, 'the document keeps its grey');
  const red = {...visual, material: {...visual.material, diffuse: [1, 0, 0, 1]}};
  assert.equal(tinted(grey, red), red);
});

test('grounds, walls, robots and meshes keep their grey', () => {
  const grey = model('a', 1, still);
  const [visual] = grey.links[0].visuals;
  assert.equal(tinted({...grey, static: true}, visual), visual);
  assert.equal(tinted({...grey, links: [grey.links[0], grey.links[0]]}, visual), visual);
  assert.notEqual(tinted({...grey, links: [grey.links[0], grey.links[0]]}, visual, true), visual, 'while it is built');
  const mesh = {...visual, geometry: {type: 'mesh', uri: 'a.dae'}};
  assert.equal(tinted(grey, mesh), mesh);
});

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

test('the first view shows all there is, from the side from which Gazebo looks', () => {
  const box = {min: [3, -2, 0], max: [9, 2, 3]};
  const view = first(box, 0.7, 1.6);
  const centre = [6, 0, 1.5];
  const ahead = forward(view);
  const distance = Math.hypot(...centre.map((part, i) => part - view.position[i]));
  near(view.position.map((part, i) => part + distance * ahead[i]), centre, 1e-9);
  near([view.yaw], [HOME.yaw]);
  assert.ok(distance > 6 && distance < 20, `${distance}`);
});

test('a tiny thing is not looked at from within', () => {
  const view = first({min: [0, 0, 0], max: [0.01, 0.01, 0.01]}, 0.7, 1.6);
  assert.ok(Math.hypot(...view.position) > 0.8);
});
