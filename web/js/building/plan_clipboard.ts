/** Copying and pasting items of a plan. */
import {add, detached, itemOf, OPENING_KINDS, placeOf} from './plan.js';
import {plus, tidyPoint} from './plane_geometry.js';
import type {Plan} from '../protocol.js';
import type {AnyItem, Kind, Ref} from './plan.js';
import type {Point} from './plane_geometry.js';

/** A copied item; `place`: where an opening is whose wall was not copied. */
export type Clip = {kind: Kind, item: AnyItem, place?: {point: Point, yaw: number}};

/** The referenced items as clips. */
function clipsOf(plan: Plan, at: number, refs: Ref[]) {
  return refs.flatMap((ref) => {
    const item = itemOf(plan, at, ref);
    return item ? [{kind: ref.kind, item}] : [];
  });
}

/** Adds copies, moved by a vector; openings of copied walls go into the copies, others stand free. */
export function pasted(plan: Plan, at: number, clips: Clip[], by: Point): {plan: Plan, refs: Ref[]} {
  /** From the ids of copied walls to those of the copies. */
  const walls: Map<number|null|undefined, number> = new Map();
  const refs: Ref[] = [];
  let made = plan;
  /** @param item  whose id is not taken over */
  const put = (kind: Kind, {id: _, ...fields}: AnyItem) => {
    const grown = add(made, at, kind, fields);
    made = grown.plan;
    refs.push(grown.ref);
    return grown.ref.id;
  };
  const shifted = (point: Point) => tidyPoint(plus(point, by));
  for (const {kind, item} of clips) {
    if (!('start' in item)) continue;
    walls.set(item.id, put(kind, {...item, start: shifted(item.start), end: shifted(item.end)}));
  }
  for (const {kind, item, place} of clips) {
    if ('start' in item) continue;
    if ('outline' in item) {
      put(kind, {...item, outline: item.outline.map(shifted),
        holes: item.holes.map((hole) => hole.map(shifted)), fit: 'none'});
      continue;
    }
    const wall = 'along' in item ? walls.get(item.wall) : undefined;
    if (wall !== undefined) {
      put(kind, {...item, wall});
    } else if ('along' in item && place) {
      put(kind, detached(item, shifted(place.point), place.yaw));
    } else {
      put(kind, {...item, position: shifted(item.position)});
    }
  }
  return {plan: made, refs};
}

/** As `clipsOf`, with the openings of copied walls and the places of those whose walls stay behind. */
export function clipboardOf(plan: Plan, at: number, refs: Ref[]) {
  const level = plan.levels[at];
  const walls = new Set(refs.filter(({kind}) => kind === 'walls').map(({id}) => id));
  const more = OPENING_KINDS.flatMap((kind) => level[kind]
    .filter((item) => walls.has(item.wall ?? -1)).map(({id}) => ({kind, id})));
  const all = [...refs.filter((ref) => !more.some((one) => one.kind === ref.kind && one.id === ref.id)), ...more];
  return clipsOf(plan, at, all).map((clip) => 'along' in clip.item &&
    clip.item.wall !== null && !walls.has(clip.item.wall ?? -1)
    ? {...clip, place: placeOf(clip.item, level)} : clip);
}
