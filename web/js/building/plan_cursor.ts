/** A cursor on the plan for the keyboard: arrow keys move it, the space bar clicks at its place. */
import {set, svg} from '../ui/svg.js';
import {SCALE} from './plan_svg.js';
import {tidyPoint} from './plane_geometry.js';
import type {Canvas} from './plan_canvas.js';
import type {Point} from './plane_geometry.js';
import type {Session} from './drawing_session.js';

/** Metres of one press; with Shift the finer one. */
const STEP = 0.25;
const FINE = 0.05;
const WAYS: Record<string, Point> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};
/** Pixels between the cursor and the edge of the sheet. */
const EDGE = 40;

/** @returns takes a key press on the sheet; whether it was one of the cursor's keys */
export function planCursor({session, canvas}: {session: Session, canvas: Canvas}): (event: KeyboardEvent) => boolean {
  const mark = svg('path', {class: 'cursor', d: 'M-10 0H10M0 -10V10', visibility: 'hidden'});
  canvas.world.append(mark);
  canvas.element.addEventListener('pointermove', () => set(mark, {visibility: 'hidden'}));
  let point: Point = [0, 0];
  let free = false;
  const mouse = () => ({point, shift: free, alt: false, ctrl: false, tolerance: canvas.tolerance});
  const show = () => {
    const {zoom, x, y} = canvas.view;
    const at = [point[0] * SCALE, -point[1] * SCALE];
    set(mark, {visibility: 'visible', transform: `translate(${at[0]} ${at[1]}) scale(${1 / zoom})`});
    const {width, height} = canvas.element.getBoundingClientRect();
    const missing = (value: number, size: number) => Math.min(Math.max(value, EDGE), size - EDGE) - value;
    const [dx, dy] = [missing(at[0] * zoom + x, width), missing(at[1] * zoom + y, height)];
    if (dx || dy) canvas.pan(dx, dy);
  };
  return (event) => {
    const way = WAYS[event.key];
    if (event.target !== canvas.element || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (way) {
      free = event.shiftKey;
      const step = free ? FINE : STEP;
      point = tidyPoint([point[0] + way[0] * step, point[1] + way[1] * step]);
      session.tool.move(mouse());
      session.say(`x ${point[0].toFixed(2)} m, y ${point[1].toFixed(2)} m: Space clicks, Shift moves by ${FINE} m.`);
    } else if (event.key === ' ') {
      session.tool.press(mouse());
      session.tool.release(mouse());
    } else return false;
    show();
    return true;
  };
}
