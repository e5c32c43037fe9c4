/**
 * The icons: our own drawings on a 20x20 grid, in the colour of the text around them.
 */
import {h} from './dom.js';
import {svg} from './svg.js';

/** Path data by name; `fill:` in front means a filled shape, else a line. */
const SHAPES: Record<string, string[]> = {
  select: ['fill:M5 2.5v13l3.4-3 2.1 5 2.2-.9-2.1-4.9 4.4-.4z'],
  translate: [
    'M10 2v16M2 10h16',
    'M7.5 4.5 10 2l2.5 2.5M7.5 15.5 10 18l2.5-2.5M4.5 7.5 2 10l2.5 2.5M15.5 7.5 18 10l-2.5 2.5',
  ],
  rotate: ['M16.5 10a6.5 6.5 0 1 1-2-4.7', 'fill:M15.8 1.8v5.4h-5.4z'],
  scale: ['M3 11v6h6z', 'M7 13 16 4M10.5 3.5h6v6'],
  undo: ['M4 8h8a4.5 4.5 0 0 1 0 9H7', 'M7.5 4 3.5 8l4 4'],
  redo: ['M16 8H8a4.5 4.5 0 0 0 0 9h5', 'M12.5 4l4 4-4 4'],
  down: ['M6 8l4 4 4-4'],
  right: ['M8 6l4 4-4 4'],
  left: ['M12 6l-4 4 4 4'],
  begin: ['M5 4v12', 'fill:M15.5 4v12l-8-6z'],
  end: ['M15 4v12', 'fill:M4.5 4v12l8-6z'],
  box: ['M10 2.5 17 6v8l-7 3.5L3 14V6z', 'M3 6l7 3.5L17 6M10 9.5v8'],
  sensor: ['M10 8.5a1.5 1.5 0 1 0 0 3 1.5 1.5 0 0 0 0-3z', 'M6 6a5.7 5.7 0 0 0 0 8M14 6a5.7 5.7 0 0 1 0 8M3.5 3.5a9.2 9.2 0 0 0 0 13M16.5 3.5a9.2 9.2 0 0 1 0 13'],
  group: ['M2.5 5.5h8v8h-8z', 'M9.5 8.5h8v8h-8z'],
  sphere: [
    'M10 3a7 7 0 1 0 0 14 7 7 0 0 0 0-14z',
    'M3 10c2.5 3 11.5 3 14 0M10 3c-3.5 3-3.5 11 0 14',
  ],
  cylinder: ['M4 5v10c0 3.3 12 3.3 12 0V5', 'M4 5c0-3.3 12-3.3 12 0s-12 3.3-12 0z'],
  point: [
    'M10 6.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7z',
    'M10 1.5v2.5M10 16v2.5M1.5 10H4M16 10h2.5',
    'M4 4l1.8 1.8M14.2 14.2 16 16M16 4l-1.8 1.8M5.8 14.2 4 16',
  ],
  spot: [
    'M10 2.5 4.5 13h11z',
    'M4.5 13c0 2.6 11 2.6 11 0',
    'M6 17.5l.5-1M10 18.5v-1M14 17.5l-.5-1',
  ],
  directional: [
    'M4 3h12',
    'M5.5 6v9M10 6v11M14.5 6v9',
    'M3.5 13l2 2.5 2-2.5M8 15l2 2.5 2-2.5M12.5 13l2 2.5 2-2.5',
  ],
  copy: ['M7 7h9v10H7z', 'M13 7V3H4v10h3'],
  paste: ['M4 4h12v13H4z', 'M7.5 2.5h5v3h-5z', 'M7 9h6M7 12h6'],
  align: ['M3 2v16', 'fill:M5.5 4.5h11v4h-11zM5.5 11.5h6v4h-6z'],
  measure: ['M3 14 14 3l3 3L6 17z', 'M6 11l1.5 1.5M9 8l2.5 2.5M12 5l1.5 1.5'],
  snap: ['M5 3v7a5 5 0 0 0 10 0V3h-3.5v7a1.5 1.5 0 0 1-3 0V3z', 'M5 6h3.5M11.5 6H15'],
  views: ['M10 2.5 17 6v8l-7 3.5L3 14V6z', 'fill:M3 6l7 3.5v8L3 14z', 'M3 6l7 3.5L17 6'],
  camera: ['M3 6h3.5l1.5-2h4l1.5 2H17v10H3z', 'M10 8a3 3 0 1 0 0 6 3 3 0 0 0 0-6z'],
  video: ['M2.5 5.5h10v9h-10z', 'M12.5 9l5-3v8l-5-3'],
  log: ['M10 3a7 7 0 1 0 0 14 7 7 0 0 0 0-14z', 'fill:M10 7a3 3 0 1 0 0 6 3 3 0 0 0 0-6z'],
  plot: ['M3 3v14h14', 'M5 13l3-5 3 3 5-7'],
  play: ['fill:M6 3.5v13l10.5-6.5z'],
  pause: ['fill:M5.5 4h3.2v12H5.5zM11.3 4h3.2v12h-3.2z'],
  step: ['fill:M4 4v12l8-6z', 'M15 4v12'],
  reset: ['M4 10a6 6 0 1 0 2-4.5', 'fill:M7.5 1.5v5.5H2z'],
  joints: [
    'M4 16l5-6 6-5',
    'M9 7.5a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5z',
    'M15.5 3a1.7 1.7 0 1 0 0 3.4 1.7 1.7 0 0 0 0-3.4z',
    'M4 14.3a1.7 1.7 0 1 0 0 3.4 1.7 1.7 0 0 0 0-3.4z',
  ],
  topics: [
    'M10 8.2a1.8 1.8 0 1 0 0 3.6 1.8 1.8 0 0 0 0-3.6z',
    'M6.4 6.4a5 5 0 0 0 0 7.2M13.6 6.4a5 5 0 0 1 0 7.2',
    'M3.8 3.8a8.8 8.8 0 0 0 0 12.4M16.2 3.8a8.8 8.8 0 0 1 0 12.4',
  ],
  close: ['M5 5l10 10M15 5 5 15'],
  add: ['M10 4v12M4 10h12'],
  folder: ['M2.5 5h5l1.5 2h8.5v9.5h-15z'],
  file: ['M5 2.5h6.5L15 6v11.5H5z', 'M11.5 2.5V6H15'],
  up: ['M10 16V4M5 9l5-5 5 5'],
  car: ['M3 12V8.5h2.5L7.5 5h6l2 3.5H17V12z', 'M6.5 11a2 2 0 1 0 0 4 2 2 0 0 0 0-4zM13.5 11a2 2 0 1 0 0 4 2 2 0 0 0 0-4z'],
  frames: ['M5 15V4M5 15h11M5 15l6-6'],
  model: ['M10 2.5 17 6v8l-7 3.5L3 14V6z', 'M3 6l7 3.5L17 6M10 9.5v8'],
  link: ['M4 7h12v6H4z'],
  joint: ['M10 6a4 4 0 1 0 0 8 4 4 0 0 0 0-8z', 'M10 1.5V6M10 14v4.5'],
  plugin: ['M7 2.5v4M13 2.5v4M5 6.5h10V10a5 5 0 0 1-10 0zM10 15v3'],
  light: ['M7.5 13.5C5 11 5 9.8 5 8a5 5 0 0 1 10 0c0 1.8 0 3-2.5 5.5z', 'M7.5 16h5M8.5 18h3'],
  world: [
    'M10 2.5a7.5 7.5 0 1 0 0 15 7.5 7.5 0 0 0 0-15z',
    'M2.5 10h15M10 2.5c-4.5 4-4.5 11 0 15M10 2.5c4.5 4 4.5 11 0 15',
  ],
  physics: [
    'M10 9a1 1 0 1 0 0 2 1 1 0 0 0 0-2z',
    'M2.5 10c0-4 15-4 15 0s-15 4-15 0z',
    'M6.2 3.5c3.5-2 11 11 7.5 13s-11-11-7.5-13z',
  ],
  scene: ['M2.5 4.5h15v11h-15z', 'M2.5 13l4-4 4 4 3-2.5 4 3'],
  wind: ['M2.5 8h9a2.5 2.5 0 1 0-2.5-2.5M2.5 11.5h12a2.5 2.5 0 1 1-2.5 2.5'],
  atmosphere: ['M5.5 15.5a3.5 3.5 0 0 1 0-7 5 5 0 0 1 9.5-.5 3.8 3.8 0 0 1-.5 7.5z'],
  globe: ['M10 2.5a7.5 7.5 0 1 0 0 15 7.5 7.5 0 0 0 0-15z', 'M2.5 10h15M10 2.5v15'],
  gui: ['M2.5 3.5h15v10h-15z', 'M7 17h6M10 13.5V17'],
  grid: ['M3 3h14v14H3zM3 7.7h14M3 12.3h14M7.7 3v14M12.3 3v14'],
  geometry: ['M3 9h8v8H3z', 'M12.5 2.5a4.5 4.5 0 1 0 .1 0z'],
  theme: ['M10 3a7 7 0 1 0 0 14 7 7 0 0 0 0-14z', 'fill:M10 3a7 7 0 0 1 0 14z'],
  trash: ['M4 5.5h12M8 5.5V3h4v2.5M5.5 5.5l.8 12h7.4l.8-12M8.5 8.5v6M11.5 8.5v6'],
  warning: ['M10 3 18 17H2z', 'M10 8v4.5M10 14.3v.7'],
  error: ['M10 2.5a7.5 7.5 0 1 0 0 15 7.5 7.5 0 0 0 0-15z', 'M10 6v5M10 13.3v.7'],
  info: ['M10 2.5a7.5 7.5 0 1 0 0 15 7.5 7.5 0 0 0 0-15z', 'M10 9v5M10 6.3v.7'],
  check: ['M4 10.5l4 4 8-9'],
  messages: ['M3 4h14v9.5H9L5.5 17v-3.5H3z'],
  export: ['M10 12V3M6.5 6 10 2.5 13.5 6', 'M4 10v7h12v-7'],
  building: ['M3 17V8l7-5 7 5v9z', 'M8 17v-5h4v5'],
};

