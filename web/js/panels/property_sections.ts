/**
 * Which sections the property panel shows for a row of the World tab. Pure.
 */
import * as table from './property_fields.js';
import {geometryFields} from './geometry_fields.js';
import {groupsOf, membersOf} from '../model_groups.js';
import {bodySections} from './model_sections.js';
import {newPluginFields, pluginFields, pluginOwner, removalField, sourceField} from './plugin_fields.js';
import {newSensors, removal, sensorSections} from './sensor_fields.js';
import type {Field, Section} from './property_fields.js';
import type {Row} from './world_rows.js';
import type {World} from '../protocol.js';

/** The heading and sections of a row. */
export type Found = {title: string, sections: Section[]};

/**
 * @returns null where
 * the row has no properties, or what it stood for has gone
 */
export function sectionsOf(document: World|null, row: Row|null): Found|null {
  const make = row && document ? KINDS[row.kind] : undefined;
  const made = make && row && document ? make(document, row) : null;
  if (!made || !row) return null;
  const sections = made
    .filter((section) => section.entity)
    .map((section) => ({...section, fields: present(section)}))
    .filter((section) => section.fields.length);
  return {title: titleOf(row), sections};
}

function titleOf(row: Row) {
  if (row.kind === 'model' || row.kind === 'light') return row.name ?? '';
  return row.model && row.name ? `${row.model}::${row.name}` : row.label;
}

const section = (title: string, target: string, entity: object|null|undefined, fields: Field[],
    prefix = ''): Section => ({key: `${target}|${title}`, title, target, entity, fields, prefix});

/** A field of an entity that has no such member is not for this version of the server. */
function present({entity, fields, prefix = ''}: Section) {
  return fields
    .filter((field) => valueAt(entity, field.path) !== undefined)
    .map((field) => ({...field, local: field.path, path: prefix + field.path}));
}

/** The value at a dotted path, undefined where there is none. */
export function valueAt(entity: unknown, path: string): unknown {
  let value: unknown = entity;
  for (const key of path.split('.')) {
    if (typeof value !== 'object' || value === null) return undefined;
    value = (value as Record<string, unknown>)[key];
  }
  return value;
}

/** The entity of a name, or undefined. */
const named = <T extends {name: string}>(list: T[]|undefined, name: string|undefined): T|undefined =>
    (list ?? []).find((entity) => entity.name === name);

/** By kind of row; null: there are none, or the entity is gone. */
const KINDS: Record<string, (world: World, row: Row) => Section[]|null|undefined> = {
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
    return model && [section('', model.name, model, table.MODEL), ...bodySections(model)];
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
    return [removal(sensor, target), ...sensorSections(sensor, target)];
  },
  plugins: (world) => {
    const {entity, fields} = newPluginFields({name: '', plugins: world.plugins});
    return [section('', '', entity, fields)];
  },
  plugin: (world, row) => {
    const owner = pluginOwner(world, row.model ?? '');
    const index = row.index ?? -1;
    const plugin = owner?.plugins[index];
    if (!owner || !plugin) return null;
    const {entity, fields} = pluginFields(owner, index);
    return [section('', '', {...plugin, remove: null}, [...table.PLUGIN, removalField(owner, index)]),
      section('Parameters', '', entity, fields),
      section('Source', '', plugin, [sourceField(owner, index)])];
  },
  group: (world, row) => {
    const names = groupsOf(membersOf(world)).get(row.name ?? '');
    return names && [section('', '', {group: row.name}, [{path: 'group', label: 'name', type: 'text',
      ops: (value) => ({label: `Rename group ${row.name} to ${value}`, ops: [{kind: 'set_group', names, group: String(value)}]})}])];
  },
  light: (world, row) => {
    const light = named(world.lights, row.name);
    return light && [section('', light.name, light, table.lightFields(light))];
  },
};

function linkSections(world: World, row: Row) {
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
    newSensors(target),
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

/** The kind with the name, which is often the same word. */
const partTitle = (kind: string, name: string) =>
    (name.toLowerCase() === kind.toLowerCase() ? kind : `${kind} ${name}`);
