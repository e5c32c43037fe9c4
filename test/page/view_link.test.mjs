import assert from 'node:assert/strict';
import {test} from 'node:test';
import {angle, lengthText, measures} from '../../web/js/measure_math.js';
import {linkOf, readLink} from '../../web/js/view_link.js';
import {near} from './near.mjs';

const VIEW = {position: [5, -5, 2.12345678], yaw: 2.356, pitch: -0.27};

test('a link says camera and selection, whatever the names are', () => {
  const names = ['box', 'robot::left wheel', 'a,b&c=d#é'];
  const {view, selection} = readLink(linkOf(VIEW, names));
  assert.deepEqual(selection, names);
  near([...view.position, view.yaw, view.pitch], [5, -5, 2.1235, 2.356, -0.27]);
});

test('a link may have no selection, and what is no link says nothing', () => {
  assert.deepEqual(readLink(linkOf(VIEW, [])).selection, []);
  for (const hash of ['', '#', '#view=', '#view=1,2', '#view=a,b,c,d,e', '#other=1']) {
    assert.equal(readLink(hash), null, hash);
  }
  assert.deepEqual(readLink('#select=%').selection, ['%']);
});

test('two points are a distance with its parts, three an angle', () => {
  assert.deepEqual(measures([[0, 0, 0]]), []);
  assert.deepEqual(measures([[0, 0, 0], [3, 4, 0]]), ['5.000 m  (x 3.000, y 4.000, z 0.000)']);
  assert.equal(measures([[1, 0, 0], [0, 0, 0], [0, 2, 0]]).at(-1), '90.0°');
  assert.equal(angle([[0, 0, 0], [0, 0, 0], [1, 0, 0]]), 0);
  assert.equal(lengthText(0.1234), '12.3 cm');
});
