/** What the plan says of itself: areas of rooms, lengths of what is drawn or selected. */
import {metres} from './plan_check.js';
import {segmentWords} from './draw_tools.js';
import {distance, labelPoint, polar} from './plane_geometry.js';
import {openingDistances} from './hit_test.js';
import {itemOf, outerLength, placeOf, wallLength, wallYaw} from './plan.js';
import {roomsOf} from './rooms.js';
import type {Level, Opening, Wall} from '../protocol.js';
import type {Point} from './plane_geometry.js';
import type {Session} from './drawing_session.js';

/** A text on the sheet: where, what, and its class. */
type SheetLabel = [Point, string, string];

export function labelsOf(session: Session): SheetLabel[] {
  const words: SheetLabel[] = [];
  for (const room of roomsOf(session.level.walls)) {
    words.push([labelPoint(room.outline), `${room.area.toFixed(2)} m²`, 'area']);
  }
  const {segment, measure, opening, polygon} = session.draft;
  if (segment) words.push([polar(segment.end, Math.PI / 4, 0.3), segmentWords(segment), 'live']);
  if (measure) words.push([measure[1], metres(distance(measure[0], measure[1])), 'live']);
  if (polygon && !polygon.closed && polygon.points.length > 1) {
    const [before, last] = polygon.points.slice(-2);
    words.push([last, `${distance(before, last).toFixed(2)} m`, 'live']);
  }
  if (opening && opening.item.wall !== null) words.push(...openingWords(opening.item, session.level));
  for (const ref of session.selection.slice(0, 40)) {
    const item = itemOf(session.plan, session.at, ref);
    if (!item) continue;
    if ('start' in item) {
      words.push(wallWord(item, session.selection.length === 1 ? segmentWords(item)
        : `${outerLength(item).toFixed(2)} m`));
    } else if ('along' in item && item.wall !== null) {
      words.push(...openingWords(item, session.level));
    } else if ('steps' in item) {
      words.push([item.position, `${item.width.toFixed(2)} × ${item.depth.toFixed(2)} m`, '']);
    }
  }
  return words;
}

function wallWord(wall: Wall, words: string): SheetLabel {
  const yaw = wallYaw(wall);
  const middle = polar(wall.start, yaw, wallLength(wall) / 2);
  return [polar(middle, yaw + Math.PI / 2, 0.25), words, 'length'];
}

/** The distances from an opening to both ends of its wall. */
function openingWords(item: Opening, level: Level): SheetLabel[] {
  const {wall} = placeOf(item, level);
  if (!wall) return [];
  const {start, end, yaw} = openingDistances(item, wall);
  const word = (along: number, value: number) => [polar(polar(wall.start, yaw, along),
      yaw - Math.PI / 2, 0.25),
    `${value.toFixed(2)} m`, 'length'] as SheetLabel;
  return [word(start / 2, start), word(wallLength(wall) - end / 2, end)];
}
