/**
 * What a model's own panel shows of its body: mass, size, colour, and one panel for several models.
 * A field may stand for several properties: its `ops` say what a new value does. Pure.
 */
import {sevenOf, sixOf} from './pose_rpy.js';
/** @import {Field, Section} from './property_fields.js' */
/** @import {Geometry, Link, Material, Model, Operation} from '../protocol.js' */

const GREY = {ambient: [0.7, 0.7, 0.7, 1], diffuse: [0.7, 0.7, 0.7, 1]};
/** Fields of a shape's size, by its type: path and what `geometry_fields` says of it. */
const SIZES = {
  box: [{name: 'size', label: 'size', type: 'vector', parts: ['x', 'y', 'z']}],
  sphere: [{name: 'radius', label: 'radius', type: 'number'}],
  cylinder: [{name: 'radius', label: 'radius', type: 'number'},
    {name: 'length', label: 'length', type: 'number'}],
  capsule: [{name: 'radius', label: 'radius', type: 'number'},
    {name: 'length', label: 'length', type: 'number'}],
  cone: [{name: 'radius', label: 'radius', type: 'number'},
    {name: 'length', label: 'length', type: 'number'}],
  ellipsoid: [{name: 'radii', label: 'radii', type: 'vector', parts: ['x', 'y', 'z']}],
};

/** @param {string} target @param {string} path @param {unknown} value @returns {Operation} */
const set = (target, path, value) => ({kind: 'set', target, path, value});

/** @param {Link} link @param {string} model */
const linkTarget = (link, model) => `${model}::${link.name}`;

/** The colour of a material, as one: what the sun shows. @param {Material|null|undefined} material */
const colourOf = (material) => material?.diffuse ?? material?.ambient ?? null;

/**
 * What gives all visuals of a model one colour, ambient and diffuse together.
 * @param {Model} model
 * @param {unknown} colour
 */
function colourOps(model, colour) {
  return model.links.flatMap((link) => link.visuals.flatMap((visual) => {
    const target = `${linkTarget(link, model.name)}::visual:${visual.name}`;
    return visual.material
      ? [set(target, 'material.ambient', colour), set(target, 'material.diffuse', colour)]
      : [set(target, 'material', {...GREY, ambient: colour, diffuse: colour})];
  }));
}

/** The geometry that visual and collision share; null where they differ. @param {Link} link */
function sharedGeometry(link) {
  if (link.collisions.length !== 1 || link.visuals.length !== 1) return null;
  const [{geometry: solid}] = link.collisions;
  const [{geometry: seen}] = link.visuals;
  return solid.type === seen.type && solid.type in SIZES ? solid : null;
}

/** The one value that all have, null where they differ. @param {unknown[]} values */
function common(values) {
  const [first] = values;
  return values.every((value) => JSON.stringify(value) === JSON.stringify(first)) ? first ?? null : null;
}

/**
 * Mass, size and colour of a model with one link; the mass of others.
 * @param {Model} model
 * @returns {Section[]}
 */
export function bodySections(model) {
  const {name, links} = model;
  if (!links.length) return [];
  /** @type {Field[]} */
  const fields = [];
  /** @type {Record<string, unknown>} */
  const entity = {};
  const mass = links.reduce((sum, {inertial}) => sum + inertial.mass, 0);
  if (!model.static) {
    entity.mass = mass;
    fields.push({path: 'mass', label: links.length > 1 ? 'total mass' : 'mass', type: 'number',
      unit: 'kg', above: 0, fixed: links.length > 1,
      ops: (value) => ({label: `Set mass of ${name} to ${value}`,
        ops: massOps(links[0], name, Number(value))})});
  }
  const shared = links.length === 1 ? sharedGeometry(links[0]) : null;
  if (shared) fields.push(...sizeFields(model, shared, entity));
  if (links.some(({visuals}) => visuals.length)) {
    entity.color = common(links.flatMap(({visuals}) => visuals.map(({material}) =>
      colourOf(material))));
    fields.push({path: 'color', label: 'color', type: 'color',
      hint: 'ambient and diffuse color of all visuals',
      ops: (value) => ({label: `Set color of ${name}`, ops: colourOps(model, value)})});
  }
  if (!model.static && links.some(({collisions}) => collisions.length)) {
    entity.inertia = null;
    fields.push({path: 'inertia', label: 'Compute inertia', type: 'button',
      hint: 'Inertia of the mass from the collision shapes, at uniform density',
      ops: () => ({label: `Compute inertia of ${name}`,
        ops: links.filter(({collisions}) => collisions.length).map((link) => (
          {kind: 'compute_inertial', target: linkTarget(link, name)}))})});
  }
  return [{key: `${name}|Body`, title: 'Body', target: name, entity, fields}];
}

/**
 * A body of the same shape with another mass has its inertia in proportion.
 * @param {Link} link
 * @param {string} model
 * @param {number} mass
 * @returns {Operation[]}
 */
function massOps(link, model, mass) {
  const {inertial} = link;
  const factor = inertial.mass > 0 ? mass / inertial.mass : 1;
  const scaled = Object.fromEntries(Object.entries(inertial).map(([key, value]) =>
    [key, typeof value === 'number' ? value * factor : value]));
  return [set(linkTarget(link, model), 'inertial', {...scaled, mass})];
}

