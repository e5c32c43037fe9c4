/** Bars that change the size of a panel, by mouse or arrow keys; the size is remembered. */
import {followPointer, h, remembered} from './dom.js';

/** A bar that lies between two panels, for `splitter`. */
export function lyingBar(label: string) {
  return h('div', {
    class: 'splitter horizontal',
    role: 'separator',
    tabindex: 0,
    'aria-label': label,
    'aria-orientation': 'horizontal',
  });
}

/** @param options  `from`: the side of `within` that the size counts from */
export function splitter(bar: HTMLElement, {key, initial, min, max, from, within,
    apply}: {key: string, initial: number, min: number, max: number,
    from: 'left'|'right'|'bottom', within: HTMLElement, apply: (size: number) => void}) {
  let size = 0;
  const set = (wanted: number, keep = true) => {
    size = Math.round(Math.min(Math.max(wanted, min), max));
    bar.setAttribute('aria-valuenow', String(size));
    apply(size);
    if (keep) remembered.set(key, size);
  };
  bar.setAttribute('aria-valuemin', String(min));
  bar.setAttribute('aria-valuemax', String(max));
  const sizeAt = (event: PointerEvent) => {
    const box = within.getBoundingClientRect();
    if (from === 'left') return event.clientX - box.left;
    if (from === 'right') return box.right - event.clientX;
    return box.bottom - event.clientY;
  };
  bar.addEventListener('pointerdown', (event) => {
    const offset = size - sizeAt(event);
    followPointer(bar, event, (moved) => set(sizeAt(moved) + offset));
  });
  const [less, more] = {
    left: ['ArrowLeft', 'ArrowRight'],
    right: ['ArrowRight', 'ArrowLeft'],
    bottom: ['ArrowDown', 'ArrowUp'],
  }[from];
  bar.addEventListener('keydown', (event) => {
    if (event.key !== less && event.key !== more) return;
    event.preventDefault();
    event.stopPropagation();
    set(size + (event.key === more ? 20 : -20));
  });
  set(remembered.get(key, initial), false);
}
