/** The fields of each kind of geometry, with paths below `geometry`. Pure. */
import type {Field} from './property_fields.js';

const positive: Partial<Field> = {above: 0};
const number = (name: string, label: string, unit = 'm', more: Partial<Field> = positive):
    Field => ({
  path: `geometry.${name}`,
  label,
  type: 'number',
  unit,
  ...more,
});
const vector = (name: string, label: string, parts: string[], unit = 'm',
    more: Partial<Field> = {}): Field => ({
  path: `geometry.${name}`,
  label,
  type: 'vector',
  parts,
  unit,
  ...more,
});
const fixed = (name: string, label: string, type: Field['type'] = 'text', more: Partial<Field> = {}):
    Field => ({
  path: `geometry.${name}`,
  label,
  type,
  fixed: true,
  ...more,
});

const XYZ = ['x', 'y', 'z'];
const RADIUS_LENGTH = [number('radius', 'radius'), number('length', 'length')];

const TABLE: Record<string, Field[]> = {
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
const UNIT: Record<string, object> = {
  box: {size: [1, 1, 1]},
  sphere: {radius: 0.5},
  cylinder: {radius: 0.5, length: 1},
  capsule: {radius: 0.5, length: 1},
  cone: {radius: 0.5, length: 1},
  ellipsoid: {radii: [0.5, 0.5, 0.5]},
};

/** Whether numbers alone define the shape. */
export const isSimple = (type: string) => type in UNIT;

/** A simple shape of unit size. */
export function unitGeometry(type: string) {
  return {type, ...UNIT[type]};
}

export function geometryFields(geometry: {type: string}): Field[] {
  const simple = isSimple(geometry.type);
  const type: Field = {
    path: 'geometry.type',
    label: 'geometry',
    type: simple ? 'choice' : 'text',
    choices: Object.keys(UNIT),
    fixed: !simple,
  };
  return [type, ...(TABLE[geometry.type] ?? [])];
}
