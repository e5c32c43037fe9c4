import assert from 'node:assert/strict';
import {pathToFileURL} from 'node:url';
import {test} from 'node:test';

const three = pathToFileURL(`${process.env.MY_SIMULATIONS_NODE_MODULES}/three/build/three.module.js`).href;
const {BoxGeometry, BufferAttribute, BufferGeometry, Matrix4, MeshBasicMaterial, Scene, SphereGeometry} = await import(three);
const {Batches} = await import('../../web/js/view/batches.js');

/** A triangle or more, without texture coordinates. */
function bare(source) {
  const {position, normal} = source.attributes;
  return new BufferGeometry().setAttribute('position', position).setAttribute('normal', normal).setIndex(source.index);
}

/** The triangles that a scene's only mesh draws, each as its nine numbers. */
function drawn({children}) {
  assert.equal(children.length, 1);
  const {geometry: {attributes: {position}, index, drawRange: {count}}} = children[0];
  return Array.from({length: count / 3}, (_, triangle) => [0, 1, 2].flatMap((corner) => {
    const at = 3 * index.array[3 * triangle + corner];
    return [...position.array.slice(at, at + 3)].map((part) => Math.round(1e4 * part) / 1e4);
  }));
}

/** The lowest and the highest x of what is drawn. */
const span = (triangles) => triangles.flat().filter((_, at) => at % 3 === 0)
  .reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], [Infinity, -Infinity]);

test('different meshes of a material are one mesh, which follows what moves, comes and goes', () => {
  const scene = new Scene();
  const batches = new Batches(scene, {merging: true});
  const material = new MeshBasicMaterial();
  const shapes = [1, 2, 3].flatMap((size) => [bare(new BoxGeometry(size, size, size)), bare(new SphereGeometry(size, 6, 4))]);
  const items = shapes.map((geometry, n) => batches.add({geometry, material, owner: {},
    matrix: new Matrix4().makeTranslation(10 * n, 0, 0)}));
  batches.prepare();
  const count = (some) => some.reduce((sum, {index}) => sum + index.count / 3, 0);
  assert.equal(drawn(scene).length, count(shapes));
  assert.deepEqual(span(drawn(scene)), [-0.5, 53]);

  items[0].matrix.makeTranslation(-20, 0, 0);
  batches.moved(items[0]);
  assert.deepEqual(span(drawn(scene)), [-20.5, 53]);

  batches.remove(items[0]);
  batches.prepare();
  assert.equal(drawn(scene).length, count(shapes.slice(1)));
  assert.deepEqual(span(drawn(scene)), [9, 53]);

  const added = batches.add({geometry: shapes[0], material, owner: {}, matrix: new Matrix4().makeTranslation(99, 0, 0)});
  batches.moved(added);
  batches.prepare();
  assert.deepEqual(span(drawn(scene)), [9, 99.5]);
});

test('meshes with textures, colors or many corners are drawn alone', () => {
  const scene = new Scene();
  const batches = new Batches(scene, {merging: true});
  const material = new MeshBasicMaterial();
  const textured = Array.from({length: 3}, (_, n) => new SphereGeometry(n + 1, 20, 20));
  const large = Array.from({length: 3}, (_, n) => bare(new SphereGeometry(n + 1, 80, 80)));
  const colored = Array.from({length: 3}, (_, n) => bare(new BoxGeometry(n + 1, 1, 1))
    .setAttribute('color', new BufferAttribute(new Float32Array(72), 3)));
  for (const geometry of [...textured, ...large, ...colored]) {
    batches.add({geometry, material, owner: {}, matrix: new Matrix4()});
  }
  batches.prepare();
  assert.equal(scene.children.length, 9);
});

/** How many triangles the meshes of a scene draw. */
const amount = ({children}) => children.reduce((sum, {geometry: {index, drawRange}}) =>
  sum + Math.min(index.count, drawRange.count) / 3, 0);

test('meshes have their plainer forms while things move, alone and in one', () => {
  const material = new MeshBasicMaterial();
  const withForm = (large) => {
    const geometry = bare(large ? new SphereGeometry(1, 80, 80) : new SphereGeometry(1, 12, 8));
    geometry.userData.moving = bare(new BoxGeometry(2, 2, 2));
    return geometry;
  };
  for (const large of [false, true]) {
    const scene = new Scene();
    const batches = new Batches(scene, {merging: true});
    const places = large ? [0, 10] : [0, 1, 2, 3, 4, 10];
    const items = places.map((x) => batches.add({geometry: withForm(large), material, owner: {},
      matrix: new Matrix4().makeTranslation(x, 0, 0)}));
    assert.equal(batches.prepare(), false);
    const full = amount(scene);
    assert.equal(full, items.length * items[0].geometry.index.count / 3);
    assert.equal(batches.prepare(true), true);
    assert.equal(amount(scene), 12 * items.length);
    assert.equal(batches.prepare(true), false, 'the same forms as before');
    items.at(-1).matrix.makeTranslation(20, 0, 0);
    batches.moved(items.at(-1));
    batches.prepare(true);
    if (!large) assert.deepEqual(span(drawn(scene)), [-1, 21]);
    assert.equal(batches.prepare(false), true);
    assert.equal(amount(scene), full);
    if (!large) assert.deepEqual(span(drawn(scene)), [-1, 21], 'moved in both forms');
  }
});

test('many copies of a mesh have its plainer form while things move', () => {
  const material = new MeshBasicMaterial();
  const geometry = new SphereGeometry(1, 80, 80);
  geometry.userData.moving = bare(new BoxGeometry(1, 1, 1));
  const scene = new Scene();
  const batches = new Batches(scene, {merging: true});
  const add = () => batches.add({geometry, material, owner: {}, matrix: new Matrix4()});
  for (let n = 0; n < 10; n += 1) add();
  assert.equal(batches.prepare(true), true);
  assert.equal(scene.children[0].geometry, geometry.userData.moving);
  for (let n = 0; n < 10; n += 1) add();
  assert.equal(scene.children[0].geometry, geometry.userData.moving);
  assert.equal(batches.prepare(false), true);
  assert.equal(scene.children[0].geometry, geometry);
});

test('a world without plainer forms draws the same while things move', () => {
  const batches = new Batches(new Scene(), {merging: true});
  batches.add({geometry: bare(new BoxGeometry(1, 1, 1)), material: new MeshBasicMaterial(), owner: {}, matrix: new Matrix4()});
  assert.equal(batches.prepare(true), false);
});
