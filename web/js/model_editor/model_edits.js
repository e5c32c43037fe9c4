/** What the model editor asks of the simulator, as operations. Pure. */
import {compose, inverse} from '../pose.js';
/** @import {Joint, Axis, Link, Model, Operation} from '../protocol.js' */
/** @import {Pose7} from '../pose.js' */

export const JOINT_TYPES = Object.freeze(['revolute', 'revolute2', 'prismatic', 'ball', 'universal', 'screw',
  'gearbox', 'fixed']);

/** How many axes a type has. @param {string} type */
export const axesOf = (type) =>
  ['fixed', 'ball'].includes(type) ? 0 : ['revolute2', 'universal', 'gearbox'].includes(type) ? 2 : 1;

/** Whether a name is that of a link of the model. @param {Model|undefined} model @param {string} name */
export const isLinkOf = (model, name) =>
  Boolean(model && name.startsWith(`${model.name}::`) &&
    model.links.some((link) => `${model.name}::${link.name}` === name));

/**
 * Links at new places in the world, which their model then describes.
 * @param {Model} model
 * @param {Pose7} frame  where the model is
 * @param {Record<string, Pose7>} poses  in the world, by scoped name
 * @returns {Operation[]}
 */
export function linkMoves(model, frame, poses) {
  return Object.entries(poses).filter(([name]) => isLinkOf(model, name)).map(([target, pose]) =>
    ({kind: 'set', target, path: 'pose', value: compose(inverse(frame), pose)}));
}

/** Selected links of a model away. @param {Model|undefined} model @param {string[]} names @returns {Operation[]} */
export function linkRemovals(model, names) {
  return names.filter((name) => isLinkOf(model, name))
    .map((target) => ({kind: 'remove_part', target}));
}

/**
 * Two clicked links, or the world and one, as a joint.
 * @param {string} model
 * @param {string} type
 * @param {string} parent  link or "world"
 * @param {string} child
 * @returns {Operation}
 */
export const connection = (model, type, parent, child) =>
  ({kind: 'add_joint', model, joint: {type, parent, child}});

/** Fields of a shape's size, each with what its numbers are. @type {Record<string, string[]>} */
const SIZES = {size: ['Size x', 'Size y', 'Size z'], radii: ['Radius x', 'Radius y', 'Radius z'],
  radius: ['Radius'], length: ['Length']};

/**
 * The size of a link's first collision, m: its numbers by field; none for a mesh or a plane.
 * @param {Link} link
 * @returns {{path: string, label: string, value: number}[]}
 */
export function sizeOf(link) {
  const geometry = /** @type {Record<string, unknown>|undefined} */ (link.collisions[0]?.geometry);
  if (!geometry || !SIZED.has(String(geometry.type))) return [];
  return Object.entries(SIZES).filter(([path]) => geometry[path] !== undefined)
    .flatMap(([path, labels]) => labels.map((label, at) => ({path, label,
      value: Number(labels.length > 1 ? /** @type {number[]} */ (geometry[path])[at] : geometry[path])})));
}

const SIZED = new Set(['box', 'sphere', 'cylinder', 'capsule', 'cone', 'ellipsoid']);

/**
 * Another size for the first collision of a link and for all its shapes like that; the inertia
 * follows, with the mass as it is.
 * @param {string} target  scoped name of the link
 * @param {Link} link
 * @param {{path: string, value: number}[]} size  as of `sizeOf`, with other numbers
 * @returns {Operation}
 */
export function resizing(target, link, size) {
  const old = JSON.stringify(link.collisions[0].geometry);
  const paths = [...new Set(size.map(({path}) => path))];
  const parts = /** @type {const} */ ([['collision', link.collisions], ['visual', link.visuals]])
    .flatMap(([kind, shapes]) => shapes.filter(({geometry}) => JSON.stringify(geometry) === old)
      .map(({name}) => `${target}::${kind}:${name}`));
  const sets = parts.flatMap((part) => paths.map((path) => {
    const numbers = size.filter((one) => one.path === path).map(({value}) => value);
    return /** @type {Operation} */ ({kind: 'set', target: part, path: `geometry.${path}`,
      value: SIZES[path].length > 1 ? numbers : numbers[0]});
  }));
  return {kind: 'group', label: `Resize ${target}`,
    ops: [...sets, {kind: 'compute_inertial', target, density: null}]};
}

/** An axis without limits. @type {Axis} */
const FREE = {xyz: [0, 0, 1], lower: -1e16, upper: 1e16, effort: -1, velocity: -1, damping: 0, friction: 0,
  spring_reference: 0, spring_stiffness: 0, motor_rate: 0};

/** The axis of a joint, or a new one. @param {Axis|null|undefined} axis @returns {Axis} */
export const axisOr = (axis) => ({...FREE, ...axis});

/** In a list. @param {Joint} joint */
export const jointText = ({type, parent, child}) => `${parent} → ${child}: ${type}`;

/** All plugins of a model as text, for editing. @param {Pick<Model, 'plugins'>} model */
export const pluginText = ({plugins}) => plugins.map(({xml}) => xml.trim()).join('\n');

/**
 * How many steps of the history have come since a mark and can be undone; the labels that are sent
 * are only the latest.
 * @param {{depth: number, undoable: number}} history
 * @param {number} mark  its depth before
 */
export const stepsSince = ({depth, undoable}, mark) => Math.max(Math.min(depth - mark, undoable), 0);

/**
 * Which of the latest steps of the history are one's own.
 * @param {number} steps
 * @param {(at: number) => string} authorOf  the other who did a step, '' for oneself
 * @returns {{oldest: number, others: string[]}}  oldest: index of the first own step, -1 without one;
 *   others: who did steps after that one, which would be undone with it
 */
export function ownSteps(steps, authorOf) {
  const authors = Array.from({length: steps}, (_, at) => authorOf(at));
  const oldest = authors.lastIndexOf('');
  return {oldest, others: [...new Set(authors.slice(0, Math.max(oldest, 0)).filter(Boolean))]};
}

/**
 * The model that has another name now, or none: that of the same links which was not there before.
 * @param {Pick<Model, 'name'|'links'>[]} models
 * @param {string} links         names of its links
 * @param {Set<string>} before   names of the models before
 */
export const renamedModel = (models, links, before) => models.find((one) =>
  !before.has(one.name) && linkNames(one) === links);

/** @param {Pick<Model, 'links'>} model */
export const linkNames = ({links}) => links.map(({name}) => name).join();
