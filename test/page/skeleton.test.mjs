import assert from 'node:assert/strict';
import {test} from 'node:test';

import {fromRpy} from '../../web/js/pose.js';
import {skeletonOf} from '../../web/js/skeleton.js';

const STRAIGHT = [0, 0, 0, 1];
const close = (found, wanted) =>
  found.flat(2).forEach((value, index) =>
    assert.ok(Math.abs(value - wanted.flat(2)[index]) < 1e-12, `${found} is not ${wanted}`));

const arm = {
  links: [
    {name: 'base', pose: [0, 0, 1, ...fromRpy(0, 0, Math.PI / 2)]},
    {name: 'tip', pose: [0, 2, 1, ...STRAIGHT]},
  ],
  joints: [
    {name: 'hinge', parent: 'base', child: 'tip', pose: [0, -1, 0, ...STRAIGHT]},
    {name: 'foot', parent: 'world', child: 'base', pose: [0, 0, -1, ...STRAIGHT]},
  ],
};

test('a link reaches from its origin to the joints above and below it', () => {
  const {bones, sockets} = skeletonOf(arm, arm.links[0]);
  // The hinge is 1 m in front of the base, which looks along y.
  close(bones, [[[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 0, -1]]]);
  assert.deepEqual(sockets, [[0, 0, -1]]);
});

test('the last link has one bone and its socket', () => {
  const {bones, sockets} = skeletonOf(arm, arm.links[1]);
  close(bones, [[[0, 0, 0], [0, -1, 0]]]);
  assert.deepEqual(sockets, [[0, -1, 0]]);
});

test('a link without joints has no skeleton', () => {
  const lone = {links: [{name: 'link', pose: [0, 0, 0, ...STRAIGHT]}], joints: []};
  assert.deepEqual(skeletonOf(lone, lone.links[0]), {bones: [], sockets: []});
});
