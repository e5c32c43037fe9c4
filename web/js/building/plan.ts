/**
 * The plan of a building and what can be done to it. Plans are never changed: every function gives a
 * new one that shares what stayed the same, so that history costs nothing and the canvas sees by
 * identity what it must draw again.
 *
 * The shape of a plan is that of the plan file: metres and radians, colours as #rrggbb.
 */
import {direction, distance, polar, tidy, tidyPoint} from './plane_geometry.js';
import {outlineOf} from './rooms.js';
import type {Floor, Level, Opening, Plan, Stairs, Wall} from '../protocol.js';

type Point = import('./plane_geometry.js').Point;
export type OpeningKind = 'windows'|'doors';
export type Kind = 'walls'|'stairs'|'floors'|OpeningKind;
export type Ref = {kind: Kind, id: number};

export type ItemOf = {walls: Wall, windows: Opening, doors: Opening, stairs: Stairs, floors: Floor};

/** Any item of a level; which fields it has, its kind tells. */
export type AnyItem = Wall|Opening|Stairs|Floor;

const FORMAT = 1;
const WHITE = '#ffffff';

/** From the list of a level to the name of its counter. */
const COUNTERS: Record<Kind, keyof Plan['next']> = Object.freeze({
  walls: 'wall', windows: 'window', doors: 'door', stairs: 'stairs', floors: 'floor',
});
export const KINDS: readonly Kind[] = Object.freeze(['walls', 'windows', 'doors', 'stairs', 'floors']);

export const OPENING_KINDS: readonly OpeningKind[] = Object.freeze(['windows', 'doors']);

/** What the link of an item is called in the model, before its number. */
const LINK_NAMES: Record<Kind, string> = Object.freeze(
  {walls: 'Wall', windows: 'Window', doors: 'Door', stairs: 'Stairs', floors: 'Floor'});

const LOOK = {color: WHITE, texture: ''};
const OPENING: Omit<Opening, 'id'|'width'|'height'|'elevation'> = {depth: 0.17, wall: null, along: 0,
    position: [0, 0], yaw: 0};

/** What is not said of a new item. */
export const DEFAULTS: {walls: Omit<Wall, 'id'|'start'|'end'>, windows: Omit<Opening, 'id'>,
    doors: Omit<Opening, 'id'>, stairs: Omit<Stairs, 'id'|'position'>,
    floors: Omit<Floor, 'id'|'outline'>} = Object.freeze({
  walls: {thickness: 0.15, height: 2.5, ...LOOK},
  windows: {width: 0.8, height: 0.8, elevation: 0.5, ...OPENING},
  doors: {width: 0.9, height: 2, elevation: 0, ...OPENING},
  stairs: {yaw: 0, width: 1, depth: 3.5, height: 2.5, steps: 15, ...LOOK},
  floors: {holes: [], thickness: 0.1, fit: 'none', ...LOOK},
});

/** A floor on the ground is thin, so that robots can drive in through the doors. */
export const GROUND_FLOOR_THICKNESS = 0.01;

const emptyLevel = (name: string): Level => ({
  name, height: 2.5, walls: [], windows: [], doors: [], stairs: [], floors: [],
  image: null,
});

export const emptyPlan = (name = 'Untitled'): Plan => ({
  format: FORMAT, name, levels: [emptyLevel('Level 1')], roof: null,
  next: {wall: 0, window: 0, door: 0, stairs: 0, floor: 0},
});

export const isEmpty = (plan: Plan) =>
  !plan.roof && plan.levels.every((level) => !level.image && KINDS.every((kind) => !level[kind].length));

// ---- looking things up

export const itemOf = (plan: Plan, at: number, {kind, id}: Ref): AnyItem|undefined =>
  plan.levels[at]?.[kind].find((item) => item.id === id);

/** What the link of an item is called in the model. */
export const linkName = ({kind, id}: Ref) =>
  `${LINK_NAMES[kind]}_${id}`;

/** The item that a link of the model is made from: {level, ref}, or null. */
export function itemOfLink(plan: Plan, link: string) {
  const [, word, id] = /^(Wall|Window|Door|Stairs|Floor)_(\d+)$/.exec(link) ?? [];
  const kind = KINDS.find((one) => LINK_NAMES[one] === word);
  if (!kind) return null;
  const level = plan.levels.findIndex((one) => one[kind].some((item) => item.id === Number(id)));
  return level < 0 ? null : {level, ref: {kind, id: Number(id)}};
}

export const wallLength = (wall: {start: Point, end: Point}) => distance(wall.start, wall.end);
export const wallYaw = (wall: {start: Point, end: Point}) => direction(wall.start, wall.end);
/** From edge to edge, as the wall is written and labelled: corners overlap. */
export const outerLength = (wall: {start: Point, end: Point, thickness: number}) =>
    wallLength(wall) + wall.thickness;

