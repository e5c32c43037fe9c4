/** Copying and pasting items of a plan. */
import {add, detached, itemOf, OPENING_KINDS, placeOf} from './plan.js';
import {plus, tidyPoint} from './plane_geometry.js';
/** @import {Plan} from '../protocol.js' */
/** @import {AnyItem, Kind, Ref} from './plan.js' */
/** @import {Point} from './plane_geometry.js' */

/**
 * A copied item; `place`: where an opening is whose wall was not copied.
 * @typedef {{kind: Kind, item: AnyItem, place?: {point: Point, yaw: number}}} Clip
 */

/**
 * What is selected, apart from the plan.
 * @param {Plan} plan
 * @param {number} at
 * @param {Ref[]} refs
 */
function copied(plan, at, refs) {
  return refs.flatMap((ref) => {
    const item = itemOf(plan, at, ref);
    return item ? [{kind: ref.kind, item}] : [];
  });
}

/**
 * Adds copies, moved by a vector; openings of copied walls go into the copies, others stand free.
 * @param {Plan} plan
 * @param {number} at
 * @param {Clip[]} clips
 * @param {Point} by
 * @returns {{plan: Plan, refs: Ref[]}}
 */
export function pasted(plan, at, clips, by) {
  /**
   * From the ids of copied walls to those of the copies.
   * @type {Map<number|null|undefined, number>}
   */
  const walls = new Map();
  /** @type {Ref[]} */
  const refs = [];
  let made = plan;
  /**
   * @param {Kind} kind
   * @param {AnyItem} item  whose id is not taken over
   */
  const put = (kind, {id: _, ...fields}) => {
    const grown = add(made, at, kind, fields);
    made = grown.plan;
    refs.push(grown.ref);
    return grown.ref.id;
  };
  /** @param {Point} point */
  const shifted = (point) => tidyPoint(plus(point, by));
  for (const {kind, item} of clips) {
    if (!('start' in item)) continue;
    walls.set(item.id, put(kind, {...item, start: shifted(item.start), end: shifted(item.end)}));
  }
  for (const {kind, item, place} of clips) {
    if ('start' in item) continue;
    if ('outline' in item) {
      put(kind, {...item, outline: item.outline.map(shifted),
        holes: item.holes.map((hole) => hole.map(shifted)), fit: 'none'});
    } else if ('along' in item && walls.has(item.wall)) {
      put(kind, {...item, wall: walls.get(item.wall)});
    } else if ('along' in item && place) {
      put(kind, detached(item, shifted(place.point), place.yaw));
    } else {
      put(kind, {...item, position: shifted(item.position)});
    }
  }
  return {plan: made, refs};
}

/**
 * As `copied`, with the openings of copied walls and the places of those whose walls stay behind.
 * @param {Plan} plan
 * @param {number} at
 * @param {Ref[]} refs
 */
export function clipboardOf(plan, at, refs) {
  const level = plan.levels[at];
  const walls = new Set(refs.filter(({kind}) => kind === 'walls').map(({id}) => id));
  const more = OPENING_KINDS.flatMap((kind) => level[kind]
    .filter((item) => walls.has(item.wall ?? -1)).map(({id}) => ({kind, id})));
  const all = [...refs.filter((ref) => !more.some((one) => one.kind === ref.kind && one.id === ref.id)), ...more];
  return copied(plan, at, all).map((clip) => 'along' in clip.item &&
    clip.item.wall !== null && !walls.has(clip.item.wall ?? -1)
    ? {...clip, place: placeOf(clip.item, level)} : clip);
}
