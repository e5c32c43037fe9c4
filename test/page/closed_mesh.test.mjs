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

/** Extents of the texture coordinates of a face of a box, and where they begin. */
function textureOn(face, pose, picture_size) {
  const stock = {materials: new Materials(new LoadingManager())};
  const [{geometry, matrix}] = visualParts({geometry: {type: 'box', size: [4, 0.2, 2.5]}, material: null, pose, picture_size}, stock);
  const {normal, uv} = geometry.attributes;
  const at = Array.from({length: normal.count}, (_, index) => index)
    .filter((index) => [normal.getX(index), normal.getY(index), normal.getZ(index)].join() === face.join());
  const [u, v] = [at.map((index) => uv.getX(index)), at.map((index) => uv.getY(index))];
  const round = (value) => Math.round(value * 1e6) / 1e6;
  return {u: round(Math.max(...u) - Math.min(...u)), v: round(Math.max(...v) - Math.min(...v)),
    from: [round(Math.min(...u)), round(Math.min(...v))], scale: matrix.elements[0]};
}

test('the texture of a wall has one size on all faces, and those of its parts meet', () => {
  const pose = [2, 0, 1.25, 0, 0, 0, 1];
  assert.deepEqual(textureOn([0, -1, 0], pose, 0.5), {u: 8, v: 5, from: [0, 0], scale: 1});
  assert.deepEqual(textureOn([1, 0, 0], pose, 0.5), {u: 0.4, v: 5, from: [-0.2, 0], scale: 1});
  assert.deepEqual(textureOn([0, 0, 1], pose, 0.5), {u: 8, v: 0.4, from: [0, -0.2], scale: 1});
  const quarter = [0, 3, 0, 0, 0, Math.SQRT1_2, Math.SQRT1_2];
  assert.deepEqual(textureOn([0, -1, 0], quarter, 0.5).from, [2, -2.5]);
  assert.deepEqual(textureOn([1, 0, 0], pose, null), {u: 1, v: 1, from: [0, 0], scale: 4});
});