/** Where an opening is and how it is turned: that of its wall, or its own. */
export function placeOf(opening: Opening, level: Level) {
  const wall = opening.wall === null ? null : level.walls.find(({id}) => id === opening.wall);
  if (!wall) return {point: opening.position, yaw: opening.yaw, wall: null};
  return {point: polar(wall.start, wallYaw(wall), opening.along), yaw: wallYaw(wall), wall};
}

/** The height of each level's base above the ground. */
export function bases(plan: Plan) {
  let z = 0;
  return plan.levels.map((level) => {
    const base = z;
    z += level.height;
    return base;
  });
}

// ---- changing lists

export function withLevel(plan: Plan, at: number, changes: Partial<Level>) {
  return {...plan, levels: plan.levels.map((level, n) => n === at ? {...level, ...changes} : level)};
}

/** Changes one item. */
export function update(plan: Plan, at: number, {kind, id}: Ref,
    changes: Partial<Wall>|Partial<Opening>|Partial<Stairs>|Partial<Floor>): Plan {
  const level = plan.levels[at];
  const list = level[kind].map((item) => item.id === id ? {...item, ...changes} : item);
  return refit(withLevel(plan, at, {[kind]: list}), at, kind);
}

/** Adds an item. Missing fields get their defaults. */
export function add(plan: Plan, at: number, kind: Kind,
    fields: Partial<Wall>|Partial<Opening>|Partial<Stairs>|Partial<Floor>): {plan: Plan, ref: Ref} {
  const counter = COUNTERS[kind];
  const id = plan.next[counter];
  const item = {id, ...DEFAULTS[kind], ...fields};
  const grown = withLevel(plan, at, {[kind]: [...plan.levels[at][kind], item]});
  const next = {...plan.next, [counter]: id + 1};
  return {plan: refit({...grown, next}, at, kind), ref: {kind, id}};
}

/** Takes items away, the openings of walls with them. */
export function remove(plan: Plan, at: number, refs: Ref[]) {
  const level = plan.levels[at];
  const gone = (kind: Kind, id: number) => refs.some((ref) => ref.kind === kind && ref.id === id);
  const changes: Partial<Level> = {};
  for (const kind of KINDS) {
    const left = level[kind].filter((item) => !gone(kind, item.id) &&
      !('along' in item && item.wall !== null && item.wall !== undefined && gone('walls', item.wall)));
    if (left.length !== level[kind].length) Object.assign(changes, {[kind]: left});
  }
  return refit(withLevel(plan, at, changes), at, 'walls');
}

/** Floors that follow the walls get their new outline. */
export function refit(plan: Plan, at: number, kind: string) {
  const level = plan.levels[at];
  if (kind !== 'walls' || !level.floors.some((floor) => floor.fit === 'walls')) return plan;
  const outline = outlineOf(level.walls);
  if (!outline) return plan;
  const floors = level.floors.map((floor) => floor.fit === 'walls' ? {...floor, outline} : floor);
  return withLevel(plan, at, {floors});
}

// ---- openings

/** Puts an opening into a wall, as near to `along` as it fits. */
export function attached(opening: Opening, wall: Wall, along: number) {
  const half = opening.width / 2;
  const length = wallLength(wall);
  const fitting = length < opening.width ? length / 2 : Math.min(Math.max(along, half), length - half);
  return {...opening, wall: wall.id, along: tidy(fitting)};
}

/** Takes an opening out of its wall to stand free. */
export const detached = (opening: Opening, point: Point, yaw: number) =>
  ({...opening, wall: null, along: 0, position: tidyPoint(point), yaw});

// ---- levels

/** A name by the place above all levels; a later one where lower levels were deleted. */
function newLevelName({levels}: Plan) {
  const taken = new Set(levels.map(({name}) => name));
  let number = levels.length + 1;
  while (taken.has(`Level ${number}`)) number++;
  return `Level ${number}`;
}

/**
 * Adds a level on top: a copy of the walls, and a floor.
 * @returns null without walls
 */
export function addLevel(plan: Plan): Plan|null {
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
 * @returns null for the last one
 */
export function removeLevel(plan: Plan, at: number): Plan|null {
  if (plan.levels.length < 2) return null;
  return {...plan, levels: plan.levels.filter((_, n) => n !== at)};
}

/** Makes a level higher or lower; walls and stairs as high as it was go along. */
export function setLevelHeight(plan: Plan, at: number, height: number) {
  const level = plan.levels[at];
  const grown = <T extends {height: number}>(item: T): T =>
      Math.abs(item.height - level.height) < 1e-6 ? {...item, height} : item;
  return withLevel(plan, at, {height, walls: level.walls.map(grown), stairs: level.stairs.map(grown)});
}

/** The plan without pictures: what a preview needs. */
export const withoutImages = (plan: Plan) =>
  ({...plan, levels: plan.levels.map((level) => level.image ? {...level, image: null} : level)});
