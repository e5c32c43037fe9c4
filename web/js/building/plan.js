/**
 * The plan of a building and what can be done to it. Plans are never changed: every function gives a
 * new one that shares what stayed the same, so that history costs nothing and the canvas sees by
 * identity what it must draw again.
 *
 * The shape of a plan is that of the plan file: metres and radians, colours as #rrggbb.
 *
 * @typedef {import('./plane_geometry.js').Point} Point
 * @typedef {'windows'|'doors'} OpeningKind
 * @typedef {'walls'|'stairs'|'floors'|OpeningKind} Kind
 * @typedef {{kind: Kind, id: number}} Ref
 */
import {direction, distance, polar, tidy, tidyPoint} from './plane_geometry.js';
import {outlineOf} from './rooms.js';
/** @import {Floor, Level, Opening, Plan, Stairs, Wall} from '../protocol.js' */

/**
 * @typedef {{walls: Wall, windows: Opening, doors: Opening, stairs: Stairs, floors: Floor}} ItemOf
 */

/**
 * Any item of a level; which fields it has, its kind tells.
 * @typedef {Wall|Opening|Stairs|Floor} AnyItem
 */

const FORMAT = 1;
const WHITE = '#ffffff';

/** From the list of a level to the name of its counter. */
/** @type {Record<Kind, keyof Plan['next']>} */
const COUNTERS = Object.freeze({
  walls: 'wall', windows: 'window', doors: 'door', stairs: 'stairs', floors: 'floor',
});
/** @type {readonly Kind[]} */
export const KINDS = Object.freeze(['walls', 'windows', 'doors', 'stairs', 'floors']);

/** @type {readonly OpeningKind[]} */
export const OPENING_KINDS = Object.freeze(['windows', 'doors']);

/**
 * What the link of an item is called in the model, before its number.
 * @type {Record<Kind, string>}
 */
export const LINK_NAMES = Object.freeze(
  {walls: 'Wall', windows: 'Window', doors: 'Door', stairs: 'Stairs', floors: 'Floor'});

const LOOK = {color: WHITE, texture: ''};
/** @type {Omit<Opening, 'id'|'width'|'height'|'elevation'>} */
const OPENING = {depth: 0.17, wall: null, along: 0, position: [0, 0], yaw: 0};

/**
 * What is not said of a new item.
 * @type {{walls: Omit<Wall, 'id'|'start'|'end'>, windows: Omit<Opening, 'id'>,
 *         doors: Omit<Opening, 'id'>, stairs: Omit<Stairs, 'id'|'position'>,
 *         floors: Omit<Floor, 'id'|'outline'>}}
 */
export const DEFAULTS = Object.freeze({
  walls: {thickness: 0.15, height: 2.5, ...LOOK},
  windows: {width: 0.8, height: 0.8, elevation: 0.5, ...OPENING},
  doors: {width: 0.9, height: 2, elevation: 0, ...OPENING},
  stairs: {yaw: 0, width: 1, depth: 3.5, height: 2.5, steps: 15, ...LOOK},
  floors: {holes: [], thickness: 0.1, fit: 'none', ...LOOK},
});

/** A floor on the ground is thin, so that robots can drive in through the doors. */
export const GROUND_FLOOR_THICKNESS = 0.01;

/** @param {string} name @returns {Level} */
const emptyLevel = (name) => ({
  name, height: 2.5, walls: [], windows: [], doors: [], stairs: [], floors: [],
  image: null,
});

/** @returns {Plan} */
export const emptyPlan = (name = 'Untitled') => ({
  format: FORMAT, name, levels: [emptyLevel('Level 1')], roof: null,
  next: {wall: 0, window: 0, door: 0, stairs: 0, floor: 0},
});

/** @param {Plan} plan */
export const isEmpty = (plan) =>
  !plan.roof && plan.levels.every((level) => !level.image && KINDS.every((kind) => !level[kind].length));

// ---- looking things up

