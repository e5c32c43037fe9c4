import assert from 'node:assert/strict';
import {test} from 'node:test';
import './with_plain_three.mjs';

const {Mesh} = await import('three');
const {markerShape} = await import('../../web/js/view/topic_shapes.js');

/** A marker as the server tells it. */
const marker = (fields) => ({shape: 'cube', color: [1, 0, 0, 1], scale: [1, 1, 1], points: [],
  colors: [], text: '', ...fields});
const points = (count) => Array.from({length: count}, (_, x) => [x, 0, 0]);

test('each cube and sphere of a list has the colour of its point', () => {
  for (const shape of ['cube_list', 'sphere_list']) {
    const made = markerShape(marker({shape, color: [0, 0, 0, 0], points: points(2),
      colors: [[1, 0, 0, 1], [0, 1, 0, 1]]}));
    assert.equal(made.count, 2);
    assert.deepEqual(made.colors.map(({r, g, b}) => [r, g, b]), [[1, 0, 0], [0, 1, 0]]);
    assert.deepEqual([made.material.color, made.material.opacity], [0xffffff, 1]);
  }
});

test('all of a long list are drawn, in the colour of the marker without others', () => {
  const made = markerShape(marker({shape: 'cube_list', points: points(5000)}));
  assert.equal(made.count, 5000);
  assert.deepEqual(made.colors, []);
  assert.equal(made.material.color, 0xff0000);
});

test('a marker without opacity is not drawn, and half of it is half', () => {
  assert.equal(markerShape(marker({color: [1, 0, 0, 0]})) instanceof Mesh, false);
  assert.equal(markerShape(marker({color: [1, 0, 0, 0.5]})).material.opacity, 0.5);
  const line = {shape: 'line_strip', color: [0, 0, 0, 0], points: points(2)};
  assert.equal(markerShape(marker({...line, colors: [[1, 0, 0, 0.25], [1, 0, 0, 0]]}))
    .material.opacity, 0.25);
});
