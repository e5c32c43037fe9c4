/**
 * Which sections the property panel shows for a row of the World tab. Pure.
 */
import * as table from './property_fields.js';
import {geometryFields} from './geometry_fields.js';
import {bodySections} from './model_sections.js';
import {pluginFields} from './plugin_fields.js';
import {newSensors, removal, sensorSections} from './sensor_fields.js';
/** @import {Field, Section} from './property_fields.js' */
/** @import {Row} from './world_rows.js' */
/** @import {World} from '../protocol.js' */

/**
 * A section whose fields' paths begin below `prefix` of its target.
 * @typedef {Section & {prefix: string}} BareSection
 */
/** The heading and sections of a row. @typedef {{title: string, sections: Section[]}} Found */

/**
 * @param {World|null} document
 * @param {Row|null} row
 * @returns {Found|null} null where
 *   the row has no properties, or what it stood for has gone
 */
export function sectionsOf(document, row) {
  const make = row && document ? KINDS[row.kind] : undefined;
  const made = make && row && document ? make(document, row) : null;
  if (!made || !row) return null;
  const sections = made
    .filter((section) => section.entity)
    .map((section) => ({...section, fields: present(section)}))
    .filter((section) => section.fields.length);
  return {title: titleOf(row), sections};
}

/** @param {Row} row */
function titleOf(row) {
  if (row.kind === 'model' || row.kind === 'light') return row.name ?? '';
  return row.model && row.name ? `${row.model}::${row.name}` : row.label;
}

/**
 * @param {string} title
 * @param {string} target
 * @param {object|null|undefined} entity
 * @param {Field[]} fields
 * @param {string} [prefix]
 * @returns {BareSection}
 */
const section = (title, target, entity, fields, prefix = '') => ({
  key: `${target}|${title}`,
  title,
  target,
  entity,
  fields,
  prefix,
});

/**
 * A field of an entity that has no such member is not for this version of the server.
 * @param {BareSection} bareSection
 */
function present({entity, fields, prefix}) {
  return fields
    .filter((field) => valueAt(entity, field.path) !== undefined)
    .map((field) => ({...field, local: field.path, path: prefix + field.path}));
}

/**
 * The value at a dotted path, undefined where there is none.
 * @param {unknown} entity
 * @param {string} path
 * @returns {unknown}
 */
export function valueAt(entity, path) {
  /** @type {unknown} */
  let value = entity;
  for (const key of path.split('.')) {
    if (typeof value !== 'object' || value === null) return undefined;
    value = /** @type {Record<string, unknown>} */ (value)[key];
  }
  return value;
}

/**
 * The entity of a name, or undefined.
 * @template {{name: string}} T
 * @param {T[]|undefined} list
 * @param {string|undefined} name
 * @returns {T|undefined}
 */
const named = (list, name) => (list ?? []).find((entity) => entity.name === name);

/**
 * By kind of row; null: there are none, or the entity is gone.
 * @type {Record<string, (world: World, row: Row) => BareSection[]|null|undefined>}
 */