/**
 * @param {Plan} plan
 * @param {number} at
 * @param {Ref} ref
 * @returns {AnyItem|undefined}
 */
export const itemOf = (plan, at, {kind, id}) =>
  plan.levels[at]?.[kind].find((item) => item.id === id);

/** What the link of an item is called in the model. @param {Ref} ref */
export const linkName = ({kind, id}) =>
  `${LINK_NAMES[kind]}_${id}`;

/**
 * The item that a link of the model is made from: {level, ref}, or null.
 * @param {Plan} plan
 * @param {string} link
 */
export function itemOfLink(plan, link) {
  const [, word, id] = /^(Wall|Window|Door|Stairs|Floor)_(\d+)$/.exec(link) ?? [];
  const kind = KINDS.find((one) => LINK_NAMES[one] === word);
  if (!kind) return null;
  const level = plan.levels.findIndex((one) => one[kind].some((item) => item.id === Number(id)));
  return level < 0 ? null : {level, ref: {kind, id: Number(id)}};
}

/** @param {{start: Point, end: Point}} wall */
export const wallLength = (wall) => distance(wall.start, wall.end);
/** @param {{start: Point, end: Point}} wall */
export const wallYaw = (wall) => direction(wall.start, wall.end);
/**
 * From edge to edge, as the wall is written and labelled: corners overlap.
 * @param {{start: Point, end: Point, thickness: number}} wall
 */
export const outerLength = (wall) => wallLength(wall) + wall.thickness;

/**
 * Where an opening is and how it is turned: that of its wall, or its own.
 * @param {Opening} opening
 * @param {Level} level
 */
export function placeOf(opening, level) {
  const wall = opening.wall === null ? null : level.walls.find(({id}) => id === opening.wall);
  if (!wall) return {point: opening.position, yaw: opening.yaw, wall: null};
  return {point: polar(wall.start, wallYaw(wall), opening.along), yaw: wallYaw(wall), wall};
}

/** The height of each level's base above the ground. @param {Plan} plan */
export function bases(plan) {
  let z = 0;
  return plan.levels.map((level) => {
    const base = z;
    z += level.height;
    return base;
  });
}

// ---- changing lists

/**
 * @param {Plan} plan
 * @param {number} at
 * @param {Partial<Level>} changes
 */
export function withLevel(plan, at, changes) {
  return {...plan, levels: plan.levels.map((level, n) => n === at ? {...level, ...changes} : level)};
}

/**
 * Changes one item.
 * @param {Plan} plan
 * @param {number} at
 * @param {Ref} ref
 * @param {Partial<Wall>|Partial<Opening>|Partial<Stairs>|Partial<Floor>} changes
 * @returns {Plan}
 */
export function update(plan, at, {kind, id}, changes) {
  const level = plan.levels[at];
  const list = level[kind].map((item) => item.id === id ? {...item, ...changes} : item);
  return refit(withLevel(plan, at, {[kind]: list}), at, kind);
}

/**
 * Adds an item. Missing fields get their defaults.
 * @param {Plan} plan
 * @param {number} at
 * @param {Kind} kind
 * @param {Partial<Wall>|Partial<Opening>|Partial<Stairs>|Partial<Floor>} fields
 * @returns {{plan: Plan, ref: Ref}}
 */
export function add(plan, at, kind, fields) {
  const counter = COUNTERS[kind];
  const id = plan.next[counter];
  const item = {id, ...DEFAULTS[kind], ...fields};
  const grown = withLevel(plan, at, {[kind]: [...plan.levels[at][kind], item]});
  const next = {...plan.next, [counter]: id + 1};
  return {plan: refit({...grown, next}, at, kind), ref: {kind, id}};
}

/**
 * Takes items away, the openings of walls with them.
 * @param {Plan} plan
 * @param {number} at
 * @param {Ref[]} refs
 */
