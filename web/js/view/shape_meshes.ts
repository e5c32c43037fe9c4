/** What a visual or a collision is drawn with: geometries, where they sit, their materials. */
import {
  Box3, BoxGeometry, CapsuleGeometry, ConeGeometry, CylinderGeometry,
  ExtrudeGeometry, Matrix4, Mesh, Path, PlaneGeometry, Quaternion, Shape, SphereGeometry, Vector2, Vector3,
} from 'three';
import {matrixOf} from './three_convert.js';
import {sourceOf} from './mesh_files.js';
import {Materials} from './materials.js';
import type {BufferGeometry, Material} from 'three';
import type {Capsule, Geometry, Plane, Polyline} from '../protocol.js';
import type {Meshes} from './mesh_files.js';
import type {MeshPart} from './simplified_mesh.js';
import type {Pose7} from '../pose.js';
import type {Variant} from './materials.js';

/** What parts are made of. */
export type Stock = {meshes: Meshes, materials: Materials};

/** A visual, or a collision, which has no material of its own. */
type DrawnShape = {pose: Pose7, geometry: Geometry,
    material?: import('../protocol.js').Material|null,
    transparency?: number, picture_size?: number|null};

/** How a shape is drawn; `material`: in place of its own. */
type Look = Variant & {material?: Material};

/** A geometry of a shape before its material is chosen; `own`: the material of the mesh file. */
type BasicPart = {geometry: BufferGeometry, matrix: Matrix4, pushed?: boolean,
    endless?: boolean, own?: Material|Material[]};

export interface Part {
  geometry: BufferGeometry;
  material: Material|Material[];
  /** link frame from geometry */
  matrix: Matrix4;
}

/** Planes from this size on, m, stand for a ground without end. */
const ENDLESS = 40;

const X_TO_Z = new Matrix4().makeRotationX(Math.PI / 2);

function upright(geometry: BufferGeometry) {
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

const scaled = (geometry: BufferGeometry, x: number, y: number, z: number) =>
    [{geometry, matrix: new Matrix4().makeScale(x, y, z)}];

const capsules: Map<string, BufferGeometry> = new Map();

function capsule({radius, length}: Capsule) {
  const key = `${radius} ${length}`;
  const geometry = capsules.get(key) ?? upright(new CapsuleGeometry(radius, length, 12, 32));
  capsules.set(key, geometry);
  return [{geometry, matrix: new Matrix4()}];
}

function plane({normal, size}: Plane) {
  const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1),
    new Vector3().fromArray(normal).normalize());
  return [{geometry: UNIT.plane, pushed: true, endless: Math.min(size[0], size[1]) >= ENDLESS,
    matrix: new Matrix4().compose(new Vector3(), turn, new Vector3(size[0], size[1], 1))}];
}

function polyline({loops, height}: Polyline) {
  if (!loops?.length) return [];
  const ring = (loop: number[][]) => loop.map(([x, y]) => new Vector2(x, y));
  const shape = new Shape(ring(loops[0]));
  shape.holes = loops.slice(1).map((loop) => new Path(ring(loop)));
  const geometry = new ExtrudeGeometry(shape, {depth: height, bevelEnabled: false});
  // This geometry is not shared: its owner disposes it.
  geometry.userData.single = true;
  return [{geometry, matrix: new Matrix4()}];
}

/**
 * A box whose texture has one size on all faces, upright on the sides; null for other shapes. Textures begin at
 * the origin of the link, so that those of the parts of a wall meet.
 */
function repeatedBox({pose, geometry: shape, picture_size: edge}: DrawnShape): BasicPart[]|null {
  if (!edge || shape.type !== 'box') return null;
  const geometry = new BoxGeometry(...(shape.size as [number, number, number]));
  const start = new Vector3().fromArray(pose)
    .applyQuaternion(new Quaternion().fromArray(pose, 3).conjugate());
  const {position, normal, uv} = geometry.attributes;
  for (let at = 0; at < position.count; at++) {
    const [x, y, z] = [position.getX(at) + start.x, position.getY(at) + start.y, position.getZ(at) + start.z];
    const up = normal.getZ(at);
    if (up) uv.setXY(at, x / edge, up * y / edge);
    else uv.setXY(at, (normal.getX(at) * y - normal.getY(at) * x) / edge, z / edge);
  }
  // This geometry is not shared: its owner disposes it.
  geometry.userData.single = true;
  return [{geometry, matrix: new Matrix4()}];
}

