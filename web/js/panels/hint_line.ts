/** One line over the view that names the keys and the mouse of the tool in use, until it is closed. */
import {fill, h, remembered} from '../ui/dom.js';
import {closeButton} from '../ui/icons.js';
import {modelOfSelection} from '../selected_model.js';
import type {Model} from '../protocol.js';
import type {Mode, Store} from '../store.js';

/** keys, and what they do */
type Hints = [string, string][];

const LOOKING: Hints = [
  ['drag', 'pan'], ['Shift+drag', 'turn'], ['wheel', 'zoom'], ['click', 'select'], ['T R S', 'move, rotate, scale'],
  ['Space', 'play'], ['Ctrl+B', 'draw a building'], ['Ctrl+K', 'commands'], ['F1', 'keys'],
];

const TOUCH: Hints = [
  ['one finger', 'turn'], ['two', 'pan, zoom'], ['tap', 'select'], ['hold', 'menu'],
];

const BY_MODE: Record<Mode, Hints> = {
  select: LOOKING,
  translate: [['drag a handle or the model', 'move'], ['X Y Z', 'along one axis'], ['Ctrl', 'snap to 1 m'],
    ['Shift', 'world axes'], ['Esc', 'end']],
  rotate: [['drag a ring', 'rotate'], ['X Y Z', 'about one axis'], ['Ctrl', 'snap to 45°'], ['Shift', 'world axes'],
    ['Esc', 'end']],
  scale: [['drag a handle', 'scale'], ['X Y Z', 'one axis'], ['Shift', 'all axes'], ['Ctrl', 'snap to 1 m'], ['Esc', 'end']],
  snap: [['click a face', 'that moves'], ['click a second face', 'where it goes'], ['Esc', 'end']],
  measure: [['click two points', 'distance'], ['click a third', 'angle'], ['Esc', 'end']],
  insert: [['click', 'place'], ['Enter', 'place'], ['Q E', 'turn by 15°'], ['Shift+Q E', 'by 90°'], ['Ctrl', 'snap to 1 m'],
    ['Esc', 'cancel']],
  connect: [['click a link', 'parent'], ['click another link', 'child'], ['Esc', 'cancel']],
};

/** Names of plugin libraries that listen to velocity commands. */
const DRIVES = /drive|planar_move/;

/** What is said first while a robot is selected that the arrow keys drive. Pure. */
export function driveHints(model: Pick<Model, 'name'|'plugins'>|undefined, paused: boolean): Hints {
  if (!model?.plugins.some(({filename}) => DRIVES.test(filename))) return [];
  return paused
    ? [['Space', 'play, then'], ['↑ ↓ ← →', `drive ${model.name}`]]
    : [['↑ ↓ ← →', `drive ${model.name}`], ['Shift', 'faster']];
}

/** Those of a mode after those of a robot, each key once. Pure. */
export const hintsOf = (mode: Mode, first: Hints, paused: boolean): Hints => [...first,
  ...BY_MODE[mode].filter(([keys]) => !first.some(([known]) => known === keys))
    .map(([keys, what]): [string, string] => [keys, keys === 'Space' && !paused ? 'pause' : what])];

/** @param element  what the line lies in */
export function mountHints(element: HTMLElement, store: Store) {
  if (remembered.get('hints-closed', false)) return;
  const touch = matchMedia('(pointer: coarse)').matches;
  const hints = h('div', {class: 'hints'});
  const line = h('div', {class: 'hint-line', role: 'note', 'aria-label': 'Hints'}, hints,
    closeButton('Close the hints', () => {
      remembered.set('hints-closed', true);
      line.remove();
    }, 18));
  let shown = '';
  const show = () => {
    const {paused} = store.stats;
    const rows = touch && store.mode === 'select' ? TOUCH
      : hintsOf(store.mode, store.mode === 'select' ? driveHints(modelOfSelection(store), paused) : [], paused);
    const text = rows.flat().join('\n');
    if (text === shown) return;
    shown = text;
    fill(hints, ...rows.map(([keys, what]) => h('span', {}, h('kbd', {text: keys}), ` ${what}`)));
  };
  for (const event of ['mode', 'selection', 'stats', 'entity'] as const) store.listen(event, show);
  show();
  element.append(line);
}
