import assert from 'node:assert/strict';
import {test} from 'node:test';
import {encoded, filesOf, kindOf, MOST_BYTES} from '../../web/js/dropped_files.js';

const paths = (...names) => names.map((path) => ({path}));

test('what was dropped becomes a text, a world, a model or a mesh', () => {
  assert.deepEqual(kindOf(paths('crate.sdf')), {kind: 'text', name: 'crate'});
  assert.deepEqual(kindOf(paths('arm.urdf')), {kind: 'text', name: 'arm'});
  assert.deepEqual(kindOf(paths('house.world')), {kind: 'world', name: 'house'});
  assert.deepEqual(kindOf(paths('chair/model.config', 'chair/model.sdf', 'chair/meshes/a.dae')),
    {kind: 'model', name: 'chair'});
  assert.deepEqual(kindOf(paths('cup.obj', 'cup.mtl', 'cup.png')), {kind: 'mesh', name: 'cup'});
  assert.equal(kindOf(paths('a.stl', 'b.stl')), null);
  assert.equal(kindOf(paths('letter.pdf')), null);
});

test('files and folders are read, hidden ones left out', async () => {
  const file = (name) => ({isFile: true, name, fullPath: `/m/${name}`,
    file: (call) => call(new File(['abc'], name))});
  const parts = [[file('model.sdf'), file('.git')], []];
  const folder = {isFile: false, name: 'm', fullPath: '/m',
    createReader: () => ({readEntries: (call) => call(parts.shift())})};
  const found = await filesOf([folder, new File(['x'], 'loose.stl')]);
  assert.deepEqual(found.map(({path}) => path), ['loose.stl', 'm/model.sdf']);
  assert.deepEqual((await encoded(found))[1], {path: 'm/model.sdf', data: btoa('abc')});
});

test('more than the simulator takes is refused before it is sent', async () => {
  const large = new File(['a'], 'large.stl');
  Object.defineProperty(large, 'size', {value: MOST_BYTES + 1});
  await assert.rejects(filesOf([large]), /at most 20 MB/);
});
