/** The rows of the World tab, in Gazebo's order, out of the document. Pure. */
import {groupsOf, membersOf} from '../model_groups.js';
import {splitScoped} from '../scoped_names.js';
import type {Model, World} from '../protocol.js';
import type {TreeRow} from '../ui/tree_view.js';

export interface Row extends TreeRow {
  /**
   * gui, scene, spherical, physics, atmosphere, wind, plugins, models,
   * lights, model, group, heading, link, joint, sensor, plugin, light, road, actor
   */
  kind: string;
  /** what a click selects: a model, `model::link` or a light */
  select?: string;
  /** the model the row belongs to */
  model?: string;
  /** of the link, joint, light, … */
  name?: string;
  /** of a plugin */
  index?: number;
  /** of a sensor: its link or joint */
  owner?: string;
}

const WORLD_ROWS = [
  ['gui', 'GUI', 'gui'],
  ['scene', 'Scene', 'scene'],
  ['spherical', 'Spherical Coordinates', 'globe'],
  ['physics', 'Physics', 'physics'],
  ['atmosphere', 'Atmosphere', 'atmosphere'],
  ['wind', 'Wind', 'wind'],
];

/**
 * @param document  the world, or null before it has come
 * @param open  ids of opened rows
 * @param wanted  only models and lights whose name contains this, in any case
 * @returns those that are visible, from top to bottom
 */
export function worldRows(document: World|null, open: Set<string>, wanted = ''): Row[] {
  if (!document) return [];
  const rows = WORLD_ROWS.map(([id, label, icon]) => leaf(id, label, icon, 1, id));
  const fits = fitting(wanted);
  const models = document.models.filter(fits);
  group(
    rows,
    open,
    'models',
    counted('Models', models, document.models),
    'model',
    models,
    (model) => modelRows(rows, open, model),
  );
  const groups = [...groupsOf(membersOf(document))];
  if (groups.length) {
    group(rows, open, 'groups', `Groups (${groups.length})`, 'group', groups, ([name, members]) =>
      rows.push({...leaf(`group:${name}`, `${name} (${members.length})`, 'group', 2, 'group'), name}));
  }
  const lights = document.lights.filter(fits);
  group(
    rows,
    open,
    'lights',
    counted('Lights', lights, document.lights),
    'light',
    lights,
    (light) =>
      rows.push({
        ...leaf(`light:${light.name}`, light.name, 'light', 2, 'light'),
        select: light.name,
        name: light.name,
      }),
  );
  for (const {key, label, kind, glyph, all} of [
    {key: 'actors', label: 'Actors', kind: 'actor', glyph: 'model', all: document.actors as {name: string}[]},
    {key: 'roads', label: 'Roads', kind: 'road', glyph: 'scene', all: document.roads},
  ]) {
    if (!all.length) continue;
    group(rows, open, key, counted(label, all, all), glyph, all, (one) =>
      rows.push({
        ...leaf(`${kind}:${one.name}`, one.name, glyph, 2, kind),
        name: one.name,
      }),
    );
  }
  const plugins = document.plugins;
  group(rows, open, 'plugins', `Plugins (${plugins.length})`, 'plugin', plugins, (plugin, index) =>
    rows.push({...leaf(`plugin::${index}`, plugin.name || plugin.filename, 'plugin', 2, 'plugin'), index}));
  return rows;
}

function fitting(wanted: string) {
  const word = wanted.trim().toLowerCase();
  return (entity: {name: string}) => !word || entity.name.toLowerCase().includes(word);
}

function counted(label: string, shown: unknown[], all: unknown[]) {
  return shown.length === all.length
    ? `${label} (${all.length})`
    : `${label} (${shown.length} of ${all.length})`;
}

/** A row without children. */
function leaf(id: string, label: string, icon: string, level: number, kind: string): Row {
  return {id, label, icon, level, kind, expandable: false, open: false};
}

function group<T extends object>(rows: Row[], open: Set<string>, id: string, label: string,
    icon: string, entities: T[], add: (entity: T, index: number) => void) {
  const opened = open.has(id);
  rows.push({...leaf(id, label, icon, 1, id), expandable: entities.length > 0, open: opened});
  if (opened) entities.forEach(add);
}

function modelRows(rows: Row[], open: Set<string>, model: Model) {
  const id = `model:${model.name}`;
  const row = {
    ...leaf(id, model.name, 'model', 2, 'model'),
    expandable: true,
    open: open.has(id),
    select: model.name,
    model: model.name,
    name: model.name,
  };
  rows.push(row);
  if (!row.open) return;
  part(rows, model, 'LINKS', 'link', model.links, (link) => ({
    select: `${model.name}::${link.name}`,
    name: link.name,
  }));
  part(rows, model, 'JOINTS', 'joint', model.joints, (joint) => ({name: joint.name}));
  part(rows, model, 'SENSORS', 'sensor', sensorsOf(model), ({sensor, owner}) => ({name: sensor.name, owner}));
  part(rows, model, 'PLUGINS', 'plugin', model.plugins, (_, index) => ({index}));
}

/** The sensors of a model, each with the name of its link or joint. */
const sensorsOf = (model: Model) => [...model.links, ...model.joints].flatMap((holder) =>
  (holder.sensors ?? []).map((sensor) => ({name: `${holder.name}::${sensor.name}`, sensor, owner: holder.name})));

function part<T extends {name: string, filename?: string}>(rows: Row[], model: Model,
    heading: string, kind: string, entities: T[], more: (entity: T, index: number) => Partial<Row>) {
  if (!entities.length) return;
  rows.push({...leaf(`${kind}s:${model.name}`, heading, '', 3, 'heading'), model: model.name});
  entities.forEach((entity, index) => {
    const name = entity.name || entity.filename || kind;
    rows.push({
      ...leaf(
        `${kind}:${model.name}::${kind === 'plugin' ? index : entity.name}`,
        name,
        kind,
        3,
        kind,
      ),
      model: model.name,
      ...more(entity, index),
    });
  });
}

/**
 * The row that stands for a selected name, and what must be open to see it.
 * @param name  model, `model::link` or light
 */
export function rowOf(document: World|null, name: string): {id: string, opens: string[]}|null {
  if (!document) return null;
  if (document.lights.some((light) => light.name === name)) {
    return {id: `light:${name}`, opens: ['lights']};
  }
  const model = modelOf(document, name);
  if (!model) return null;
  if (model.name === name) return {id: `model:${name}`, opens: ['models']};
  // A link that was just added may not have come yet.
  if (!model.links.some((link) => `${model.name}::${link.name}` === name)) return null;
  return {id: `link:${name}`, opens: ['models', `model:${model.name}`]};
}

/** The model of a name that may be scoped, `model::link::visual`; null when there is none. */
export function modelOf(document: World|null, name: string) {
  const models = document?.models ?? [];
  const [owner] = splitScoped(name, (one) => models.some((model) => model.name === one));
  return models.find((model) => model.name === owner) ?? null;
}
