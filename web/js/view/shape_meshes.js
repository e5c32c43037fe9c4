/** What a visual or a collision is drawn with: geometries, where they sit, their materials. */
import {
  Box3, BoxGeometry, BufferGeometry, CapsuleGeometry, ConeGeometry, CylinderGeometry,
  ExtrudeGeometry, Matrix4, Mesh, Path, PlaneGeometry, Quaternion, Shape, SphereGeometry, Vector3,
} from 'three';
import {matrixOf} from './three_convert.js';
import {Materials} from './materials.js';

/**
 * @typedef {object} Part
 * @property {BufferGeometry} geometry
 * @property {any} material
 * @property {Matrix4} matrix  link frame from geometry
 */

const X_TO_Z = new Matrix4().makeRotationX(Math.PI / 2);

function upright(geometry) {
  return geometry.applyMatrix4(X_TO_Z);
}

/** Sizes are put into matrices, so that all boxes share one geometry, and so on. */
const UNIT = {
  box: new BoxGeometry(1, 1, 1),
  sphere: upright(new SphereGeometry(1, 32, 16)),
  cylinder: upright(new CylinderGeometry(1, 1, 1, 32)),
  cone: upright(new ConeGeometry(1, 1, 32)),
  plane: new PlaneGeometry(1, 1),
};
/** What many of a kind are drawn with: one by one they are small on the screen. */
UNIT.sphere.userData.plainer = upright(new SphereGeometry(1, 16, 10));
UNIT.cylinder.userData.plainer = upright(new CylinderGeometry(1, 1, 1, 16));

const scaled = (geometry, x, y, z) => [{geometry, matrix: new Matrix4().makeScale(x, y, z)}];

const capsules = new Map();

function capsule({radius, length}) {
  const key = `${radius} ${length}`;
  if (!capsules.has(key)) capsules.set(key, upright(new CapsuleGeometry(radius, length, 12, 32)));
  return [{geometry: capsules.get(key), matrix: new Matrix4()}];
}

function plane({normal, size}) {
  const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1),
    new Vector3(...normal).normalize());
  return [{geometry: UNIT.plane, pushed: true,
    matrix: new Matrix4().compose(new Vector3(), turn, new Vector3(size[0], size[1], 1))}];
}

function polyline({loops, height}) {
  if (!loops?.length) return [];
  const ring = (loop) => loop.map(([x, y]) => new Vector3(x, y, 0));
  const shape = new Shape(ring(loops[0]));
  shape.holes = loops.slice(1).map((loop) => new Path(ring(loop)));
  const geometry = new ExtrudeGeometry(shape, {depth: height, bevelEnabled: false});
  // Nobody shares it: who takes it away frees it.
  geometry.userData.single = true;
  return [{geometry, matrix: new Matrix4()}];
}

const SIMPLE = {
  box: ({size}) => scaled(UNIT.box, ...size),
  sphere: ({radius}) => scaled(UNIT.sphere, radius, radius, radius),
  cylinder: ({radius, length}) => scaled(UNIT.cylinder, radius, radius, length),
  cone: ({radius, length}) => scaled(UNIT.cone, radius, radius, length),
  ellipsoid: ({radii}) => scaled(UNIT.sphere, ...radii),
  capsule,
  plane,
  empty: () => [],
};

/** The named part of a mesh, all of it without a name (SDF spec 1.7, mesh/submesh). */
function chosen(parts, {submesh, center}) {
  if (!submesh) return parts;
  const picked = parts.filter(({names, whole}) => whole || names.includes(submesh));
  if (!center || !picked.length) return picked;
  const box = new Box3();
  for (const {geometry, matrix} of picked) {
    if (!geometry.boundingBox) geometry.computeBoundingBox();
    box.union(geometry.boundingBox.clone().applyMatrix4(matrix));
  }
  const shift = new Matrix4().makeTranslation(box.getCenter(new Vector3()).negate());
  return picked.map((part) => ({...part, matrix: shift.clone().multiply(part.matrix)}));
}

function meshParts(parts, geometry) {
  const scale = Array.isArray(geometry.scale) && geometry.type === 'mesh' ? geometry.scale
    : [1, 1, 1];
  const sizing = new Matrix4().makeScale(...scale);
  return chosen(parts, geometry).map((part) => ({
    geometry: part.geometry, matrix: sizing.clone().multiply(part.matrix),
    own: part.material,
  }));
}

function basicParts(geometry, meshes) {
  const simple = SIMPLE[geometry.type];
  if (simple) return simple(geometry);
  if (geometry.url) {
    const present = meshes.present(geometry);
    return present ? meshParts(present, geometry)
      : meshes.load(geometry).then((parts) => meshParts(parts, geometry));
  }
  return geometry.type === 'polyline' ? polyline(geometry) : [];
}

/**
 * The parts of a visual, or of a collision when `material` is given.
 * @param {{pose: number[], geometry: any, material?: any, transparency?: number}} shape
 * @param {{meshes: import('./mesh_files.js').Meshes, materials: Materials}} stock
 * @param {import('./materials.js').Variant & {material?: any}} [look]  material: a three material
 *        in place of the shape's
 * @returns {Part[]|Promise<Part[]>} at once when nothing must be fetched
 */
export function visualParts(shape, stock, look = {}) {
  const basic = basicParts(shape.geometry, stock.meshes);
  const finish = (parts) => parts.map((part) => finished(part, shape, stock.materials, look));
  return basic instanceof Promise ? basic.then(finish) : finish(basic);
}

/** A part as a mesh that stays where the part is. @param {Part} part */
export function meshOf({geometry, material, matrix}) {
  const mesh = new Mesh(geometry, material);
  mesh.matrixAutoUpdate = false;
  mesh.matrix.copy(matrix);
  return mesh;
}

function finished(part, shape, materials, {material, opacity = 1, wireframe = false}) {
  const variant = {opacity: opacity * (1 - (shape.transparency ?? 0)), wireframe};
  let made = material;
  if (!made && part.own && !Materials.speaks(shape.material)) {
    made = Array.isArray(part.own) ? part.own.map((one) => materials.own(one, variant))
      : materials.own(part.own, variant);
  }
  made ??= materials.get(shape.material ?? null, variant,
    {doubleSided: shape.geometry.type !== 'box' && shape.geometry.type !== 'plane',
      pushed: part.pushed ?? false});
  return {geometry: part.geometry, material: made,
    matrix: matrixOf(shape.pose).multiply(part.matrix)};
}
