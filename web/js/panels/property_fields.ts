/** What the property panel shows of each kind of row: sections of fields, as data. Pure. */
import type {Joint, Light, Operation} from '../protocol.js';

export interface Field {
  /** dotted path within the entity, as the `set` operation takes it */
  path: string;
  label: string;
  type: 'number'|'integer'|'text'|'flag'|'color'|'vector'|'pose'|'choice'|'optional'|'xml'|'button';
  unit?: string;
  /** labels of a vector's numbers */
  parts?: string[];
  choices?: readonly string[];
  /** shown, not editable */
  fixed?: boolean|undefined;
  /** what a number must be greater than */
  above?: number;
  min?: number;
  max?: number;
  hint?: string;
  /** what an optional one becomes when it is switched on */
  initial?: unknown;
  /** a change renames the entity */
  rename?: boolean;
  /** the path within the section's entity */
  local?: string;
  /**
   * what a new value does,
   * where it is more than one property
   */
  ops?: (value: unknown) => {label: string, ops: Operation[]};
}
export interface Section {
  key: string;
  /** '' for the first one, which has no heading */
  title: string;
  /** of its `set` operations */
  target: string;
  /** that the paths begin at */
  entity: object|null|undefined;
  fields: Field[];
  /** of the paths in `set` operations */
  prefix?: string;
}

const field = (path: string, label: string, type: Field['type'], more: Partial<Field> = {}): Field =>
    ({path, label, type, ...more});
const number = (path: string, label: string, unit = '', more: Partial<Field> = {}) =>
    field(path, label, 'number', {unit, ...more});
const flag = (path: string, label: string, more: Partial<Field> = {}) => field(path, label, 'flag',
    more);
const color = (path: string, label: string) => field(path, label, 'color');
const vector = (path: string, label: string, unit = '', more: Partial<Field> = {}) =>
  field(path, label, 'vector', {parts: ['x', 'y', 'z'], unit, ...more});
const fixed = (path: string, label: string, type: Field['type'] = 'text', more: Partial<Field> = {}) =>
  field(path, label, type, {fixed: true, ...more});

/** A switch for what may be absent: on puts `initial` there, off takes it away. */
const optional = (path: string, label: string, initial: unknown) => field(path, label, 'optional',
    {initial});

const NAME = fixed('name', 'name');
const NEW_NAME = field('name', 'name', 'text', {rename: true});
const POSE = field('pose', 'pose', 'pose', {unit: 'm, rad'});
const NOT_NEGATIVE = {min: 0};

export const GUI = [optional('gui_camera', 'GUI camera', {})];

export const GUI_CAMERA = [
  fixed('name', 'name'),
  POSE,
  field('view_controller', 'view control', 'choice', {choices: ['orbit', 'fps', 'ortho']}),
  field('projection_type', 'projection', 'choice', {choices: ['perspective', 'orthographic']}),
  field('track', 'track visual', 'text', {hint: 'name of the model that the camera follows'}),
  flag('track_static', 'track: static'),
  flag('track_use_model_frame', 'track: use model frame'),
  flag('track_inherit_yaw', 'track: inherit yaw'),
  vector('track_xyz', 'track: position', 'm'),
  number('track_min_dist', 'track: min distance', 'm', NOT_NEGATIVE),
  number('track_max_dist', 'track: max distance', 'm', NOT_NEGATIVE),
];

export const SCENE = [
  color('ambient', 'ambient'),
  color('background', 'background'),
  flag('shadows', 'shadows'),
  flag('grid', 'grid'),
  flag('origin_visual', 'origin visual'),
  optional('sky', 'sky', {}),
  optional('fog', 'fog', {type: 'linear'}),
];