/** The parts of a shape that needs no file; null for one that does. */
function simpleParts(geometry: Geometry): BasicPart[]|null {
  switch (geometry.type) {
    case 'box': return scaled(UNIT.box, geometry.size[0], geometry.size[1], geometry.size[2]);
    case 'sphere': return scaled(UNIT.sphere, geometry.radius, geometry.radius, geometry.radius);
    case 'cylinder':
      return scaled(UNIT.cylinder, geometry.radius, geometry.radius, geometry.length);
    case 'cone': return scaled(UNIT.cone, geometry.radius, geometry.radius, geometry.length);
    case 'ellipsoid':
      return scaled(UNIT.sphere, geometry.radii[0], geometry.radii[1], geometry.radii[2]);
    case 'capsule': return capsule(geometry);
    case 'plane': return plane(geometry);
    case 'empty': return [];
    default: return null;
  }
}

/** The named part of a mesh, all of it without a name (SDF spec 1.7, mesh/submesh). */
function chosen(parts: MeshPart[], geometry: Geometry) {
  const {submesh, center} = geometry.type === 'mesh' ? geometry : {};
  if (!submesh) return parts;
  const picked = parts.filter(({names, whole}) => whole || names.includes(submesh));
  if (!center || !picked.length) return picked;
  const box = new Box3();
  for (const part of picked) box.union(boxOf(part.geometry).applyMatrix4(part.matrix));
  const shift = new Matrix4().makeTranslation(box.getCenter(new Vector3()).negate());
  return picked.map((part) => ({...part, matrix: shift.clone().multiply(part.matrix)}));
}

function meshParts(parts: MeshPart[], geometry: Geometry) {
  const [x, y, z] = geometry.type === 'mesh' ? geometry.scale : [1, 1, 1];
  const sizing = new Matrix4().makeScale(x, y, z);
  return chosen(parts, geometry).map((part) => ({
    geometry: part.geometry, matrix: sizing.clone().multiply(part.matrix),
    own: part.material,
  }));
}

function basicParts(geometry: Geometry, meshes: Meshes) {
  const simple = simpleParts(geometry);
  if (simple) return simple;
  const source = sourceOf(geometry);
  if (source) {
    const present = meshes.present(source);
    return present ? meshParts(present, geometry)
      : meshes.load(source).then((parts) => meshParts(parts, geometry));
  }
  return geometry.type === 'polyline' ? polyline(geometry) : [];
}

/**
 * The parts of a visual, or of a collision when `material` is given.
 * @returns at once when nothing must be fetched
 */
export function visualParts(shape: DrawnShape, stock: Stock, look: Look = {}): Part[]|Promise<Part[]> {
  const basic = repeatedBox(shape) ?? basicParts(shape.geometry, stock.meshes);
  const finish = (parts: BasicPart[]) => parts.map((part) => finished(part, shape, stock.materials,
      look));
  return basic instanceof Promise ? basic.then(finish) : finish(basic);
}

/** The bounding box of a geometry, a copy. */
export function boxOf(geometry: BufferGeometry) {
  if (!geometry.boundingBox) geometry.computeBoundingBox();
  return geometry.boundingBox?.clone() ?? new Box3();
}

/** A part as a mesh that stays where the part is. */
export function meshOf({geometry, material, matrix}: Part) {
  const mesh = new Mesh(geometry, material);
  mesh.matrixAutoUpdate = false;
  mesh.matrix.copy(matrix);
  return mesh;
}

/**
 * Whether all of a part is seen from the front. Mirrored parts are not: where copies are merged, their triangles
 * would be taken for backs.
 */
const isClosed = ({geometry, matrix}: BasicPart) => Boolean(geometry.userData.closed) && matrix.determinant() > 0;

function finished(part: BasicPart, shape: DrawnShape, materials: Materials, {material, opacity = 1,
    wireframe = false}: Look) {
  const variant = {opacity: opacity * (1 - (shape.transparency ?? 0)), wireframe};
  const frontOnly = isClosed(part) && variant.opacity === 1 && !wireframe;
  let made: Material|Material[]|undefined = material;
  if (!made && shape.geometry.type === 'heightmap' && shape.geometry.layers.length) {
    made = materials.terrain(shape.geometry.layers, shape.geometry.position[2], variant);
  }
  if (!made && part.own && !Materials.speaks(shape.material)) {
    const own = (one: Material) => materials.own(one, {...variant, frontOnly: frontOnly && !one.transparent});
    made = Array.isArray(part.own) ? part.own.map(own) : own(part.own);
  }
  made ??= materials.get(shape.material ?? null, variant,
    {doubleSided: shape.geometry.type !== 'box' && shape.geometry.type !== 'plane' && !frontOnly,
      pushed: part.pushed ?? false, endless: Boolean(part.endless && !shape.material?.texture)});
  return {geometry: part.geometry, material: made,
    matrix: matrixOf(shape.pose).multiply(part.matrix)};
}
