/** The menu bar: arrow keys walk along it, an open menu follows the mouse. */
import {elementsOf, fill, h, roving} from './dom.js';
import {closePopup, menuList, openPopup} from './popup.js';
import type {MenuItem} from './popup.js';

/** `edits`: hidden in a page that cannot edit the world. */
export type Menu = {title: string, edits?: boolean, items: () => MenuItem[]};

export function mountMenuBar(element: HTMLElement, menus: Menu[]) {
  let open: number|null = null;
  const buttons = menus.map((menu) =>
    h('button', {
      class: `menu-title ${menu.edits ? 'edits' : ''}`,
      role: 'menuitem',
      'aria-haspopup': 'menu',
      'aria-expanded': 'false',
      text: menu.title,
    }),
  );
  const show = (at: number) => {
    const button = buttons[at];
    const list = menuList(menus[at].items(), closePopup, menus[at].title);
    openPopup(
      list,
      {
        anchor: button,
        onClose: () => {
          button.setAttribute('aria-expanded', 'false');
          if (open === at) open = null;
        },
      },
    );
    open = at;
    button.setAttribute('aria-expanded', 'true');
    elementsOf(list, '[role^="menuitem"]:not(:disabled)')[0]?.focus();
    list.addEventListener('keydown', (event) => {
      const step = event.key === 'ArrowLeft' ? -1 : event.key === 'ArrowRight' ? 1 : 0;
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      const shown = buttons.filter((button) => button.offsetParent !== null);
      const next = (shown.indexOf(buttons[at]) + step + shown.length) % shown.length;
      show(buttons.indexOf(shown[next]));
    });
  };
  buttons.forEach((button, at) => {
    let wasOpen = false;
    // Menus open on the press, as everywhere; the keyboard clicks without one.
    button.addEventListener('pointerdown', (event) => {
      wasOpen = open === at;
      if (!wasOpen && event.button === 0 && event.pointerType === 'mouse') show(at);
    });
    // Else the button would take the focus from the menu's first item.
    button.addEventListener('mousedown', (event) => event.preventDefault());
    button.addEventListener('click', (event) => {
      if (wasOpen && event.detail) {
        wasOpen = false;
        closePopup();
        return;
      }
      if (open !== at) show(at);
    });
    button.addEventListener('pointerenter', () => {
      if (open !== null && open !== at) show(at);
    });
    button.addEventListener('keydown', (event) => {
      if (event.key === 'ArrowDown') {
        event.preventDefault();
        show(at);
      }
    });
  });
  element.setAttribute('role', 'menubar');
  fill(element, ...buttons);
  roving(element, '.menu-title');
}