export const SKY = [
  number('time', 'time of day', 'h', {min: 0, max: 24}),
  number('sunrise', 'sunrise', 'h', {min: 0, max: 24}),
  number('sunset', 'sunset', 'h', {min: 0, max: 24}),
  number('cloud_speed', 'cloud speed', 'm/s', NOT_NEGATIVE),
  number('cloud_direction', 'cloud direction', 'rad'),
  number('cloud_humidity', 'cloud humidity', '', {min: 0, max: 1}),
  number('cloud_mean_size', 'cloud mean size', '', {min: 0, max: 1}),
  color('cloud_ambient', 'cloud ambient'),
];

export const FOG = [
  field('type', 'type', 'choice', {choices: ['none', 'linear', 'exp', 'exp2', 'constant', 'quadratic']}),
  color('color', 'color'),
  number('start', 'start', 'm', NOT_NEGATIVE),
  number('end', 'end', 'm', NOT_NEGATIVE),
  number('density', 'density', '', NOT_NEGATIVE),
];

export const GLOBE = [optional('spherical_coordinates', 'spherical coordinates', {})];

export const SPHERICAL = [
  field('surface_model', 'surface model', 'choice', {choices: ['EARTH_WGS84']}),
  number('latitude_deg', 'latitude', '°', {min: -90, max: 90}),
  number('longitude_deg', 'longitude', '°', {min: -180, max: 180}),
  number('elevation', 'elevation', 'm'),
  number('heading_deg', 'heading', '°'),
];

export const PHYSICS = [
  fixed('type', 'engine'),
  number('real_time_update_rate', 'real time update rate', '1/s', NOT_NEGATIVE),
  number('max_step_size', 'max step size', 's', {above: 0}),
];

export const WORLD_PHYSICS = [
  vector('gravity', 'gravity', 'm/s²'),
  vector('magnetic_field', 'magnetic field', 'T'),
];

export const ODE = [
  field('iters', 'solver iterations', 'integer', {min: 1}),
  number('sor', 'SOR', '', NOT_NEGATIVE),
  number('cfm', 'constraints CFM', '', NOT_NEGATIVE),
  number('erp', 'constraints ERP', '', {min: 0, max: 1}),
  number('contact_max_correcting_vel', 'max velocity', 'm/s', NOT_NEGATIVE),
  number('contact_surface_layer', 'surface layer', 'm', NOT_NEGATIVE),
  field('max_contacts', 'max contacts', 'integer', NOT_NEGATIVE),
  flag('auto_disable_bodies', 'auto disable bodies'),
];

export const ATMOSPHERE = [
  fixed('type', 'type'),
  number('temperature', 'temperature', 'K', {above: 0}),
  number('pressure', 'pressure', 'Pa', NOT_NEGATIVE),
  number('temperature_gradient', 'temperature gradient', 'K/m'),
];

export const WIND = [vector('linear_velocity', 'linear velocity', 'm/s')];

export const MODEL = [
  NEW_NAME,
  POSE,
  flag('static', 'static'),
  flag('self_collide', 'self collide'),
  flag('allow_auto_disable', 'allow auto disable'),
  flag('enable_wind', 'enable wind'),
];

export const LINK = [
  NAME,
  POSE,
  flag('gravity', 'gravity'),
  flag('kinematic', 'kinematic'),
  flag('self_collide', 'self collide'),
];

export const INERTIAL = [
  number('mass', 'mass', 'kg', {above: 0}),
  POSE,
  number('ixx', 'ixx', 'kg m²', NOT_NEGATIVE),
  number('ixy', 'ixy', 'kg m²'),
  number('ixz', 'ixz', 'kg m²'),
  number('iyy', 'iyy', 'kg m²', NOT_NEGATIVE),
  number('iyz', 'iyz', 'kg m²'),
  number('izz', 'izz', 'kg m²', NOT_NEGATIVE),
];

export const COLLISION = [
  NAME,
  POSE,
  field('max_contacts', 'max contacts', 'integer', NOT_NEGATIVE),
  number('laser_retro', 'laser retro'),
];

