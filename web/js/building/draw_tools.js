/** Tools that put new things into the plan. */
import {openingTrouble} from './plan_check.js';
import {direction, distance, inPolygon, isSimple, polar, same, tidyPoint} from './plane_geometry.js';
import {wallNear} from './hit_test.js';
import {
  DEFAULTS, GROUND_FLOOR_THICKNESS, add, attached, detached, outerLength, withLevel,
} from './plan.js';
import {roomsOf} from './rooms.js';
import {snapEnd, snapPolar, snapStart} from './wall_snap.js';
import {Tool} from './tool.js';
/** @import {FloorImage, Plan} from '../protocol.js' */
/** @import {Mouse} from './tool.js' */
/** @import {OpeningKind} from './plan.js' */
/** @import {Point} from './plane_geometry.js' */
/** @import {Session} from './drawing_session.js' */

export class WallTool extends Tool {
  name = 'wall';
  hint = 'Click to start a wall. Hold Shift to disable snapping.';
  /** Direction of the mouse from the start, rad. */
  #aim = 0;
  /** @type {Point|null} */
  #from = null;
  /** The first corner of the chain of walls. @type {Point|null} */
  #first = null;

  /** @param {Mouse} mouse */
  press(mouse) {
    const {session} = this;
    if (!this.#from) {
      this.#first = this.#from = snapStart(mouse.point, {walls: session.level.walls, free: mouse.shift});
      this.#say();
    } else {
      this.#put(this.#from, this.#end(this.#from, mouse).point);
    }
    this.move(mouse);
  }

  /** @param {Mouse} mouse */
  move(mouse) {
    const {session} = this;
    if (!this.#from) {
      const point = snapStart(mouse.point, {walls: session.level.walls, free: mouse.shift});
      session.draft = {mark: point};
    } else {
      const {point, on} = this.#end(this.#from, mouse);
      const {thickness} = DEFAULTS.walls;
      session.draft = {segment: {start: this.#from, end: point, thickness, on},
        mark: on === 'end' || on === 'wall' ? point : null};
      this.#aim = direction(this.#from, point);
    }
    session.changed();
  }

  /** The second click of a double click has already put the wall. */
  double() { this.cancel(); }

  /** A typed outer length, in the direction of the mouse. @param {number|null} length */
  typed(length) {
    if (!this.#from || !length || length <= 0) return;
    const inner = Math.max(length - DEFAULTS.walls.thickness, 0.01);
    this.#put(this.#from, tidyPoint(polar(this.#from, this.#aim, inner)));
  }

  cancel() {
    const busy = this.#from !== null;
    this.#from = null;
    this.session.draft = {};
    this.session.say('');
    return busy;
  }

  /** @param {Point} from @param {Mouse} mouse */
  #end(from, mouse) {
    return snapEnd(from, mouse.point, {
      walls: this.session.level.walls, thickness: DEFAULTS.walls.thickness, free: mouse.shift});
  }

  /** @param {Point} from @param {Point} end */
  #put(from, end) {
    const {session} = this;
    if (distance(from, end) < 0.01) {
      session.say('A wall must be at least 0.01 m long.');
      return;
    }
    const {plan} = add(session.history.plan, session.at, 'walls', {start: from, end});
    session.commit(plan, 'add wall');
    if (this.#first && same(end, this.#first)) {
      this.cancel();
      return;
    }
    this.#from = end;
    session.draft = {};
    this.#say();
  }

  #say() {
    this.session.say('Click to end the wall and start the next one, or type a length and press '
      + 'Enter. Click the first corner, double-click, right-click or press Esc to finish.');
  }
}

/** Puts windows and doors into walls, or to stand free. */
export class OpeningTool extends Tool {
  #kind;

  /** @param {Session} session @param {OpeningKind} kind */
  constructor(session, kind) {
    super(session);
    this.#kind = kind;
    this.name = kind === 'windows' ? 'window' : 'door';
    this.hint = `Click on a wall to place the ${this.name}.`;
  }