export function remove(plan, at, refs) {
  const level = plan.levels[at];
  /** @param {Kind} kind @param {number} id */
  const gone = (kind, id) => refs.some((ref) => ref.kind === kind && ref.id === id);
  /** @type {Partial<Level>} */
  const changes = {};
  for (const kind of KINDS) {
    const left = level[kind].filter((item) => !gone(kind, item.id) &&
      !('along' in item && item.wall !== null && item.wall !== undefined && gone('walls', item.wall)));
    if (left.length !== level[kind].length) Object.assign(changes, {[kind]: left});
  }
  return refit(withLevel(plan, at, changes), at, 'walls');
}

/**
 * Floors that follow the walls get their new outline.
 * @param {Plan} plan
 * @param {number} at
 * @param {string} kind
 */
export function refit(plan, at, kind) {
  const level = plan.levels[at];
  if (kind !== 'walls' || !level.floors.some((floor) => floor.fit === 'walls')) return plan;
  const outline = outlineOf(level.walls);
  if (!outline) return plan;
  const floors = level.floors.map((floor) => floor.fit === 'walls' ? {...floor, outline} : floor);
  return withLevel(plan, at, {floors});
}

// ---- openings

/**
 * Puts an opening into a wall, as near to `along` as it fits.
 * @param {Opening} opening
 * @param {Wall} wall
 * @param {number} along
 */
export function attached(opening, wall, along) {
  const half = opening.width / 2;
  const length = wallLength(wall);
  const fitting = length < opening.width ? length / 2 : Math.min(Math.max(along, half), length - half);
  return {...opening, wall: wall.id, along: tidy(fitting)};
}

/**
 * Takes an opening out of its wall to stand free.
 * @param {Opening} opening
 * @param {Point} point
 * @param {number} yaw
 */
export const detached = (opening, point, yaw) =>
  ({...opening, wall: null, along: 0, position: tidyPoint(point), yaw});

// ---- levels

/** A name by the place above all levels; a later one where lower levels were deleted. @param {Plan} plan */
function newLevelName({levels}) {
  const taken = new Set(levels.map(({name}) => name));
  let number = levels.length + 1;
  while (taken.has(`Level ${number}`)) number++;
  return `Level ${number}`;
}

/**
 * Adds a level on top: a copy of the walls, and a floor.
 * @param {Plan} plan
 * @returns {Plan|null} null without walls
 */
export function addLevel(plan) {
  const at = plan.levels.length - 1;
  const below = plan.levels[at];
  if (!below.walls.length) return null;
  const height = Math.max(...below.walls.map((wall) => wall.height));
  let made = withLevel(plan, at, {height});
  made = {...made, levels: [...made.levels, emptyLevel(newLevelName(plan))]};
  for (const {id: _, ...wall} of below.walls) made = add(made, at + 1, 'walls', wall).plan;
  return add(made, at + 1, 'floors', {outline: outlineOf(below.walls) ?? [], fit: 'walls'}).plan;
}

/**
 * Takes a level away with all in it.
 * @param {Plan} plan
 * @param {number} at
 * @returns {Plan|null} null for the last one
 */
export function removeLevel(plan, at) {
  if (plan.levels.length < 2) return null;
  return {...plan, levels: plan.levels.filter((_, n) => n !== at)};
}

/**
 * Makes a level higher or lower; walls and stairs as high as it was go along.
 * @param {Plan} plan
 * @param {number} at
 * @param {number} height
 */
export function setLevelHeight(plan, at, height) {
  const level = plan.levels[at];
  /** @template {{height: number}} T @param {T} item @returns {T} */
  const grown = (item) => Math.abs(item.height - level.height) < 1e-6 ? {...item, height} : item;
  return withLevel(plan, at, {height, walls: level.walls.map(grown), stairs: level.stairs.map(grown)});
}

/** The plan without pictures: what a preview needs. @param {Plan} plan */
export const withoutImages = (plan) =>
  ({...plan, levels: plan.levels.map((level) => level.image ? {...level, image: null} : level)});