export const SURFACE = [
  number('mu', 'friction mu', '', NOT_NEGATIVE),
  number('mu2', 'friction mu2', '', NOT_NEGATIVE),
  vector('fdir1', 'friction direction'),
  number('slip1', 'slip1', '', NOT_NEGATIVE),
  number('slip2', 'slip2', '', NOT_NEGATIVE),
  number('torsion', 'torsional friction', '', NOT_NEGATIVE),
  number('patch_radius', 'patch radius', 'm', NOT_NEGATIVE),
  number('restitution', 'restitution', '', {min: 0, max: 1}),
  number('bounce_threshold', 'bounce threshold', 'm/s', NOT_NEGATIVE),
  number('kp', 'contact kp', 'N/m', NOT_NEGATIVE),
  number('kd', 'contact kd', 'N s/m', NOT_NEGATIVE),
  number('max_vel', 'contact max velocity', 'm/s', NOT_NEGATIVE),
  number('min_depth', 'contact min depth', 'm', NOT_NEGATIVE),
];

export const VISUAL = [
  NAME,
  POSE,
  number('transparency', 'transparency', '', {min: 0, max: 1}),
  flag('cast_shadows', 'cast shadows'),
  optional('material', 'material', {ambient: [0.5, 0.5, 0.5, 1], diffuse: [0.7, 0.7, 0.7, 1]}),
];

export const MATERIAL = ['ambient', 'diffuse', 'specular', 'emissive'].map((path) =>
  color(path, path),
);

export const JOINT = [
  NAME,
  fixed('type', 'type'),
  fixed('parent', 'parent'),
  fixed('child', 'child'),
  field('pose', 'pose', 'pose', {fixed: true, unit: 'm, rad', hint: 'relative to the child link'}),
];

/** The fields of an axis, for rad or m. */
export function axisFields(joint: Joint) {
  const linear = joint.type === 'prismatic';
  const [length, force] = linear ? ['m', 'N'] : ['rad', 'N m'];
  return [
    vector('xyz', 'axis'),
    number('lower', 'lower limit', length),
    number('upper', 'upper limit', length),
    number('effort', 'effort limit', force, {hint: '-1: no limit'}),
    number('velocity', 'velocity limit', `${length}/s`, {hint: '-1: no limit'}),
    number('damping', 'damping', `${force} s/${length}`, NOT_NEGATIVE),
    number('friction', 'friction', force, NOT_NEGATIVE),
    number('spring_reference', 'spring reference', length),
    number('spring_stiffness', 'spring stiffness', `${force}/${length}`, NOT_NEGATIVE),
  ];
}

const LIGHT_TYPES = ['point', 'spot', 'directional'];

/** The fields of a light: its type decides. */
export function lightFields(light: Light) {
  const far =
    light.type === 'directional'
      ? []
      : [
          number('range', 'range', 'm', NOT_NEGATIVE),
          number('constant', 'attenuation constant', '', NOT_NEGATIVE),
          number('linear', 'attenuation linear', '1/m', NOT_NEGATIVE),
          number('quadratic', 'attenuation quadratic', '1/m²', NOT_NEGATIVE),
        ];
  const spot =
    light.type !== 'spot'
      ? []
      : [
          number('inner_angle', 'spot inner angle', 'rad', {min: 0, max: Math.PI}),
          number('outer_angle', 'spot outer angle', 'rad', {min: 0, max: Math.PI}),
          number('falloff', 'spot falloff', '', NOT_NEGATIVE),
        ];
  return [
    NEW_NAME,
    field('type', 'type', 'choice', {choices: LIGHT_TYPES}),
    POSE,
    color('diffuse', 'diffuse'),
    color('specular', 'specular'),
    ...far,
    ...(light.type === 'point' ? [] : [vector('direction', 'direction')]),
    ...spot,
    flag('cast_shadows', 'cast shadows'),
  ];
}

export const PLUGIN = [
  fixed('name', 'name'),
  fixed('filename', 'file'),
];
