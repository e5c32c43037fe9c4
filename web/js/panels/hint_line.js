/** One line over the view that tells a newcomer how to look round, until it is closed. */
import {h, remembered} from './dom.js';
import {icon} from './icons.js';

/** @type {[string, string][]} */
const HINTS = [
  ['drag', 'pan'], ['Shift+drag', 'turn'], ['wheel', 'zoom'], ['click', 'select'], ['T R S', 'move, rotate, scale'],
  ['Space', 'play'], ['F1', 'all keys'],
];

/** @type {[string, string][]} */
const TOUCH_HINTS = [
  ['one finger', 'turn'], ['two', 'pan, zoom'], ['tap', 'select'], ['hold', 'menu'],
];

/** @param {HTMLElement} element  what the line lies in */
export function mountHints(element) {
  if (remembered.get('hints-closed', false)) return;
  const hints = matchMedia('(pointer: coarse)').matches ? TOUCH_HINTS : HINTS;
  const line = h('div', {class: 'hint-line', role: 'note', 'aria-label': 'Hints'},
    h('div', {class: 'hints'},
      ...hints.map(([keys, what]) => h('span', {}, h('kbd', {text: keys}), ` ${what}`))),
    h('button', {type: 'button', class: 'plain', 'aria-label': 'Close the hints', title: 'Close the hints',
      onclick: () => {
        remembered.set('hints-closed', true);
        line.remove();
      }}, icon('close')));
  element.append(line);
}
