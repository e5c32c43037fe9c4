/** What the model editor asks of the simulator, as operations. Pure. */
import {compose, inverse} from './pose.js';
import type {Joint, Axis, Link, Model, Operation} from './protocol.js';
import type {Pose7} from './pose.js';

export const JOINT_TYPES = Object.freeze(['revolute', 'revolute2', 'prismatic', 'ball', 'universal', 'screw',
  'gearbox', 'fixed']);

/** How many axes a type has. */
export const axesOf = (type: string) =>
  ['fixed', 'ball'].includes(type) ? 0 : ['revolute2', 'universal', 'gearbox'].includes(type) ? 2 : 1;

/** Whether a name is that of a link of the model. */
export const isLinkOf = (model: Model|undefined, name: string) =>
  Boolean(model && name.startsWith(`${model.name}::`) &&
    model.links.some((link) => `${model.name}::${link.name}` === name));

/**
 * Links at new places in the world, which their model then describes.
 * @param frame  where the model is
 * @param poses  in the world, by scoped name
 */
export function linkMoves(model: Model, frame: Pose7, poses: Record<string, Pose7>): Operation[] {
  return Object.entries(poses).filter(([name]) => isLinkOf(model, name)).map(([target, pose]) =>
    ({kind: 'set', target, path: 'pose', value: compose(inverse(frame), pose)}));
}

/** Selected links of a model away. */
export function linkRemovals(model: Model|undefined, names: string[]): Operation[] {
  return names.filter((name) => isLinkOf(model, name))
    .map((target) => ({kind: 'remove_part', target}));
}

/**
 * Two clicked links, or the world and one, as a joint.
 * @param parent  link or "world"
 */
export const connection = (model: string, type: string, parent: string, child: string): Operation =>
  ({kind: 'add_joint', model, joint: {type, parent, child}});

/** Fields of a shape's size, each with what its numbers are. */
const SIZES: Record<string, string[]> = {size: ['Size x', 'Size y', 'Size z'], radii: ['Radius x',
    'Radius y', 'Radius z'],
  radius: ['Radius'], length: ['Length']};

/** The size of a link's first collision, m: its numbers by field; none for a mesh or a plane. */
export function sizeOf(link: Link): {path: string, label: string, value: number}[] {
  const geometry = link.collisions[0]?.geometry as Record<string, unknown>|undefined;
  if (!geometry || !SIZED.has(String(geometry.type))) return [];
  return Object.entries(SIZES).filter(([path]) => geometry[path] !== undefined)
    .flatMap(([path, labels]) => labels.map((label, at) => ({path, label,
      value: Number(labels.length > 1 ? (geometry[path] as number[])[at] : geometry[path])})));
}

const SIZED = new Set(['box', 'sphere', 'cylinder', 'capsule', 'cone', 'ellipsoid']);

/**
 * Another size for the first collision of a link and for all its shapes like that; the inertia
 * follows, with the mass as it is.
 * @param target  scoped name of the link
 * @param size  as of `sizeOf`, with other numbers
 */
export function resizing(target: string, link: Link, size: {path: string, value: number}[]): Operation {
  const old = JSON.stringify(link.collisions[0].geometry);
  const paths = [...new Set(size.map(({path}) => path))];
  const parts = ([['collision', link.collisions], ['visual', link.visuals]] as const)
    .flatMap(([kind, shapes]) => shapes.filter(({geometry}) => JSON.stringify(geometry) === old)
      .map(({name}) => `${target}::${kind}:${name}`));
  const sets = parts.flatMap((part) => paths.map((path) => {
    const numbers = size.filter((one) => one.path === path).map(({value}) => value);
    return {kind: 'set', target: part, path: `geometry.${path}`,
      value: SIZES[path].length > 1 ? numbers : numbers[0]} as Operation;
  }));
  return {kind: 'group', label: `Resize ${target}`,
    ops: [...sets, {kind: 'compute_inertial', target, density: null}]};
}

/** An axis without limits. */
const FREE: Axis = {xyz: [0, 0, 1], lower: -1e16, upper: 1e16, effort: -1, velocity: -1, damping: 0,
    friction: 0,
  spring_reference: 0, spring_stiffness: 0, motor_rate: 0};

/** The axis of a joint, or a new one. */
export const axisOr = (axis: Axis|null|undefined): Axis => ({...FREE, ...axis});

/** In a list. */
export const jointText = ({type, parent, child}: Joint) => `${parent} → ${child}: ${type}`;

/** All plugins of a model as text, for editing. */
export const pluginText = ({plugins}: Pick<Model, 'plugins'>) => plugins.map(({xml}) =>
    xml.trim()).join('\n');

/**
 * How many steps of the history have come since a mark and can be undone; the labels that are sent
 * are only the latest.
 * @param mark  its depth before
 */
export const stepsSince = ({depth, undoable}: {depth: number, undoable: number}, mark: number) =>
    Math.max(Math.min(depth - mark, undoable), 0);

/**
 * Which of the latest steps of the history are one's own.
 * @param authorOf  the other who did a step, '' for oneself
 * @returns oldest: index of the first own step, -1 without one;
 * others: who did steps after that one, which would be undone with it
 */
export function ownSteps(steps: number, authorOf: (at: number) => string): {oldest: number,
    others: string[]} {
  const authors = Array.from({length: steps}, (_, at) => authorOf(at));
  const oldest = authors.lastIndexOf('');
  return {oldest, others: [...new Set(authors.slice(0, Math.max(oldest, 0)).filter(Boolean))]};
}

/**
 * The model that has another name now, or none: that of the same links which was not there before.
 * @param links  names of its links
 * @param before  names of the models before
 */
export const renamedModel = (models: Pick<Model, 'name'|'links'>[], links: string,
    before: Set<string>) => models.find((one) =>
  !before.has(one.name) && linkNames(one) === links);

export const linkNames = ({links}: Pick<Model, 'links'>) => links.map(({name}) => name).join();
