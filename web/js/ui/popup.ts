/** What opens over the page and closes again: menus, drop-downs. One is open at a time. */
import {closestTo, elementsOf, fill, h, roving} from './dom.js';
import {icon} from './icons.js';

export interface MenuItem {
  title?: string;
  /** the hotkey shown beside it */
  keys?: string;
  run?: () => void;
  /** makes it a check item */
  checked?: () => boolean;
  enabled?: () => boolean;
  /** a submenu */
  items?: MenuItem[];
  separator?: boolean;
}
/** where it opens: beside an anchor, or at a point (px) */
interface PopupOptions {
  anchor?: HTMLElement;
  x?: number;
  y?: number;
  onClose?: () => void;
  keepFocus?: boolean;
}

let closeOpen: (() => void)|null = null;

/** Closes what is open, if anything. */
export function closePopup() {
  closeOpen?.();
}

/**
 * Opens an element beside an anchor, or at a point.
 * @returns closes it
 */
export function openPopup(content: HTMLElement, {anchor, x = 0, y = 0, onClose,
    keepFocus = false}: PopupOptions): () => void {
  closePopup();
  const before = document.activeElement;
  const opened = new AbortController();
  const popup = h('div', {class: 'popup'}, content);
  document.body.append(popup);
  place(popup, anchor ? anchor.getBoundingClientRect() : {left: x, bottom: y, top: y});
  const outside = (event: Event) => {
    const at = event.target instanceof Node ? event.target : null;
    if (!popup.contains(at) && !anchor?.contains(at)) close();
  };
  const key = (event: KeyboardEvent) => {
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
    opened.abort();
    const focused = anchor ?? before;
    if (hadFocus && !keepFocus && focused instanceof HTMLElement) focused.focus();
    onClose?.();
  };
  closeOpen = close;
  const {signal} = opened;
  document.addEventListener('pointerdown', outside, {capture: true, signal});
  document.addEventListener('keydown', key, {capture: true, signal});
  window.addEventListener('blur', close, {signal});
  popup.addEventListener('contextmenu', (event) => event.preventDefault());
  return close;
}

function place(popup: HTMLElement, box: {left: number, top: number, bottom: number}) {
  const {width, height} = popup.getBoundingClientRect();
  const left = Math.max(4, Math.min(box.left, window.innerWidth - width - 4));
  const below = box.bottom + height <= window.innerHeight - 4;
  const top = below ? box.bottom : Math.max(4, box.top - height);
  popup.style.left = `${left}px`;
  popup.style.top = `${top}px`;
  popup.style.maxHeight = `${window.innerHeight - top - 8}px`;
}

/** The list of a menu; submenus open in line, below their heading. */
export function menuList(items: MenuItem[], close: () => void, label: string): HTMLElement {
  const list = h('div', {class: 'menu', role: 'menu', 'aria-label': label});
  fill(list, ...items.flatMap((item) => menuItem(item, close)));
  roving(list, '[role^="menuitem"]', {vertical: true});
  list.addEventListener('pointermove', (event) => {
    const item = closestTo(event, '[role^="menuitem"]:not(:disabled)');
    if (item && document.activeElement !== item) item.focus();
  });
  return list;
}

function menuItem(item: MenuItem, close: () => void): HTMLElement[] {
  if (item.separator) return [h('div', {class: 'menu-line', role: 'separator'})];
  if (item.items) {
    const inner = item.items.flatMap((one) => menuItem(one, close));
    for (const element of inner) element.classList.add('inner');
    return [h('div', {class: 'menu-heading', text: item.title}), ...inner];
  }
  const check = item.checked !== undefined;
  const on = Boolean(item.checked?.());
  return [
    h(
      'button',
      {
        class: 'menu-item',
        role: check ? 'menuitemcheckbox' : 'menuitem',
        'aria-checked': check ? String(on) : null,
        disabled: item.enabled ? !item.enabled() : false,
        onclick: () => {
          close();
          item.run?.();
        },
      },
      h('span', {class: 'menu-check'}, on && icon('check', 14)),
      h('span', {class: 'menu-title', text: item.title}),
      item.keys && h('kbd', {text: item.keys}),
    ),
  ];
}

/** Opens a menu at a point or anchor and puts the focus on its first item. */
export function openMenu(items: MenuItem[], options: PopupOptions & {label: string}) {
  let close = () => {};
  const list = menuList(items, () => close(), options.label);
  close = openPopup(list, options);
  elementsOf(list, '[role^="menuitem"]:not(:disabled)')[0]?.focus();
  return close;
}
