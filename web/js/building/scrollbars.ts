/** Scroll bars for a sheet without end: they span what is drawn and what is seen. */
import {followPointer, h} from '../ui/dom.js';
import {extentOf} from './plan_canvas.js';
import {SCALE} from './plan_svg.js';
import type {Canvas} from './plan_canvas.js';
import type {Session} from './drawing_session.js';

/**
 * @param element  holds the sheet
 * @returns brings them up to date
 */
export function mountScrollbars(element: HTMLElement, {session,
    canvas}: {session: Session,
    canvas: Canvas}): () => void {
  const bars = (['across', 'down'] as const).map((way) => {
    const thumb = h('div', {class: 'thumb'});
    const track = h('div', {class: `scroll ${way}`, 'aria-hidden': 'true'}, thumb);
    element.append(track);
    return {way, thumb, track, size: 1};
  });
  for (const bar of bars) {
    bar.thumb.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      let last = [event.clientX, event.clientY];
      followPointer(bar.thumb, event, (moved) => {
        const by = bar.way === 'across' ? moved.clientX - last[0] : moved.clientY - last[1];
        last = [moved.clientX, moved.clientY];
        const whole = -by / bar.size;
        canvas.pan(bar.way === 'across' ? whole : 0, bar.way === 'down' ? whole : 0);
      });
    });
  }
  return () => {
    const {width, height} = canvas.element.getBoundingClientRect();
    const {zoom, x, y} = canvas.view;
    const [x0, y0, x1, y1] = extentOf(session.level) ?? [0, 0, 0, 0];
    const margin = 5 * SCALE * zoom;
    const spans = {
      across: [Math.min(x0 * SCALE * zoom + x - margin, 0), Math.max(x1 * SCALE * zoom + x + margin, width), width],
      down: [Math.min(-y1 * SCALE * zoom + y - margin, 0), Math.max(-y0 * SCALE * zoom + y + margin, height), height],
    };
    for (const bar of bars) {
      const [from, to, seen] = spans[bar.way];
      bar.size = seen / (to - from) || 1;
      const [start, length] = [`${-from / (to - from) * 100}%`, `${bar.size * 100}%`];
      Object.assign(bar.thumb.style, bar.way === 'across'
        ? {left: start, width: length} : {top: start, height: length});
    }
  };
}
