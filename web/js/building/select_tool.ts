/** Selecting, moving, stretching and turning, and painting. */
import {openingTrouble} from './plan_check.js';
import {distance, fromLocal, minus, tidy, tidyPoint, toLocal} from './plane_geometry.js';
import {hitOf, itemsWithin, wallNear} from './hit_test.js';
import {attached, detached, isEmpty, itemOf, placeOf, update, wallYaw} from './plan.js';
import {moveEnd, moveItems} from './plan_moves.js';
import {NAMES} from './drawing_session.js';
import {SNAP_ANGLE, snapPolar} from './wall_snap.js';
import {Tool} from './tool.js';
import type {Kind, Ref} from './plan.js';
import type {Mouse} from './tool.js';
import type {Opening, Plan, Stairs, Wall} from '../protocol.js';
import type {Point} from './plane_geometry.js';
import type {Session} from './drawing_session.js';

/** A drag of an item or one of its handles. */
type Drag = {ref: Ref, part: string, from: Point, plan: Plan, moved?: boolean};

const QUARTER = Math.PI / 2;

export class SelectTool extends Tool {
  override name = 'select';
  override hint = isEmpty(this.session.plan) ? 'Choose Wall on the left, then click from corner to corner.' :
    'Click to select, drag to move, double-click to open the inspector.';
  #drag: Drag|null = null;
  /** Where a box that selects begins. */
  #box: Point|null = null;
  /** What is under the mouse. */
  hovered: {ref: Ref, part: string}|null = null;

  override press(mouse: Mouse) {
    const {session} = this;
    const hit = hitOf(session.plan, session.at, mouse.point,
      {tolerance: mouse.tolerance, selection: session.selection});
    if (!hit) {
      this.#box = mouse.point;
      if (!mouse.ctrl) session.select([]);
      return;
    }
    if (mouse.ctrl) {
      session.select(session.isSelected(hit.ref)
        ? session.selection.filter(({kind, id}) => kind !== hit.ref.kind || id !== hit.ref.id)
        : [...session.selection, hit.ref]);
      return;
    }
    if (!session.isSelected(hit.ref)) session.select([hit.ref]);
    this.#drag = {...hit, from: mouse.point, plan: session.history.plan, moved: false};
  }

