/** The inspectors: what they ask of each kind of item, and what their answers do to the plan. */
import {openingFault} from './plan_check.js';
import {distance} from './plane_geometry.js';
import {
  attached, itemOf, outerLength, setLevelHeight, update, wallLength, withLevel,
} from './plan.js';
import {moveEnd, setOuterLength} from './plan_moves.js';
import {outlineOf} from './rooms.js';
import type {AnyItem, Kind, Ref} from './plan.js';
import type {Floor, Level, Opening, Plan, Roof} from '../protocol.js';

/**
 * What the fields of an inspector hold, by the fields' names.
 * Which of them there are depends on the item; an item has no others than its inspector shows.
 */
export type Values = Record<'startX'|'startY'|'endX'|'endY'|'length'|'height'|'thickness'|'width'|'depth'|
    'elevation'|'x'|'y'|'angle'|'fromStart'|'fromEnd'|'steps'|'overhang'|'pitch', number> &
    Record<'color'|'texture'|'type'|'name', string> &
    {fit: Floor['fit'], kind: 'none'|Roof['kind']};
export interface InspectorField {
  name: string;
  label: string;
  type: 'number'|'integer'|'text'|'color'|'texture'|'choice';
  min?: number;
  max?: number;
  choices?: [string, string][];
  hint?: string;
}

const size = (name: string, label: string): InspectorField =>
    ({name, label, type: 'number', min: 0.001, max: 1000});
const place = (name: string, label: string): InspectorField =>
    ({name, label, type: 'number', min: -1000, max: 1000});
const LEVEL_NAME: InspectorField = {name: 'name', label: 'Name', type: 'text'};
const FLOOR_LOOK: InspectorField[] = [{name: 'color', label: 'Floor color', type: 'color'},
  {name: 'texture', label: 'Floor texture', type: 'texture'}];
const LOOK: InspectorField[] = [{name: 'color', label: 'Color', type: 'color'}, {name: 'texture',
    label: 'Texture', type: 'texture'}];
const ANGLE: InspectorField = {name: 'angle', label: 'Angle (°)', type: 'number', min: -360, max: 360};
const TYPE: InspectorField = {name: 'type', label: 'Type', type: 'choice',
    choices: [['single', 'Single']]};
const degrees = (radians: number) => Math.round(radians * 180 / Math.PI * 1e6) / 1e6;
const radians = (value: number) => value * Math.PI / 180;

/** The fields of an item's inspector. */
export function fieldsOf(kind: Kind, item: AnyItem): InspectorField[] {
  switch (kind) {
    case 'walls': return [
      place('startX', 'Start x'), place('startY', 'Start y'), place('endX', 'End x'),
      place('endY', 'End y'), {...size('length', 'Length'),
        hint: 'From outer face to outer face: the distance of the ends and the thickness.'}, size('height', 'Height'),
      size('thickness', 'Thickness'), ...LOOK];
    case 'windows': case 'doors': return [
      ...(!('wall' in item) || item.wall === null
        ? [place('x', 'x'), place('y', 'y'), ANGLE]
        : [{...place('fromStart', 'Distance from wall start'), min: 0}, {...place('fromEnd', 'Distance from wall end'), min: 0}]),
      {...size('elevation', 'Elevation'), min: 0}, size('width', 'Width'), size('height', 'Height'), TYPE];
    case 'stairs': return [
      place('x', 'x'), place('y', 'y'), ANGLE,
      size('width', 'Width'), size('depth', 'Depth'), size('height', 'Height'),
      {name: 'steps', label: 'Steps', type: 'integer', min: 1, max: 500}, ...LOOK];
    case 'floors': return [size('thickness', 'Thickness'),
      {name: 'fit', label: 'Outline', type: 'choice', choices: [['none', 'As drawn'], ['walls', 'Fit to walls']]},
      ...LOOK];
    default: throw new RangeError(`no inspector for ${kind}`);
  }
}

/** What the fields show of an item. */
export function valuesOf(item: AnyItem, level: Level): Partial<Values> {
  const {id: _, ...values} = item;
  if ('start' in item) {
    return {...values, startX: item.start[0], startY: item.start[1], endX: item.end[0],
      endY: item.end[1], length: outerLength(item)};
  }
  if ('outline' in item) return values;
  const free = {...values, x: item.position[0], y: item.position[1], angle: degrees(item.yaw)};
  if ('steps' in item) return free;
  const wall = level.walls.find(({id}) => id === item.wall);
  if (!wall) return {...free, type: 'single'};
  return {...values, type: 'single', fromStart: item.along - item.width / 2,
    fromEnd: wallLength(wall) - item.along - item.width / 2};
}

/**
 * What was typed, by the fields' names.
 * @param values  what the fields hold
 * @param before  what they held when they were filled
 */
function typedOf(values: Partial<Values>, before: Partial<Values>): Partial<Values> {
  return Object.fromEntries(Object.entries(values).filter(([name, value]) =>
    value !== before[name as keyof Values]));
}

/**
 * Returns the plan after an inspector was applied. The plan may have been edited since the fields
 * were filled, so only the typed values replace the item's present values.
 * @param filled  what the fields hold
 * @param before  what they held when they were filled: only what differs is applied
 */
