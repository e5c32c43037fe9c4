/** Meshes of files with fewer triangles, as geometries of three. */
import {BufferAttribute, BufferGeometry} from 'three';
import {coarse, limitFor} from './coarse_mesh.js';
import {movingForm} from './merged_mesh.js';
import type {Material, Matrix4} from 'three';
import type {ReadStl} from './stl.js';
import type {Shape} from './coarse_mesh.js';

export interface MeshPart {
  geometry: BufferGeometry;
  /** the file's own: a three material or, for groups, a list */
  material: Material|Material[];
  /** file frame from part */
  matrix: Matrix4;
  /** of the part and the nodes above it */
  names: string[];
  /** it is the mesh in one, its parts have no names */
  whole?: boolean;
}

function indexed({position, normal, index, closed}: Shape) {
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(position, 3))
    .setAttribute('normal', new BufferAttribute(normal, 3)).setIndex(new BufferAttribute(index, 1));
  geometry.userData.closed = closed;
  return geometry;
}

/** What was read of an STL file; it is as simple as it shall be. */
export function stlGeometry({facets, simple, moving}: ReadStl) {
  const geometry = simple ? indexed(simple) : new BufferGeometry();
  if (facets) {
    geometry.setAttribute('position', new BufferAttribute(facets.position, 3))
      .setAttribute('normal', new BufferAttribute(facets.normal, 3));
  }
  if (moving) geometry.userData.moving = indexed(moving);
  geometry.userData.simplified = true;
  return geometry;
}

/**
 * A geometry with fewer triangles; null where the limit allows all of them, or it has textures, colours, several
 * materials or bones.
 */
function coarser({attributes, groups, index}: BufferGeometry, limit: number): BufferGeometry|null {
  const plain = !groups.length && Object.keys(attributes).every((name) => name === 'position' || name === 'normal');
  const {position, normal} = attributes;
  if (!plain || !(position instanceof BufferAttribute) || !(normal instanceof BufferAttribute)) return null;
  const found = coarse(position.array, normal.array, index?.array ?? null, limit);
  if (!found) return null;
  return indexed(found);
}

/** A part with a simplified geometry, and a plainer one for pictures of a moving scene. */
export function simplified(part: MeshPart, files: number): MeshPart {
  if (part.geometry.userData.simplified) return part;
  const simple = coarser(part.geometry, limitFor(files));
  if (simple) part.geometry.dispose();
  const geometry = simple ?? part.geometry;
  const moving = coarser(geometry, limitFor(files, {moving: true}));
  if (moving) geometry.userData.moving = moving;
  return {...part, geometry};
}

export function disposeOf({geometry}: MeshPart) {
  movingForm(geometry).dispose();
  geometry.dispose();
}
