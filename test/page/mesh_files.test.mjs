import assert from 'node:assert/strict';
import {test} from 'node:test';
import './with_plain_three.mjs';

const {coarse, limitFor} = await import('../../web/js/view/coarse_mesh.js');
const {fillNormals} = await import('../../web/js/view/facet_normals.js');
const {parseStl} = await import('../../web/js/view/stl.js');
const {bodyOf} = await import('../../web/js/view/response_body.js');
const {Meshes, asGazeboReads} = await import('../../web/js/view/mesh_files.js');

test('a picture that is missing is told by its name, also where that has a bare %', () => {
  const told = [];
  const {manager} = new Meshes((problem) => told.push(problem));
  manager.onError('/meshes/wood%20oak.png');
  manager.onError('/meshes/wood 100%.png');
  assert.deepEqual(told, ['Failed to load texture /meshes/wood oak.png',
    'Failed to load texture /meshes/wood 100%.png']);
});

test('a COLLADA material is clear only where its file says how that is meant', () => {
  const clear = (attribute) => `<phong><diffuse/><transparent${attribute}><color>1 1 1 1</color>
    </transparent><transparency><float>0.4</float></transparency></phong>`;
  const meant = clear(' opaque="A_ONE"');
  const read = asGazeboReads(`<up_axis>Z_UP</up_axis>${clear('')}${meant}`);
  assert.equal(read.replace(/\s/g, ''),
    `<up_axis>Y_UP</up_axis><phong><diffuse/></phong>${meant}`.replace(/\s/g, ''));
});

test('names in COLLADA may contain angle brackets', () => {
  assert.equal(asGazeboReads('<node id="<STL_BINARY>" name="b">a < b</node>'),
    '<node id="&lt;STL_BINARY>" name="b">a < b</node>');
});

test('animations of COLLADA are played whole, whatever clips the file names', () => {
  const keys = '<library_animations><animation id="a"/></library_animations>';
  assert.equal(asGazeboReads(`${keys}<library_animation_clips><animation_clip id="k" start="1" end="2">
    <instance_animation url="#a"/></animation_clip></library_animation_clips>`), keys);
});

test('a COLLADA material has one picture: of its diffuse colour, else of another', () => {
  const [red, one, two] = ['<color>1 0 0 1</color>', '<texture texture="one" texcoord="UV"/>',
    '<texture texture="two" texcoord="UV"><extra/></texture>'];
  const unchanged = [`<phong><emission>${one}</emission><diffuse>${two}</diffuse></phong>`,
    `<lambert><specular>${one}</specular><diffuse>${red}</diffuse></lambert>`,
    `<constant><emission>${one}</emission></constant>`];
  for (const text of unchanged) assert.equal(asGazeboReads(text), text);
  assert.equal(asGazeboReads(`<lambert><emission>${two}</emission><diffuse>${red}</diffuse></lambert>`),
    `<lambert><diffuse>${red}${two}</diffuse><emission></emission></lambert>`);
  assert.equal(asGazeboReads(`<blinn><emission>${two}</emission><specular>${one}</specular></blinn>`),
    `<blinn><diffuse>${one}</diffuse><emission>${two}</emission><specular></specular></blinn>`);
});

test('facets of an STL file without normals get them from their corners', () => {
  const flat = [0, 0, 0, 2, 0, 0, 0, 2, 0];
  const upright = [0, 0, 0, 0, 2, 0, 0, 0, 2];
  const point = [1, 1, 1, 1, 1, 1, 1, 1, 1];
  const given = [0, 0, -1, 0, 0, -1, 0, 0, -1];
  const normal = new Float32Array([...Array(18).fill(0), ...given, ...Array(9).fill(0)]);
  fillNormals([...flat, ...upright, ...flat, ...point], normal);
  assert.deepEqual([...normal.slice(0, 9)], [0, 0, 1, 0, 0, 1, 0, 0, 1]);
  assert.deepEqual([...normal.slice(9, 18)], [1, 0, 0, 1, 0, 0, 1, 0, 0]);
  assert.deepEqual([...normal.slice(18, 27)], given);
  assert.deepEqual([...normal.slice(27)], Array(9).fill(0));
});

/** A sphere of radius 1 as triangles: corners, which are their own normals. @param {number} steps */
function sphere(steps) {
  const corner = (i, j) => {
    const [yaw, pitch] = [2 * Math.PI * i / steps, Math.PI * (j / steps - 0.5)];
    return [Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch)];
  };
  const corners = [];
  for (let i = 0; i < steps; i += 1) {
    for (let j = 0; j < steps; j += 1) {
      for (const [x, y] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) corners.push(...corner(i + x, j + y));
    }
  }
  return Float32Array.from(corners);
}

