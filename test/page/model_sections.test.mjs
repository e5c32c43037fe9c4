import assert from 'node:assert/strict';
import {test} from 'node:test';
import {bodySections, sharedSections} from '../../web/js/panels/model_sections.js';
import {near} from './near.mjs';

const RED = [1, 0, 0, 1];

/** A model with one box, as the simulator sends it. */
function box(name, {x = 0, mass = 2, mu = 1, size = [1, 1, 1], color = RED, still = false} = {}) {
  const material = {ambient: color, diffuse: color};
  return {
    name, pose: [x, 0, 0.5, 0, 0, 0, 1], static: still, self_collide: false, enable_wind: false,
    links: [{
      id: 1, name: 'link', pose: [0, 0, 0, 0, 0, 0, 1],
      inertial: {mass, pose: [0, 0, 0, 0, 0, 0, 1], ixx: mass, ixy: 0, ixz: 0, iyy: mass, iyz: 0,
        izz: mass},
      collisions: [{name: 'c', geometry: {type: 'box', size}, surface: {mu}}],
      visuals: [{name: 'v', geometry: {type: 'box', size}, material}],
    }],
  };
}

const fieldOf = ({fields}, path) => fields.find((field) => field.path === path);

test('a model of one link has mass, size and colour on its own panel', () => {
  const [section] = bodySections(box('a'));
  assert.deepEqual(section.fields.map(({path}) => path), ['mass', 'size', 'color', 'inertia']);
  assert.deepEqual(section.entity.color, RED);
});

test('a new size is that of collision and visual, and the inertia follows', () => {
  const [section] = bodySections(box('a'));
  const {ops} = fieldOf(section, 'size').ops([1, 2, 3]);
  assert.deepEqual(ops, [
    {kind: 'set', target: 'a::link::collision:c', path: 'geometry.size', value: [1, 2, 3]},
    {kind: 'set', target: 'a::link::visual:v', path: 'geometry.size', value: [1, 2, 3]},
    {kind: 'compute_inertial', target: 'a::link'},
  ]);
});

test('a new mass keeps the shape of the inertia', () => {
  const [section] = bodySections(box('a'));
  const {label, ops: [op]} = fieldOf(section, 'mass').ops(6);
  assert.equal(label, 'Set mass of a to 6');
  assert.equal(op.value.mass, 6);
  assert.equal(op.value.ixx, 6);
});

test('a colour is ambient and diffuse together', () => {
  const [section] = bodySections(box('a'));
  const {ops} = fieldOf(section, 'color').ops([0, 1, 0, 1]);
  assert.deepEqual(ops.map(({path}) => path), ['material.ambient', 'material.diffuse']);
});

test('several models show what they have in common and are set together', () => {
  const models = [box('a', {mu: 0.5}), box('b', {x: 3, mu: 0.5, mass: 4})];
  const {title, sections: [section]} = sharedSections(models, () => null);
  assert.equal(title, '2 models');
  assert.equal(section.entity.mu, 0.5);
  assert.equal(section.entity.mass, null);
  assert.deepEqual(section.entity.pose, [null, 0, 0.5, 0, 0, 0]);
  const {label, ops} = fieldOf(section, 'mu').ops(0.2);
  assert.equal(label, 'Set friction of 2 models to 0.2');
  assert.deepEqual(ops.map(({target}) => target), ['a::link::collision:c', 'b::link::collision:c']);
  const [move] = fieldOf(section, 'pose').ops([null, 7, 0.5, 0, 0, 0]).ops;
  assert.deepEqual(move.poses.a.slice(0, 3), [0, 7, 0.5]);
  assert.deepEqual(move.poses.b.slice(0, 3), [3, 7, 0.5]);
});

test('what is not typed of the pose of several stays as exact as it is', () => {
  const exact = [0, 0, 0.4999962, 0, 0, Math.SQRT1_2, Math.SQRT1_2];
  const {sections: [section]} = sharedSections([box('a'), box('b')], () => exact);
  assert.deepEqual(section.entity.pose, [0, 0, 0.5, 0, 0, 1.5708]);
  const [move] = fieldOf(section, 'pose').ops([7, ...section.entity.pose.slice(1)]).ops;
  assert.equal(move.poses.b[0], 7);
  assert.equal(move.poses.b[2], exact[2]);
  near(move.poses.b.slice(3), exact.slice(3), 1e-9);
});

test('what is static has no mass to set', () => {
  assert.deepEqual(bodySections(box('wall', {still: true}))[0].fields.map(({path}) => path),
    ['size', 'color']);
});