/**
 * @param {Model} model
 * @param {Geometry} shared
 * @param {Record<string, unknown>} entity  gets the values
 * @returns {Field[]}
 */
function sizeFields(model, shared, entity) {
  const [link] = model.links;
  const target = linkTarget(link, model.name);
  return SIZES[/** @type {keyof typeof SIZES} */ (shared.type)].map(({name, ...look}) => {
    entity[name] = /** @type {Record<string, unknown>} */ (/** @type {unknown} */ (shared))[name];
    return /** @type {Field} */ ({path: name, ...look, unit: 'm', above: 0,
      /** @param {unknown} value */
      ops: (value) => ({label: `Set ${name} of ${model.name}`, ops: [
        set(`${target}::collision:${link.collisions[0].name}`, `geometry.${name}`, value),
        set(`${target}::visual:${link.visuals[0].name}`, `geometry.${name}`, value),
        ...(model.static ? [] : [{kind: 'compute_inertial', target}]),
      ]})});
  });
}

/**
 * What several selected models have in common; a field that is empty differs among them.
 * @param {Model[]} models
 * @param {(name: string) => number[]|null} poseOf  where a model is now
 * @returns {{title: string, sections: Section[]}}
 */
export function sharedSections(models, poseOf) {
  const count = `${models.length} models`;
  const poses = models.map(({name, pose}) => sixOf(poseOf(name) ?? pose));
  /** @param {'static'|'self_collide'|'allow_auto_disable'|'enable_wind'} path */
  const flag = (path) => /** @type {Field} */ ({path, label: path.replaceAll('_', ' '),
    type: 'flag', ops: (value) => ({label: `Set ${path.replaceAll('_', ' ')} of ${count}`,
      ops: models.map(({name}) => set(name, path, value))})});
  const single = models.filter((model) => !model.static && model.links.length === 1);
  const solids = models.flatMap((model) => model.links.flatMap((link) => link.collisions.map(
    (collision) => ({collision, target: `${linkTarget(link, model.name)}::collision:${collision.name}`}))));
  const pose = [0, 1, 2, 3, 4, 5].map((at) => common(poses.map((one) => Math.round(one[at] * 1e5) / 1e5)));
  /** @type {Field[]} */
  const fields = [poseField(models, poses, pose, count), flag('static'), flag('self_collide'),
    flag('enable_wind')];
  fields.push({path: 'group', label: 'group', type: 'text', hint: 'selected and moved together; empty for none',
    ops: (value) => ({label: `Group ${count}`, ops: [
      {kind: 'set_group', names: models.map(({name}) => name), group: String(value)}]})});
  if (single.length === models.length) {
    fields.push({path: 'mass', label: 'mass of each', type: 'number', unit: 'kg', above: 0,
      ops: (value) => ({label: `Set mass of ${count} to ${value}`,
        ops: models.flatMap(({name, links}) => massOps(links[0], name, Number(value)))})});
  }
  if (solids.length) {
    fields.push({path: 'mu', label: 'friction mu', type: 'number', min: 0,
      ops: (value) => ({label: `Set friction of ${count} to ${value}`,
        ops: solids.map(({target}) => set(target, 'surface.mu', value))})});
  }
  fields.push({path: 'color', label: 'color', type: 'color', ops: (value) => ({
    label: `Set color of ${count}`, ops: models.flatMap((model) => colourOps(model, value))})});
  const visuals = models.flatMap(({links}) => links.flatMap((link) => link.visuals));
  const entity = {
    pose,
    static: common(models.map((model) => model.static)),
    self_collide: common(models.map((model) => model.self_collide)),
    enable_wind: common(models.map((model) => model.enable_wind)),
    group: common(models.map(({group}) => group ?? '')),
    mass: common(models.map(({links}) => links[0]?.inertial.mass ?? null)),
    mu: common(solids.map(({collision}) => collision.surface.mu)),
    color: common(visuals.map(({material}) => colourOf(material))),
  };
  return {title: count, sections: [{key: `shared|${models.map(({name}) => name).join('|')}`,
    title: '', target: '', entity, fields}]};
}

/**
 * Returns the pose field of several models. All models get a typed number; each keeps its others.
 * @param {Model[]} models
 * @param {number[][]} poses  six numbers each
 * @param {unknown[]} shown   those that all have, rounded
 * @param {string} count
 * @returns {Field}
 */
function poseField(models, poses, shown, count) {
  return {path: 'pose', label: 'pose of each', type: 'vector',
    parts: ['x', 'y', 'z', 'roll', 'pitch', 'yaw'], unit: 'm, rad',
    ops: (value) => {
      const typed = Array.isArray(value) ? value : [];
      /** @type {Record<string, number[]>} */
      const moved = {};
      models.forEach(({name}, index) => {
        moved[name] = sevenOf(poses[index].map((part, at) =>
          (typed[at] === shown[at] ? part : typed[at] ?? part)));
      });
      return {label: `Move ${count}`, ops: [{kind: 'move', poses: moved}]};
    }};
}