test('a large mesh keeps its form with fewer triangles, a small one is left as it is', () => {
  const corners = sphere(100);
  assert.equal(coarse(corners, corners, null, corners.length / 9), null);
  const {position, normal, index: drawn} = coarse(corners, corners, null, 2000);
  const triangles = drawn.length / 3;
  assert.ok(position.length / 3 < triangles, 'triangles share corners');
  assert.ok(triangles > 500 && triangles <= 2400, `${triangles} triangles`);
  for (let at = 0; at < position.length; at += 3) {
    const radius = Math.hypot(position[at], position[at + 1], position[at + 2]);
    assert.ok(radius > 0.9 && radius <= 1 + 1e-6, `radius ${radius}`);
    const outwards = [0, 1, 2].reduce((sum, axis) => sum + normal[at + axis] * position[at + axis], 0);
    assert.ok(outwards > 0.5, 'normals outwards');
  }
  const index = Uint32Array.from({length: corners.length / 3}, (_, at) => at);
  assert.deepEqual(coarse(corners, corners, index, 2000).position, position);
  assert.ok(limitFor(1) > limitFor(200) && limitFor(1e6) >= 500);
  for (const files of [1, 10, 200, 1e6]) assert.ok(limitFor(files, {moving: true}) <= limitFor(files) / 4);
});

test('a mesh is closed that surrounds a volume and faces outwards', () => {
  const corners = sphere(100);
  const turned = corners.map((_, at) => corners[9 * Math.floor(at / 9) + 3 * (2 - Math.floor(at % 9 / 3)) + at % 3]);
  const open = corners.slice(0, corners.length / 2);
  const twice = Float32Array.from([...corners, ...turned]);
  for (const [name, mesh, closed] of [['sphere', corners, true], ['inside out', turned, false],
    ['half a sphere', open, false], ['both sides of a half', Float32Array.from([...open, ...turned.slice(0, open.length)]), false],
    ['both sides', twice, false]]) {
    for (const limit of [300, 2000]) assert.equal(coarse(mesh, mesh, null, limit).closed, closed, name);
  }
});

/** A binary STL file. @param facets  twelve numbers each: normal, three corners */
function binaryStl(facets) {
  const view = new DataView(new ArrayBuffer(84 + 50 * facets.length));
  view.setUint32(80, facets.length, true);
  facets.forEach((numbers, facet) => numbers.forEach((number, at) =>
    view.setFloat32(84 + 50 * facet + 4 * at, number, true)));
  return view.buffer;
}

test('binary and text STL files have the same facets', () => {
  const facet = [0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0.5];
  const text = `solid a\n facet normal 0 0 1.0\n outer loop\n vertex 0 0 0\n vertex 2e0 0 0
    vertex 0 +2 .5\n endloop\n endfacet\nendsolid\nsolid b\nendsolid`;
  const read = [binaryStl([facet]), new TextEncoder().encode(text).buffer].map(parseStl);
  for (const {position, normal} of read) {
    assert.deepEqual([...position], facet.slice(3));
    assert.deepEqual([...normal], [0, 0, 1, 0, 0, 1, 0, 0, 1]);
  }
});

test('an STL file that ends too early is refused, also one that says it is binary by its header', () => {
  const whole = binaryStl([[0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0]]);
  assert.throws(() => parseStl(whole.slice(0, 100)), /ends before the last of its 1 triangles/);
  new Uint8Array(whole).set(new TextEncoder().encode('solid'));
  assert.equal(parseStl(whole).position.length, 9, 'the size decides');
});

test('the bytes of a large answer are counted while they arrive', async () => {
  const chunk = new Uint8Array(700000).fill(7);
  const answer = (chunks, size) => new Response(new ReadableStream({start(stream) {
    for (let at = 0; at < chunks; at += 1) stream.enqueue(chunk);
    stream.close();
  }}), {headers: {'Content-Length': size}});
  const told = [];
  const content = await bodyOf(answer(3, 2100000), (...counts) => told.push(counts));
  assert.equal(new Uint8Array(content).filter((byte) => byte === 7).length, 2100000);
  assert.deepEqual(told[0], [0, 2100000]);
  assert.equal(told.reduce((sum, [loaded]) => sum + loaded, 0), 2100000);
  await assert.rejects(bodyOf(answer(2, 2100000), () => {}), /ended after 1400000 of 2100000 bytes/);
});
