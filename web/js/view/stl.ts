/** STL files as corners and normals, and simplified, without three: a worker uses it as well. Pure. */
import {coarse} from './coarse_mesh.js';
import {fillNormals} from './facet_normals.js';
import type {Shape} from './coarse_mesh.js';

/** Nine numbers a triangle each. */
type Facets = {position: Float32Array, normal: Float32Array};

/** The most triangles at rest and in a moving scene. */
export type Limits = {rest: number, moving: number};

/** `simple`: at rest, null where the limit allows all facets; `moving`: the same of that. */
export type ReadStl = {facets: Facets|null, simple: Shape|null, moving: Shape|null};

const HEADER = 84;
const RECORD = 50;
const NUMBER = '([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?|[-+]?nan|[-+]?inf)';
const FACET = new RegExp(`facet\\s+normal\\s+${`${NUMBER}\\s+`.repeat(3)}outer\\s+loop\\s+` +
  `vertex\\s+${`${NUMBER}\\s+`.repeat(3)}`.repeat(3), 'gi');

function isBinary(view: DataView, content: ArrayBuffer) {
  if (content.byteLength >= HEADER && HEADER + RECORD * view.getUint32(80, true) === content.byteLength) return true;
  // Some text files begin with a mark of their encoding.
  return !new TextDecoder('latin1').decode(content.slice(0, 10)).includes('solid');
}

/** @throws Error for a file that ends too early */
export function parseStl(content: ArrayBuffer): Facets {
  const view = new DataView(content);
  return isBinary(view, content) ? parseBinary(view) : parseText(new TextDecoder().decode(content));
}

function parseBinary(view: DataView): Facets {
  const count = view.byteLength < HEADER ? 0 : view.getUint32(80, true);
  if (view.byteLength < HEADER + RECORD * count || view.byteLength < HEADER) {
    throw new Error(`the STL file ends before the last of its ${count} triangles`);
  }
  const [position, normal] = [new Float32Array(9 * count), new Float32Array(9 * count)];
  for (let facet = 0, from = HEADER, to = 0; facet < count; facet += 1, from += RECORD) {
    const [x, y, z] = [view.getFloat32(from, true), view.getFloat32(from + 4, true), view.getFloat32(from + 8, true)];
    for (let corner = 0; corner < 3; corner += 1, to += 3) {
      const at = from + 12 + 12 * corner;
      position[to] = view.getFloat32(at, true);
      position[to + 1] = view.getFloat32(at + 4, true);
      position[to + 2] = view.getFloat32(at + 8, true);
      normal[to] = x;
      normal[to + 1] = y;
      normal[to + 2] = z;
    }
  }
  return {position, normal};
}

function parseText(text: string): Facets {
  const [position, normal]: number[][] = [[], []];
  for (const [, ...words] of text.matchAll(FACET)) {
    const [x, y, z, ...corners] = words.map(Number);
    for (const number of corners) position.push(number);
    normal.push(x, y, z, x, y, z, x, y, z);
  }
  return {position: Float32Array.from(position), normal: Float32Array.from(normal)};
}

/** @param limits  null: all triangles are wanted */
export function readStl(content: ArrayBuffer, limits: Limits|null): ReadStl {
  const facets = parseStl(content);
  fillNormals(facets.position, facets.normal);
  if (!limits) return {facets, simple: null, moving: null};
  const simple = coarse(facets.position, facets.normal, null, limits.rest);
  const {position, normal, index} = simple ?? {...facets, index: null};
  const moving = coarse(position, normal, index, limits.moving);
  return {facets: simple ? null : facets, simple, moving};
}

/** The buffers of what was read, which a worker transfers to the page. */
export const buffersOf = ({facets, simple, moving}: ReadStl): ArrayBuffer[] =>
  [facets, simple, moving].flatMap((one) => (one ? Object.values(one) : []))
    .flatMap((one) => (ArrayBuffer.isView(one) ? [one.buffer as ArrayBuffer] : []));
