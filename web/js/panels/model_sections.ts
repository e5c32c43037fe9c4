/**
 * What a model's own panel shows of its body: mass, size, colour, and one panel for several models.
 * A field may stand for several properties: its `ops` say what a new value does. Pure.
 */
import {geometryFields, isSimple} from './geometry_fields.js';
import {sevenOf, sixOf} from './pose_rpy.js';
import type {Field, Section} from './property_fields.js';
import type {Geometry, Link, Material, Model, Operation} from '../protocol.js';

const GREY = {ambient: [0.7, 0.7, 0.7, 1], diffuse: [0.7, 0.7, 0.7, 1]};
const set = (target: string, path: string, value: unknown): Operation =>
    ({kind: 'set', target, path, value});

const linkTarget = (link: Link, model: string) => `${model}::${link.name}`;

/** The colour of a material, as one: what the sun shows. */
const colourOf = (material: Material|null|undefined) => material?.diffuse ?? material?.ambient ?? null;

/** What gives all visuals of a model one colour, ambient and diffuse together. */
function colourOps(model: Model, colour: unknown) {
  return model.links.flatMap((link) => link.visuals.flatMap((visual) => {
    const target = `${linkTarget(link, model.name)}::visual:${visual.name}`;
    return visual.material
      ? [set(target, 'material.ambient', colour), set(target, 'material.diffuse', colour)]
      : [set(target, 'material', {...GREY, ambient: colour, diffuse: colour})];
  }));
}

/** The geometry that visual and collision share; null where they differ. */
function sharedGeometry(link: Link) {
  if (link.collisions.length !== 1 || link.visuals.length !== 1) return null;
  const [{geometry: solid}] = link.collisions;
  const [{geometry: seen}] = link.visuals;
  return solid.type === seen.type && isSimple(solid.type) ? solid : null;
}

/** The one value that all have, null where they differ. */
function common(values: unknown[]) {
  const [first] = values;
  return values.every((value) => JSON.stringify(value) === JSON.stringify(first)) ? first ?? null : null;
}

/** Mass, size and colour of a model with one link; the mass of others. */
export function bodySections(model: Model): Section[] {
  const {name, links} = model;
  if (!links.length) return [];
  const fields: Field[] = [];
  const entity: Record<string, unknown> = {};
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

/** A body of the same shape with another mass has its inertia in proportion. */
function massOps(link: Link, model: string, mass: number): Operation[] {
  const {inertial} = link;
  const factor = inertial.mass > 0 ? mass / inertial.mass : 1;
  const scaled = Object.fromEntries(Object.entries(inertial).map(([key, value]) =>
    [key, typeof value === 'number' ? value * factor : value]));
  return [set(linkTarget(link, model), 'inertial', {...scaled, mass})];
}

/** @param entity  gets the values */
function sizeFields(model: Model, shared: Geometry, entity: Record<string, unknown>): Field[] {
  const [link] = model.links;
  const target = linkTarget(link, model.name);
  return geometryFields(shared).slice(1).map((field) => {
    const name = field.path.slice('geometry.'.length);
    entity[name] = (shared as unknown as Record<string, unknown>)[name];
    return {...field, path: name,
      ops: (value: unknown) => ({label: `Set ${name} of ${model.name}`, ops: [
        set(`${target}::collision:${link.collisions[0].name}`, field.path, value),
        set(`${target}::visual:${link.visuals[0].name}`, field.path, value),
        ...(model.static ? [] : [{kind: 'compute_inertial' as const, target}]),
      ]})};
  });
}

/**
 * What several selected models have in common; a field that is empty differs among them.
 * @param poseOf  where a model is now
 */
export function sharedSections(models: Model[], poseOf: (name: string) => number[]|null):
    {title: string, sections: Section[]} {
  const count = `${models.length} models`;
  const poses = models.map(({name, pose}) => sixOf(poseOf(name) ?? pose));
  const flag = (path: 'static'|'self_collide'|'allow_auto_disable'|'enable_wind') =>
      ({path, label: path.replaceAll('_', ' '),
    type: 'flag', ops: (value) => ({label: `Set ${path.replaceAll('_', ' ')} of ${count}`,
      ops: models.map(({name}) => set(name, path, value))})} as Field);
  const single = models.filter((model) => !model.static && model.links.length === 1);
  const solids = models.flatMap((model) => model.links.flatMap((link) => link.collisions.map(
    (collision) => ({collision, target: `${linkTarget(link, model.name)}::collision:${collision.name}`}))));
  const pose = [0, 1, 2, 3, 4, 5].map((at) => common(poses.map((one) => Math.round(one[at] * 1e5) / 1e5)));
  const fields: Field[] = [poseField(models, poses, pose, count), flag('static'), flag('self_collide'),
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
 * @param poses  six numbers each
 * @param shown  those that all have, rounded
 */
function poseField(models: Model[], poses: number[][], shown: unknown[], count: string): Field {
  return {path: 'pose', label: 'pose of each', type: 'vector',
    parts: ['x', 'y', 'z', 'roll', 'pitch', 'yaw'], unit: 'm, rad',
    ops: (value) => {
      const typed = Array.isArray(value) ? value : [];
      const moved: Record<string, number[]> = {};
      models.forEach(({name}, index) => {
        moved[name] = sevenOf(poses[index].map((part, at) =>
          (typed[at] === shown[at] ? part : typed[at] ?? part)));
      });
      return {label: `Move ${count}`, ops: [{kind: 'move', poses: moved}]};
    }};
}
