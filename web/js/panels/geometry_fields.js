/** The fields of each kind of geometry, with paths below `geometry`. Pure. */
/** @import {Field} from './property_fields.js' */

/** @type {Partial<Field>} */
const positive = {above: 0};
/**
 * @param {string} name
 * @param {string} label
 * @param {string} [unit]
 * @param {Partial<Field>} [more]
 * @returns {Field}
 */
const number = (name, label, unit = 'm', more = positive) => ({
  path: `geometry.${name}`,
  label,
  type: 'number',
  unit,
  ...more,
});
/**
 * @param {string} name
 * @param {string} label
 * @param {string[]} parts
 * @param {string} [unit]
 * @param {Partial<Field>} [more]
 * @returns {Field}
 */
const vector = (name, label, parts, unit = 'm', more = {}) => ({
  path: `geometry.${name}`,
  label,
  type: 'vector',
  parts,
  unit,
  ...more,
});
/**
 * @param {string} name
 * @param {string} label
 * @param {Field['type']} [type]
 * @param {Partial<Field>} [more]
 * @returns {Field}
 */
const fixed = (name, label, type = 'text', more = {}) => ({
  path: `geometry.${name}`,
  label,
  type,
  fixed: true,
  ...more,
});

const XYZ = ['x', 'y', 'z'];
const RADIUS_LENGTH = [number('radius', 'radius'), number('length', 'length')];

/** @type {Record<string, Field[]>} */
const TABLE = {
  box: [vector('size', 'size', XYZ, 'm', positive)],
  sphere: [number('radius', 'radius')],
  cylinder: RADIUS_LENGTH,
  capsule: RADIUS_LENGTH,
  cone: RADIUS_LENGTH,
  ellipsoid: [vector('radii', 'radii', XYZ, 'm', positive)],
  plane: [vector('normal', 'normal', XYZ, ''), vector('size', 'size', ['x', 'y'], 'm', positive)],
  mesh: [
    fixed('uri', 'file'),
    vector('scale', 'scale', XYZ, ''),
    fixed('submesh', 'submesh'),
    fixed('center', 'center submesh', 'flag'),
  ],
  heightmap: [
    fixed('uri', 'file'),
    vector('size', 'size', XYZ, 'm', positive),
    vector('position', 'position', XYZ),
  ],
  polyline: [number('height', 'height')],
  image: [
    fixed('uri', 'file'),
    number('scale', 'scale', 'm/pixel'),
    {path: 'geometry.threshold', label: 'threshold', type: 'integer', min: 0, max: 255},
    number('height', 'height'),
    {path: 'geometry.granularity', label: 'granularity', type: 'integer', min: 1},
  ],
  empty: [],
};

/** What a shape may be turned into by choosing another type: those that need no file. */
const SIMPLE = ['box', 'sphere', 'cylinder', 'capsule', 'cone', 'ellipsoid'];

/** @type {Record<string, object>} */
const UNIT = {
  box: {size: [1, 1, 1]},
  sphere: {radius: 0.5},
  cylinder: {radius: 0.5, length: 1},
  capsule: {radius: 0.5, length: 1},
  cone: {radius: 0.5, length: 1},
  ellipsoid: {radii: [0.5, 0.5, 0.5]},
};

/** A simple shape of unit size. @param {string} type */
export function unitGeometry(type) {
  return {type, ...UNIT[type]};
}

/**
 * @param {{type: string}} geometry
 * @returns {import('./property_fields.js').Field[]}
 */
export function geometryFields(geometry) {
  const simple = SIMPLE.includes(geometry.type);
  /** @type {Field} */
  const type = {
    path: 'geometry.type',
    label: 'geometry',
    type: simple ? 'choice' : 'text',
    choices: SIMPLE,
    fixed: !simple,
  };
  return [type, ...(TABLE[geometry.type] ?? [])];
}