  /** @param {Mouse} mouse */
  press(mouse) {
    const {opening, fault} = this.#at(mouse.point);
    if (fault) {
      this.session.say(`Cannot place the ${this.name} here: it ${fault}.`);
      return;
    }
    const {id: _, ...fields} = opening;
    this.insert(this.#kind, fields, `add ${this.name}`);
  }

  /** @param {Mouse} mouse */
  move(mouse) {
    const {opening, fault} = this.#at(mouse.point);
    this.session.draft = {opening: {kind: this.#kind, item: opening, fault}};
    this.session.changed();
  }

  /** @param {Point} point */
  #at(point) {
    const {level} = this.session;
    const fresh = {id: -1, ...DEFAULTS[this.#kind]};
    const near = wallNear(level, point);
    const opening = near ? attached(fresh, near.wall, near.along) : detached(fresh, point, 0);
    return {opening, fault: openingTrouble(level, opening)};
  }
}

export class StairsTool extends Tool {
  name = 'stairs';
  hint = 'Click to place the stairs; drag the handles to rotate and resize them.';

  /** @param {Mouse} mouse */
  press(mouse) { this.insert('stairs', this.#at(mouse), 'add stairs'); }

  /** @param {Mouse} mouse */
  move(mouse) {
    this.session.draft = {stairs: {...DEFAULTS.stairs, ...this.#at(mouse)}};
    this.session.changed();
  }

  /** @param {Mouse} mouse */
  #at(mouse) {
    return {position: tidyPoint(mouse.point), height: this.session.level.height};
  }
}

/** Floors: a click in a closed room fills it; clicks elsewhere draw corner after corner. */
export class FloorTool extends Tool {
  name = 'floor';
  hint = 'Click in a room to fill it, or click corner by corner. Hold Alt to place corners in a room.';
  /** @type {Point[]} */
  #points = [];

  /** @param {Mouse} mouse */
  press(mouse) {
    const room = !this.#points.length && !mouse.alt && this.#room(mouse.point);
    if (room) {
      this.#put(room.outline, 'add floor');
      return;
    }
    const point = this.#snapped(mouse);
    if (this.#points.length >= 3 && same(point, this.#points[0])) {
      this.#close();
      return;
    }
    if (this.#points.length && same(point, this.#points[this.#points.length - 1])) return;
    this.#points.push(point);
    this.session.say('Click the next corner; click the first one, press Enter or double-click to close the floor.');
    this.move(mouse);
  }

  /** @param {Mouse} mouse */
  move(mouse) {
    const {session} = this;
    const room = !this.#points.length && !mouse.alt && this.#room(mouse.point);
    session.draft = room ? {polygon: {points: room.outline, closed: true}}
      : {polygon: {points: [...this.#points, this.#snapped(mouse)]}};
    session.changed();
  }

  double() {
    if (this.#points.length >= 3) this.#close();
  }

  /** @param {number|null} length */
  typed(length) {
    if (length === null) this.double();
  }

  cancel() {
    const busy = this.#points.length > 0;
    this.#points = [];
    this.session.draft = {};
    this.session.say('');
    return busy;
  }

  /** @param {Point} point */
  #room(point) {
    return roomsOf(this.session.level.walls).find((room) => inPolygon(point, room.outline));
  }

  /** @param {Mouse} mouse */
  #snapped(mouse) {
    if (mouse.shift) return tidyPoint(mouse.point);
    const first = this.#points[0];
    if (this.#points.length >= 3 && distance(first, mouse.point) < 0.3) return first;
    const end = snapStart(mouse.point, {walls: this.session.level.walls});
    const last = this.#points[this.#points.length - 1];
    if (!last || !same(end, tidyPoint(mouse.point))) return end;
    return snapPolar(last, mouse.point, 0);
  }

  #close() {
    const points = this.#points;
    if (!isSimple(points)) {
      this.session.say('The floor outline intersects itself; press Esc to start over.');
      return;
    }
    this.#points = [];
    this.#put(points, 'add floor');
  }

  /** @param {Point[]} outline @param {string} label */
  #put(outline, label) {
    const thickness = this.session.at === 0 ? GROUND_FLOOR_THICKNESS : DEFAULTS.floors.thickness;
    this.insert('floors', {outline, thickness}, label);
  }
}

/**
 * A line over a known length of the floor plan; `done(metres)` gets what it measures at present.
 */
export class MeasureTool extends Tool {
  name = 'measure';
  hint = 'Drag a line along a known length.';
  /** @type {Point|null} */
  #from = null;

  /** @param {Session} session @param {(metres: number) => void} done */
  constructor(session, done) {
    super(session);
    this.done = done;
  }

  /** @param {Mouse} mouse */
  press(mouse) {
    if (this.#from) this.#finish(mouse);
    else this.#from = mouse.point;
  }

  /** @param {Mouse} mouse */
  move(mouse) {
    this.session.draft = this.#from ? {measure: [this.#from, mouse.point]} : {};
    this.session.changed();
  }

  /** A drag ends it; after a click the second click does. @param {Mouse} mouse */
  release(mouse) {
    if (this.#from && distance(this.#from, mouse.point) > 2 * mouse.tolerance) this.#finish(mouse);
  }

  cancel() {
    const busy = this.#from !== null;
    this.#from = null;
    this.session.draft = {};
    return busy;
  }

  /** @param {Mouse} mouse */
  #finish(mouse) {
    const length = this.#from ? distance(this.#from, mouse.point) : 0;
    this.#from = null;
    if (length > 1e-3) this.done(length);
  }
}

/**
 * The resolution after a line of `drawn` metres turned out to be `real` metres long.
 * @param {FloorImage} image
 * @param {number} drawn
 * @param {number} real
 */
export const rescaled = (image, drawn, real) =>
  ({...image, resolution: image.resolution * drawn / real});

/**
 * @param {Plan} plan
 * @param {number} at
 * @param {FloorImage|null} image
 */
export const withImage = (plan, at, image) => withLevel(plan, at, {image});

/**
 * Labels of a wall being drawn: outer length, and its angle in degrees.
 * @param {{start: Point, end: Point, thickness: number}} options
 */
export function segmentWords({start, end, thickness}) {
  const degrees = Math.round((direction(start, end) * 180 / Math.PI + 360) % 360 * 10) / 10;
  return `${outerLength({start, end, thickness}).toFixed(2)} m  ${degrees % 360}°`;
}