/**
 * @param name  one of `SHAPES`
 * @param size  in px
 */
export function icon(name: string, size = 18) {
  const shapes = SHAPES[name];
  if (!shapes) throw new Error(`no icon ${name}`);
  return svg('svg', {viewBox: '0 0 20 20', width: size, height: size, fill: 'none', stroke: 'currentColor', 'stroke-width': 1.4,
    'stroke-linecap': 'round', 'stroke-linejoin': 'round', 'aria-hidden': 'true', class: 'icon'},
  ...shapes.map((shape) => (shape.startsWith('fill:')
    ? svg('path', {d: shape.slice(5), fill: 'currentColor', stroke: 'none'}) : svg('path', {d: shape}))));
}

/**
 * A button with an icon.
 * @param title  may end in the keys that do the same, in parentheses
 * @param size  of the icon, px
 */
export const iconButton = (glyph: string, title: string, run: (event: Event) => unknown, size = 18, more: Record<string, unknown> = {}) =>
  h('button', {title, 'aria-label': title.replace(/ \(.*\)$/, ''), onclick: run, ...more}, icon(glyph, size));

/** A button with a cross; `size`: of the cross, px. */
export const closeButton = (title: string, run: (event: Event) => unknown, size = 12) =>
  iconButton('close', title, run, size, {class: 'plain'});