const KINDS = {
  gui: (world) => [
    section('', '', world, table.GUI),
    section('Camera', '', world.gui_camera, table.GUI_CAMERA, 'gui_camera.'),
  ],
  scene: (world) => [
    section('', '', world.scene, table.SCENE, 'scene.'),
    section('Sky', '', world.scene.sky, table.SKY, 'scene.sky.'),
    section('Fog', '', world.scene.fog, table.FOG, 'scene.fog.'),
  ],
  spherical: (world) => [
    section('', '', world, table.GLOBE),
    section('Origin', '', world.spherical_coordinates, table.SPHERICAL, 'spherical_coordinates.'),
  ],
  physics: (world) => [
    section('', '', world.physics, table.PHYSICS, 'physics.'),
    section('World', '', world, table.WORLD_PHYSICS),
    section('Solver', '', world.physics.ode, table.ODE, 'physics.ode.'),
  ],
  atmosphere: (world) => [section('', '', world.atmosphere, table.ATMOSPHERE, 'atmosphere.')],
  wind: (world) => [section('', '', world.wind, table.WIND, 'wind.')],
  model: (world, row) => {
    const model = named(world.models, row.model);
    return model && [section('', model.name, model, table.MODEL),
      ...bodySections(model).map((one) => ({...one, prefix: ''}))];
  },
  link: linkSections,
  joint: (world, row) => {
    const model = named(world.models, row.model);
    const joint = model && named(model.joints, row.name);
    if (!joint) return null;
    const target = `${model.name}::${joint.name}`;
    const axes = table.axisFields(joint);
    return [
      section('', target, joint, table.JOINT),
      section('Axis', target, joint.axis, axes, 'axis.'),
      section('Second axis', target, joint.axis2, axes, 'axis2.'),
    ];
  },
  sensor: (world, row) => {
    const model = named(world.models, row.model);
    const holder = model && [...model.links, ...model.joints].find(({name, sensors}) =>
      name === row.owner && sensors?.some((one) => one.name === row.name));
    const sensor = holder && named(holder.sensors, row.name);
    if (!model || !sensor) return null;
    const target = `${model.name}::${row.owner}::sensor:${sensor.name}`;
    return [removal(sensor, target), ...sensorSections(sensor, target)].map((one) => ({...one, prefix: ''}));
  },
  plugin: (world, row) => {
    const model = named(world.models, row.model);
    const index = row.index ?? -1;
    const plugin = (model ?? world).plugins[index];
    if (!model || !plugin) return [section('', '', plugin, table.PLUGIN)];
    const {entity, fields} = pluginFields(model, index);
    return [section('', '', plugin, table.PLUGIN.slice(0, 2)), section('Parameters', '', entity, fields),
      section('Source', '', plugin, table.PLUGIN.slice(2))];
  },
  light: (world, row) => {
    const light = named(world.lights, row.name);
    return light && [section('', light.name, light, table.lightFields(light))];
  },
};

/** @param {World} world @param {Row} row */
function linkSections(world, row) {
  const model = named(world.models, row.model);
  const link = model && named(model.links, row.name);
  if (!link) return null;
  const target = `${model.name}::${link.name}`;
  const canonical = model.links[0] === link;
  const sections = [
    section(
      '',
      target,
      link,
      table.LINK.map((field) =>
        field.path === 'pose' && canonical ? {...field, hint: 'relative to the model'} : field,
      ),
    ),
    section('Inertial', target, link.inertial, table.INERTIAL, 'inertial.'),
    {...newSensors(target), prefix: ''},
  ];
  // A collision and a visual may share a name: the target says which is meant.
  for (const collision of link.collisions) {
    const exact = `${target}::collision:${collision.name}`;
    sections.push(
      section(partTitle('Collision', collision.name), exact, collision, [
        ...table.COLLISION,
        ...geometryFields(collision.geometry),
      ]),
    );
    sections.push(
      section(`Surface of ${collision.name}`, exact, collision.surface, table.SURFACE, 'surface.'),
    );
  }
  for (const visual of link.visuals) {
    const exact = `${target}::visual:${visual.name}`;
    sections.push(
      section(partTitle('Visual', visual.name), exact, visual, [
        ...table.VISUAL,
        ...geometryFields(visual.geometry),
      ]),
    );
    sections.push(
      section(`Material of ${visual.name}`, exact, visual.material, [
        {...table.MATERIAL[1], label: 'color', hint: 'ambient and diffuse together',
          ops: (value) => ({label: `Set color of ${exact.replace('::visual:', '::')}`, ops: ['ambient',
            'diffuse'].map((path) => ({kind: 'set', target: exact, path: `material.${path}`, value}))})},
        ...table.MATERIAL,
      ], 'material.'),
    );
  }
  return sections;
}

/** The kind with the name, which is often the same word. @param {string} kind @param {string} name */
const partTitle = (kind, name) => (name.toLowerCase() === kind.toLowerCase() ? kind : `${kind} ${name}`);
