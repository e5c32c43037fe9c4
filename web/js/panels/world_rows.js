/**
 * The rows of the World tab, in Gazebo's order, out of the document. Pure.
 *
 * @typedef {Object} Row
 * @property {string} id       unique in the tree, stable over edits
 * @property {string} label
 * @property {string} icon
 * @property {number} level    1 for the outermost
 * @property {string} kind     gui, scene, spherical, physics, atmosphere, wind, plugins, models,
 *   lights, model, group, heading, link, joint, sensor, plugin, light, road, actor
 * @property {boolean} expandable
 * @property {boolean} open
 * @property {string} [select] what a click selects: a model, `model::link` or a light
 * @property {string} [model]  the model the row belongs to
 * @property {string} [name]   of the link, joint, light, …
 * @property {number} [index]  of a plugin
 * @property {string} [owner]  of a sensor: its link or joint
 */

import {groupsOf} from '../model_groups.js';
import {splitScoped} from '../scoped_names.js';
/** @import {Model, World} from '../protocol.js' */

const WORLD_ROWS = [
  ['gui', 'GUI', 'gui'],
  ['scene', 'Scene', 'scene'],
  ['spherical', 'Spherical Coordinates', 'globe'],
  ['physics', 'Physics', 'physics'],
  ['atmosphere', 'Atmosphere', 'atmosphere'],
  ['wind', 'Wind', 'wind'],
];

/**
 * @param {World|null} document the world, or null before it has come
 * @param {Set<string>} open ids of opened rows
 * @param {string} [wanted] only models and lights whose name contains this, in any case
 * @returns {Row[]} those that are visible, from top to bottom
 */
export function worldRows(document, open, wanted = '') {
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
  const groups = [...groupsOf(document.models)];
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
    {key: 'actors', label: 'Actors', kind: 'actor', glyph: 'model', all: named(document.actors)},
    {key: 'roads', label: 'Roads', kind: 'road', glyph: 'scene', all: named(document.roads)},
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
  if (plugins.length) {
    group(
      rows,
      open,
      'plugins',
      `Plugins (${plugins.length})`,
      'plugin',
      plugins,
      (plugin, index) =>
        rows.push({
          ...leaf(`plugin::${index}`, plugin.name || plugin.filename, 'plugin', 2, 'plugin'),
          index,
        }),
    );
  }
  return rows;
}

/** @param {string} wanted */
function fitting(wanted) {
  const word = wanted.trim().toLowerCase();
  return (/** @type {{name: string}} */ entity) => !word || entity.name.toLowerCase().includes(word);
}

/**
 * @param {string} label
 * @param {unknown[]} shown
 * @param {unknown[]} all
 */
function counted(label, shown, all) {
  return shown.length === all.length
    ? `${label} (${all.length})`
    : `${label} (${shown.length} of ${all.length})`;
}

/**
 * A row without children.
 * @param {string} id
 * @param {string} label
 * @param {string} icon
 * @param {number} level
 * @param {string} kind
 * @returns {Row}
 */
function leaf(id, label, icon, level, kind) {
  return {id, label, icon, level, kind, expandable: false, open: false};
}

/**
 * @template {object} T
 * @param {Row[]} rows
 * @param {Set<string>} open
 * @param {string} id
 * @param {string} label
 * @param {string} icon
 * @param {T[]} entities
 * @param {(entity: T, index: number) => void} add
 */
function group(rows, open, id, label, icon, entities, add) {
  const opened = open.has(id);
  rows.push({...leaf(id, label, icon, 1, id), expandable: entities.length > 0, open: opened});
  if (opened) entities.forEach(add);
}

/**
 * @param {Row[]} rows
 * @param {Set<string>} open
 * @param {Model} model
 */
function modelRows(rows, open, model) {
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
  part(rows, model, 'PLUGINS', 'plugin', model.plugins, (plugin, index) => ({index}));
}

/** The sensors of a model, each with the name of its link or joint. @param {Model} model */
const sensorsOf = (model) => [...model.links, ...model.joints].flatMap((holder) =>
  (holder.sensors ?? []).map((sensor) => ({name: `${holder.name}::${sensor.name}`, sensor, owner: holder.name})));

/**
 * @template {{name: string, filename?: string}} T
 * @param {Row[]} rows
 * @param {Model} model
 * @param {string} heading
 * @param {string} kind
 * @param {T[]} entities
 * @param {(entity: T, index: number) => Partial<Row>} more
 */
function part(rows, model, heading, kind, entities, more) {
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
 *
 * @param {World|null} document
 * @param {string} name model, `model::link` or light
 * @returns {{id: string, opens: string[]}|null}
 */
export function rowOf(document, name) {
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

/**
 * The model of a name that may be scoped, `model::link::visual`; null when there is none.
 * @param {World|null} document
 * @param {string} name
 */
export function modelOf(document, name) {
  const models = document?.models ?? [];
  const [owner] = splitScoped(name, (one) => models.some((model) => model.name === one));
  return models.find((model) => model.name === owner) ?? null;
}

/** Entities of which only the names are shown. @param {{name: string}[]} entities */
function named(entities) {
  return entities;
}
