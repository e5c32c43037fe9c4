/** Tools that put new things into the plan. */
import {openingTrouble} from './plan_check.js';
import {direction, distance, inPolygon, isSimple, polar, same, tidyPoint} from './plane_geometry.js';
import {wallNear} from './hit_test.js';
import {
  DEFAULTS, GROUND_FLOOR_THICKNESS, add, attached, detached, outerLength, withLevel,
} from './plan.js';
import {roomsOf} from './rooms.js';
import {snapEnd, snapFirst, snapPolar, snapStart} from './wall_snap.js';
import {Tool} from './tool.js';
import type {FloorImage, Plan} from '../protocol.js';
import type {Mouse} from './tool.js';
import type {OpeningKind} from './plan.js';
import type {Point} from './plane_geometry.js';
import type {Session} from './drawing_session.js';

export class WallTool extends Tool {
  override name = 'wall';
  override hint = 'Click to start a wall. Hold Shift to disable snapping.';
  /** Direction of the mouse from the start, rad. */
  #aim = 0;
  #from: Point|null = null;
  /** The first corner of the chain of walls. */
  #first: Point|null = null;

  override press(mouse: Mouse) {
    const {session} = this;
    if (!this.#from) {
      this.#first = this.#from = snapFirst(mouse.point, {walls: session.level.walls, free: mouse.shift});
      this.#say();
    } else {
      this.#put(this.#from, this.#end(this.#from, mouse).point);
    }
    this.move(mouse);
  }

  override move(mouse: Mouse) {
    const {session} = this;
    if (!this.#from) {
      const point = snapFirst(mouse.point, {walls: session.level.walls, free: mouse.shift});
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
  override double() { this.cancel(); }

  /** A typed outer length, in the direction of the mouse. */
  override typed(length: number|null) {
    if (!this.#from || !length || length <= 0) return;
    const inner = Math.max(length - DEFAULTS.walls.thickness, 0.01);
    this.#put(this.#from, tidyPoint(polar(this.#from, this.#aim, inner)));
  }

  override cancel() {
    const busy = this.#from !== null;
    this.#from = null;
    this.session.draft = {};
    this.session.say('');
    return busy;
  }

  #end(from: Point, mouse: Mouse) {
    return snapEnd(from, mouse.point, {
      walls: this.session.level.walls, thickness: DEFAULTS.walls.thickness, free: mouse.shift});
  }

  #put(from: Point, end: Point) {
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
  override name;
  override hint;
  #kind;

  constructor(session: Session, kind: OpeningKind) {
    super(session);
    this.#kind = kind;
    this.name = kind === 'windows' ? 'window' : 'door';
    this.hint = `Click on a wall to place the ${this.name}.`;
  }

  override press(mouse: Mouse) {
    const {opening, fault} = this.#at(mouse.point);
    if (fault) {
      this.session.say(`Cannot place the ${this.name} here: it ${fault}.`);
      return;
    }
    const {id: _, ...fields} = opening;
    this.insert(this.#kind, fields, `add ${this.name}`);
  }

  override move(mouse: Mouse) {
    const {opening, fault} = this.#at(mouse.point);
    this.session.draft = {opening: {kind: this.#kind, item: opening, fault}};
    this.session.changed();
  }

  #at(point: Point) {
    const {level} = this.session;
    const fresh = {id: -1, ...DEFAULTS[this.#kind]};
    const near = wallNear(level, point);
    const opening = near ? attached(fresh, near.wall, near.along) : detached(fresh, point, 0);
    return {opening, fault: openingTrouble(level, opening)};
  }
}

export class StairsTool extends Tool {
  override name = 'stairs';
  override hint = 'Click to place the stairs; drag the handles to rotate and resize them.';

  override press(mouse: Mouse) { this.insert('stairs', this.#at(mouse), 'add stairs'); }

  override move(mouse: Mouse) {
    this.session.draft = {stairs: {...DEFAULTS.stairs, ...this.#at(mouse)}};
    this.session.changed();
  }

  #at(mouse: Mouse) {
    return {position: tidyPoint(mouse.point), height: this.session.level.height};
  }
}

/** Floors: a click in a closed room fills it; clicks elsewhere draw corner after corner. */
export class FloorTool extends Tool {
  override name = 'floor';
  override hint = 'Click in a room to fill it, or click corner by corner. Hold Alt to place corners in a room.';
  #points: Point[] = [];

  override press(mouse: Mouse) {
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

  override move(mouse: Mouse) {
    const {session} = this;
    const room = !this.#points.length && !mouse.alt && this.#room(mouse.point);
    session.draft = room ? {polygon: {points: room.outline, closed: true}}
      : {polygon: {points: [...this.#points, this.#snapped(mouse)]}};
    session.changed();
  }

  override double() {
    if (this.#points.length >= 3) this.#close();
  }

  override typed(length: number|null) {
    if (length === null) this.double();
  }

  override cancel() {
    const busy = this.#points.length > 0;
    this.#points = [];
    this.session.draft = {};
    this.session.say('');
    return busy;
  }

  #room(point: Point) {
    return roomsOf(this.session.level.walls).find((room) => inPolygon(point, room.outline));
  }

  #snapped(mouse: Mouse) {
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

  #put(outline: Point[], label: string) {
    const thickness = this.session.at === 0 ? GROUND_FLOOR_THICKNESS : DEFAULTS.floors.thickness;
    this.insert('floors', {outline, thickness}, label);
  }
}

/**
 * A line over a known length of the floor plan; `done(metres)` gets what it measures at present.
 */
export class MeasureTool extends Tool {
  done;
  override name = 'measure';
  override hint = 'Drag a line along a known length.';
  #from: Point|null = null;

  constructor(session: Session, done: (metres: number) => void) {
    super(session);
    this.done = done;
  }

  override press(mouse: Mouse) {
    if (this.#from) this.#finish(mouse);
    else this.#from = mouse.point;
  }

  override move(mouse: Mouse) {
    this.session.draft = this.#from ? {measure: [this.#from, mouse.point]} : {};
    this.session.changed();
  }

  /** A drag ends it; after a click the second click does. */
  override release(mouse: Mouse) {
    if (this.#from && distance(this.#from, mouse.point) > 2 * mouse.tolerance) this.#finish(mouse);
  }

  override cancel() {
    const busy = this.#from !== null;
    this.#from = null;
    this.session.draft = {};
    return busy;
  }

  #finish(mouse: Mouse) {
    const length = this.#from ? distance(this.#from, mouse.point) : 0;
    this.#from = null;
    if (length > 1e-3) this.done(length);
  }
}

/** The resolution after a line of `drawn` metres turned out to be `real` metres long. */
export const rescaled = (image: FloorImage, drawn: number, real: number) =>
  ({...image, resolution: image.resolution * drawn / real});

export const withImage = (plan: Plan, at: number, image: FloorImage|null) => withLevel(plan, at,
    {image});

/** Labels of a wall being drawn: outer length, and its angle in degrees. */
export function segmentWords({start, end, thickness}: {start: Point, end: Point, thickness: number}) {
  const degrees = Math.round((direction(start, end) * 180 / Math.PI + 360) % 360 * 10) / 10;
  return `${outerLength({start, end, thickness}).toFixed(2)} m  ${degrees % 360}°`;
}

