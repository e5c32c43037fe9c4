import assert from 'node:assert/strict';
import {pathToFileURL} from 'node:url';
import {test} from 'node:test';

const three = pathToFileURL(`${process.env.MY_SIMULATIONS_NODE_MODULES}/three/build/three.module.js`).href;
const {BoxGeometry, DoubleSide, FrontSide, LoadingManager, Matrix4, MeshPhongMaterial} = await import(three);
const {Materials} = await import('../../web/js/view/materials.js');
const {visualParts} = await import('../../web/js/view/shape_meshes.js');

/** The side that is drawn of a mesh file. */
function sideOf({closed, scale = [1, 1, 1], material = null, transparency = 0}, own = {}) {
  const geometry = new BoxGeometry();
  geometry.userData.closed = closed;
  const part = {geometry, material: new MeshPhongMaterial({side: DoubleSide, ...own}), matrix: new Matrix4(), names: []};
  const stock = {meshes: {present: () => [part]}, materials: new Materials(new LoadingManager())};
  const [{material: drawn}] = visualParts({geometry: {type: 'mesh', url: 'a.stl', scale}, material, transparency,
    pose: [0, 0, 0, 0, 0, 0, 1]}, stock);
  return drawn.side;
}

test('only the fronts of closed meshes are drawn', () => {
  const red = {diffuse: [1, 0, 0, 1]};
  assert.equal(sideOf({closed: true}), FrontSide);
  assert.equal(sideOf({closed: true, material: red}), FrontSide);
  assert.equal(sideOf({closed: false}), DoubleSide);
  assert.equal(sideOf({closed: false, material: red}), DoubleSide);
});

test('both sides are drawn of closed meshes that are mirrored or can be seen through', () => {
  assert.equal(sideOf({closed: true, scale: [1, -1, 1]}), DoubleSide);
  assert.equal(sideOf({closed: true, scale: [1, -1, -1]}), FrontSide);
  assert.equal(sideOf({closed: true, transparency: 0.5}), DoubleSide);
  assert.equal(sideOf({closed: true}, {transparent: true}), DoubleSide);
});
