import assert from 'node:assert/strict';
import {test} from 'node:test';
import {
  axisAngle, compose, displacement, fromRpy, inverse, rotate, rotationBetween, transform,
} from '../../web/js/pose.js';
import {near, sameTurn} from './near.mjs';

const QUARTER = Math.PI / 2;
const NONE = [0, 0, 0, 0, 0, 0, 1];

test('a quarter turn about z takes x to y', () => {
  near(rotate(axisAngle([0, 0, 1], QUARTER), [1, 0, 0]), [0, 1, 0]);
});

test('a pose composed with its inverse is none', () => {
  const pose = [1, -2, 3, ...fromRpy(0.3, -0.7, 2)];
  near(compose(pose, inverse(pose)), NONE);
  near(compose(inverse(pose), pose), NONE);
});

test('composing is child in parent in world', () => {
  const parent = [1, 0, 0, ...axisAngle([0, 0, 1], QUARTER)];
  near(compose(parent, [1, 0, 0, 0, 0, 0, 1]).slice(0, 3), [1, 1, 0]);
  near(transform(parent, [1, 0, 0]), [1, 1, 0]);
});

test('angles of a pose turn about fixed axes, x first', () => {
  near(rotate(fromRpy(QUARTER, 0, QUARTER), [0, 1, 0]), [0, 0, 1]);
  sameTurn(fromRpy(0, 0, 1), axisAngle([0, 0, 1], 1));
});

test('the rotation between opposite directions is a half turn', () => {
  near(rotate(rotationBetween([0, 0, 1], [0, 0, -1]), [0, 0, 1]), [0, 0, -1]);
  near(rotate(rotationBetween([1, 0, 0], [-1, 0, 0]), [1, 0, 0]), [-1, 0, 0]);
  near(rotate(rotationBetween([1, 0, 0], [0, 0.6, 0.8]), [1, 0, 0]), [0, 0.6, 0.8]);
});

test('what turns moves its far end by angle times radius, whatever the sign of the quaternion', () => {
  const turned = [0, 0, 0, ...axisAngle([0, 0, 1], 0.01)];
  const opposite = turned.map((part, at) => (at < 3 ? part : -part));
  for (const to of [turned, opposite]) {
    assert.ok(Math.abs(displacement(NONE, to, 2) - 0.02) < 1e-6);
  }
  assert.equal(displacement(NONE, [3, 4, 0, 0, 0, 0, 1], 9), 5);
});