export function applied(plan: Plan, at: number, ref: Ref, filled: Values, before: Values):
    {plan: Plan, fault: string} {
  const item = itemOf(plan, at, ref);
  if (!item) return {plan, fault: 'the item no longer exists'};
  const present = valuesOf(item, plan.levels[at]);
  const typed = typedOf(filled, before);
  // A free opening has other fields than one in a wall.
  if (Object.keys(typed).some((name) => !(name in present))) {
    return {plan, fault: 'the item was taken into or out of a wall: open its inspector again'};
  }
  const values = {...present, ...typed} as Values;
  const differs = (name: string) => name in typed;
  if ('start' in item) return wallApplied(plan, at, ref, values, differs);
  if ('steps' in item) {
    const {x, y, angle, width, depth, height, steps, color, texture} = values;
    return {fault: '', plan: update(plan, at, ref, {position: [x, y], width, depth, height, steps, color, texture,
      yaw: differs('angle') ? radians(angle) : item.yaw})};
  }
  if ('outline' in item) {
    const {thickness, fit, color, texture} = values;
    let made = update(plan, at, ref, {thickness, fit, color, texture});
    if (fit === 'walls' && differs('fit')) made = withLevel(made, at, refitted(made.levels[at], ref.id));
    return {plan: made, fault: ''};
  }
  return openingApplied(plan, at, ref, item, values, differs);
}

function refitted(level: Level, id: number) {
  const outline = level.walls.length ? outlineOf(level.walls) : null;
  return outline ? {floors: level.floors.map((floor) => floor.id === id ? {...floor, outline, holes: []} : floor)} : {};
}

function wallApplied(plan: Plan, at: number, ref: Ref, values: Values, differs: (name: string) =>
    boolean) {
  const {startX, startY, endX, endY, length, height, thickness, color, texture} = values;
  if (distance([startX, startY], [endX, endY]) < 0.01) {
    return {plan, fault: 'start and end of the wall must differ'};
  }
  let made = update(plan, at, ref, {height, thickness, color, texture});
  if (differs('startX') || differs('startY')) made = moveEnd(made, at, ref.id, 'start', [startX, startY]);
  if (differs('endX') || differs('endY')) made = moveEnd(made, at, ref.id, 'end', [endX, endY]);
  else if (differs('length')) {
    if (length <= thickness) return {plan, fault: 'the length must be greater than the thickness'};
    made = setOuterLength(made, at, ref.id, length);
  }
  return {plan: made, fault: ''};
}

function openingApplied(plan: Plan, at: number, ref: Ref, item: Opening, values: Values,
    differs: (name: string) => boolean) {
  const {width, height, elevation, x, y, angle, fromStart, fromEnd} = values;
  const sized = {...item, width, height, elevation};
  const wall = plan.levels[at].walls.find(({id}) => id === item.wall);
  if (!wall) {
    return {fault: '', plan: update(plan, at, ref,
      {width, height, elevation, position: [x, y], yaw: differs('angle') ? radians(angle) : item.yaw})};
  }
  let {along} = item;
  if (differs('fromStart')) along = fromStart + width / 2;
  else if (differs('fromEnd')) along = wallLength(wall) - fromEnd - width / 2;
  const fault = openingFault({...sized, along}, wall);
  if (fault) return {plan, fault};
  return {fault: '', plan: update(plan, at, ref, {...attached(sized, wall, along), id: item.id})};
}

/** The level's inspector. */
export const levelFields = (plan: Plan, at: number): InspectorField[] => [
  LEVEL_NAME, size('height', 'Height'),
  ...(plan.levels[at].floors.length ? FLOOR_LOOK : [])];

export function levelValues(plan: Plan, at: number) {
  const {name, height, floors} = plan.levels[at];
  return {name, height, color: floors[0]?.color, texture: floors[0]?.texture};
}

/** The plan after the level's inspector was applied; see `applied` for the values. */
export function levelApplied(plan: Plan, at: number, values: Values, before: Values) {
  const {name, height, ...look} = typedOf(values, before);
  let made = height === undefined ? plan : setLevelHeight(plan, at, height);
  if (name?.trim()) made = withLevel(made, at, {name: name.trim()});
  if (!Object.keys(look).length) return made;
  return withLevel(made, at, {floors: made.levels[at].floors.map((floor) => ({...floor, ...look}))});
}

export const ROOF_FIELDS: InspectorField[] = [
  {name: 'kind', label: 'Kind', type: 'choice', choices: [['none', 'None'], ['flat', 'Flat'], ['gable', 'Gable']]},
  size('thickness', 'Thickness'), {...size('overhang', 'Overhang'), min: 0},
  {name: 'pitch', label: 'Pitch (°)', type: 'number', min: 1, max: 75}, ...LOOK];

export const roofValues = (plan: Plan): Partial<Values> =>
    ({thickness: 0.1, overhang: 0, color: '#ffffff', texture: '',
  ...plan.roof, kind: plan.roof?.kind ?? 'none', pitch: degrees(plan.roof?.pitch ?? Math.PI / 6)});

/** The plan after the roof's inspector was applied; see `applied` for the values. */
export function roofApplied(plan: Plan, values: Values, before: Values): Plan {
  const {kind, thickness, overhang, pitch, color, texture} = {...roofValues(plan), ...typedOf(values,
      before)} as Values;
  return {...plan,
    roof: kind === 'none' ? null : {kind, thickness, overhang, pitch: radians(pitch), color, texture}};
}

/** What is wrong with a value of a field, '' when nothing is. */
export function fieldFault(field: InspectorField, value: unknown) {
  if (field.type !== 'number' && field.type !== 'integer') return '';
  if (typeof value !== 'number' || !Number.isFinite(value)) return `${field.label}: not a number`;
  if (field.type === 'integer' && !Number.isInteger(value)) return `${field.label}: must be an integer`;
  if (field.min !== undefined && value < field.min) return `${field.label}: must be at least ${field.min}`;
  return field.max !== undefined && value > field.max ? `${field.label}: must be at most ${field.max}` : '';
}