  override move(mouse: Mouse) {
    const {session} = this;
    if (this.#box) {
      session.draft = {box: [this.#box, mouse.point]};
      session.changed();
      return;
    }
    const drag = this.#currentDrag();
    if (!drag) {
      this.hovered = hitOf(session.plan, session.at, mouse.point,
        {tolerance: mouse.tolerance, selection: session.selection});
      return;
    }
    if (!drag.moved && distance(drag.from, mouse.point) < mouse.tolerance / 2) return;
    drag.moved = true;
    session.preview(dragged(drag, mouse, session));
  }

  override release(mouse: Mouse): void {
    const {session} = this;
    if (this.#box) {
      const found = itemsWithin(session.level, this.#box, mouse.point);
      if (found.length) session.select(mouse.ctrl ? [...session.selection, ...found] : found);
      this.#box = null;
      session.draft = {};
      session.changed();
      return;
    }
    const drag = this.#currentDrag();
    this.#drag = null;
    if (!drag?.moved) return;
    const plan = dragged(drag, mouse, session);
    const fault = drag.part === 'body'
      ? troubleOf(plan, session.at, drag.ref) : '';
    if (fault) {
      session.preview(null);
      session.say(`Cannot move the ${NAMES[drag.ref.kind]} here: it ${fault}.`);
      return;
    }
    session.commit(plan, `${VERBS[drag.part] ?? 'resize'} ${NAMES[drag.ref.kind]}`);
  }

  /**
   * The drag, unless the plan was changed since the press: by a key, or in an inspector. Its end
   * would bring the plan of the press back.
   */
  #currentDrag() {
    if (this.#drag?.plan !== this.session.history.plan) this.#drag = null;
    return this.#drag;
  }

  /** Esc: first the drag, then the selection. */
  override cancel() {
    const {session} = this;
    const busy = Boolean(this.#drag?.moved || this.#box);
    this.#drag = null;
    this.#box = null;
    session.draft = {};
    if (busy) session.preview(null);
    return busy;
  }
}

/** Why an opening cannot stay where it was dragged; '' where it can, and for other items. */
function troubleOf(plan: Plan, at: number, ref: Ref) {
  const item = itemOf(plan, at, ref);
  return item && 'along' in item ? openingTrouble(plan.levels[at], item) : '';
}

const VERBS: Record<string, string> = {body: 'move', rotate: 'rotate'};

/** The plan after a drag, from the plan before it. */
export function dragged({ref, part, from, plan}: Drag, mouse: Mouse, {at, selection}: {at: number,
    selection: Ref[]}): Plan {
  const item = itemOf(plan, at, ref);
  if (!item) return plan;
  const by = minus(mouse.point, from);
  if ('start' in item && (part === 'start' || part === 'end')) return draggedEnd(plan, at, ref, item, part, mouse);
  if (part === 'rotate' && 'position' in item) return draggedTurn(plan, at, ref, item, mouse);
  if (part.startsWith('corner') && 'steps' in item) return draggedCorner(plan, at, ref, item, Number(part.slice(6)), mouse);
  if (part.startsWith('vertex') && 'outline' in item) {
    const outline = item.outline.map((point, n) =>
      n === Number(part.slice(6)) ? tidyPoint(mouse.point) : point);
    return update(plan, at, ref, {outline, fit: 'none'});
  }
  const alone = selection.length < 2;
  if (alone && 'along' in item) return draggedOpening(plan, at, ref, item, by, mouse);
  return moveItems(plan, at, alone ? [ref] : selection, by);
}

/** 15 degrees and 0.25 m about the other end; no foreign ends. Alt leaves linked walls behind. */
function draggedEnd(plan: Plan, at: number, ref: Ref, wall: Wall, end: 'start'|'end', mouse: Mouse) {
  const other = wall[end === 'start' ? 'end' : 'start'];
  const point = mouse.shift ? mouse.point : snapPolar(other, mouse.point, wall.thickness);
  if (distance(other, point) < 0.01) return plan;
  return moveEnd(plan, at, ref.id, end, point, {alone: mouse.alt});
}

function draggedTurn(plan: Plan, at: number, ref: Ref, item: {position: Point}, mouse: Mouse) {
  const angle = Math.atan2(mouse.point[1] - item.position[1], mouse.point[0] - item.position[0]) - QUARTER;
  const step = ref.kind === 'stairs' ? QUARTER : SNAP_ANGLE;
  const yaw = mouse.shift ? angle : Math.round(angle / step) * step;
  return update(plan, at, ref, {yaw: Math.round(Math.atan2(Math.sin(yaw), Math.cos(yaw)) * 1e9) / 1e9 + 0});
}

/** The opposite corner stays. */
function draggedCorner(plan: Plan, at: number, ref: Ref, stairs: Stairs, corner: number, mouse: Mouse) {
  const signs = [[-1, -1], [1, -1], [1, 1], [-1, 1]][corner];
  const fixed = fromLocal([-signs[0] * stairs.width / 2, -signs[1] * stairs.depth / 2],
    stairs.position, stairs.yaw);
  const [x, y] = toLocal(mouse.point, fixed, stairs.yaw);
  const width = Math.max(tidy(x * signs[0]), 0.1);
  const depth = Math.max(tidy(y * signs[1]), 0.1);
  const position = fromLocal([signs[0] * width / 2, signs[1] * depth / 2], fixed, stairs.yaw);
  return update(plan, at, ref, {width, depth, position: tidyPoint(position)});
}

/** Along its wall; out of it beyond 0.3 m; into another wall that is near. */
function draggedOpening(plan: Plan, at: number, ref: Ref, opening: Opening, by: Point, mouse: Mouse) {
  const level = plan.levels[at];
  const {point, yaw} = placeOf(opening, level);
  const wanted = [point[0] + by[0], point[1] + by[1]];
  const near = wallNear(level, opening.wall === null ? wanted : mouse.point);
  if (!near) return update(plan, at, ref, detached(opening, wanted, yaw));
  const own = near.wall.id === opening.wall;
  const along = own ? opening.along + alongBy(near.wall, by) : near.along;
  return update(plan, at, ref, attached(opening, near.wall, along));
}

function alongBy(wall: Wall, by: Point) {
  const yaw = wallYaw(wall);
  return by[0] * Math.cos(yaw) + by[1] * Math.sin(yaw);
}

/** Paints the wall, stairs or floor that is clicked, here or in the 3D view: once, with Shift further ones. */
export class PaintTool extends Tool {
  look;
  override name = 'paint';
  override hint = 'Click a wall, floor or stairs, here or in the 3D view, to apply the look. Hold Shift to paint several.';

  /** What is shown painted. */
  #hovered = '';

  constructor(session: Session, look: {color?: string, texture?: string}) {
    super(session);
    this.look = look;
  }

  override press(mouse: Mouse) {
    const {session} = this;
    const target = this.#target(mouse);
    if (target) this.paint(session.at, target, mouse.shift);
  }

  override move(mouse: Mouse) { this.hover(this.session.at, this.#target(mouse)); }

  /** Shows what painting would do. */
  hover(at: number, ref: Ref|null) {
    const key = ref ? `${at}${ref.kind}${ref.id}` : '';
    if (key === this.#hovered) return;
    this.#hovered = key;
    const {session} = this;
    session.preview(ref ? update(session.history.plan, at, ref, this.look) : null);
  }

  /** With `goesOn` the tool stays active. */
  paint(at: number, ref: Ref, goesOn = false) {
    const {session} = this;
    session.commit(update(session.history.plan, at, ref, this.look),
      `set ${this.look.texture ? 'texture' : 'color'} of ${NAMES[ref.kind]}`);
    if (!goesOn) session.endTool();
  }

  override cancel() {
    this.session.preview(null);
    return false;
  }

  #target(mouse: Mouse) {
    const {session} = this;
    const ref = hitOf(session.history.plan, session.at, mouse.point, {tolerance: mouse.tolerance})?.ref;
    return ref && paintable(ref) ? ref : null;
  }
}

export const paintable = ({kind}: {kind: Kind}) => ['walls', 'stairs', 'floors'].includes(kind);

