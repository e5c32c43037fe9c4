/**
 * What opens over the page and closes again: menus, drop-downs. One is open at a time.
 *
 * @typedef {Object} MenuItem
 * @property {string} [title]
 * @property {string} [keys]       the hotkey shown beside it
 * @property {() => void} [run]
 * @property {() => boolean} [checked]   makes it a check item
 * @property {() => boolean} [enabled]
 * @property {MenuItem[]} [items]  a submenu
 * @property {boolean} [separator]
 */
import {fill, h, roving} from './dom.js';
import {icon} from './icons.js';

let closeOpen = null;

/** Closes what is open, if anything. */
export function closePopup() {
  closeOpen?.();
}

/**
 * Opens an element beside an anchor, or at a point.
 *
 * @param {HTMLElement} content
 * @param {{anchor?: HTMLElement, x?: number, y?: number, onClose?: () => void,
 *   keepFocus?: boolean}} options
 * @returns {() => void} closes it
 */
export function openPopup(content, {anchor, x, y, onClose, keepFocus = false}) {
  closePopup();
  const before = document.activeElement;
  const popup = h('div', {class: 'popup'}, content);
  document.body.append(popup);
  place(popup, anchor ? anchor.getBoundingClientRect() : {left: x, bottom: y, top: y});
  const outside = (event) => {
    if (!popup.contains(event.target) && !anchor?.contains(event.target)) close();
  };
  const key = (event) => {
    // In menus Tab leaves; panels with fields are walked through with it.
    const leaves = event.key === 'Tab' && popup.querySelector('[role=menu]');
    if (event.key !== 'Escape' && !leaves) return;
    if (event.key === 'Escape') event.preventDefault();
    event.stopPropagation();
    close();
  };
  const close = () => {
    if (closeOpen !== close) return;
    closeOpen = null;
    const hadFocus =
      popup.contains(document.activeElement) || document.activeElement === document.body;
    popup.remove();
    document.removeEventListener('pointerdown', outside, true);
    document.removeEventListener('keydown', key, true);
    window.removeEventListener('blur', close);
    if (hadFocus && !keepFocus) (anchor ?? before)?.focus?.();
    onClose?.();
  };
  closeOpen = close;
  document.addEventListener('pointerdown', outside, true);
  document.addEventListener('keydown', key, true);
  window.addEventListener('blur', close);
  popup.addEventListener('contextmenu', (event) => event.preventDefault());
  return close;
}

function place(popup, box) {
  const {width, height} = popup.getBoundingClientRect();
  const left = Math.max(4, Math.min(box.left, window.innerWidth - width - 4));
  const below = box.bottom + height <= window.innerHeight - 4;
  const top = below ? box.bottom : Math.max(4, box.top - height);
  popup.style.left = `${left}px`;
  popup.style.top = `${top}px`;
  popup.style.maxHeight = `${window.innerHeight - top - 8}px`;
}

/**
 * The list of a menu; submenus open in line, below their heading.
 *
 * @param {MenuItem[]} items
 * @param {() => void} close
 * @param {string} label
 * @returns {HTMLElement}
 */
export function menuList(items, close, label) {
  const list = h('div', {class: 'menu', role: 'menu', 'aria-label': label});
  fill(list, ...items.flatMap((item) => menuItem(item, close)));
  roving(list, '[role^="menuitem"]', {vertical: true});
  list.addEventListener('pointermove', (event) => {
    const item = event.target.closest('[role^="menuitem"]');
    if (item && !item.disabled && document.activeElement !== item) item.focus();
  });
  return list;
}

function menuItem(item, close) {
  if (item.separator) return [h('div', {class: 'menu-line', role: 'separator'})];
  if (item.items) {
    const inner = item.items.flatMap((one) => menuItem(one, close));
    for (const element of inner) element.classList.add('inner');
    return [h('div', {class: 'menu-heading', text: item.title}), ...inner];
  }
  const check = item.checked !== undefined;
  const on = check && item.checked();
  return [
    h(
      'button',
      {
        type: 'button',
        class: 'menu-item',
        role: check ? 'menuitemcheckbox' : 'menuitem',
        'aria-checked': check ? String(on) : null,
        disabled: item.enabled ? !item.enabled() : false,
        onclick: () => {
          close();
          item.run();
        },
      },
      h('span', {class: 'menu-check'}, on && icon('check', 14)),
      h('span', {class: 'menu-title', text: item.title}),
      item.keys && h('kbd', {text: item.keys}),
    ),
  ];
}

/** Opens a menu at a point or anchor and puts the focus on its first item. */
export function openMenu(items, options) {
  let close = () => {};
  const list = menuList(items, () => close(), options.label);
  close = openPopup(list, options);
  list.querySelector('[role^="menuitem"]:not(:disabled)')?.focus();
  return close;
}
