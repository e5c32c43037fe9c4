import assert from 'node:assert/strict';
import {test} from 'node:test';
import './with_plain_three.mjs';

const {Meshes} = await import('../../web/js/view/mesh_files.js');

test('a picture that is missing is told by its name, also where that has a bare %', () => {
  const told = [];
  const {manager} = new Meshes((problem) => told.push(problem));
  manager.onError('/meshes/wood%20oak.png');
  manager.onError('/meshes/wood 100%.png');
  assert.deepEqual(told, ['Failed to load texture /meshes/wood oak.png',
    'Failed to load texture /meshes/wood 100%.png']);
});
