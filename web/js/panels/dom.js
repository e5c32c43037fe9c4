/**
 * Making elements, and moving the focus among them with the arrow keys.
 */

/**
 * An element. Attributes are set by name; `on…` functions become listeners, `class`, `text`,
 * `dataset` and boolean attributes do what one expects; null and false leave an attribute out.
 *
 * @param {string} tag
 * @param {Object<string, any>} [attributes]
 * @param {...(Node|string|null|undefined|false)} children
 * @returns {HTMLElement}
 */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (name === 'text') element.textContent = value;
    else if (name === 'dataset') Object.assign(element.dataset, value);
    else if (name in PROPERTIES) element[name] = value;
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(
    ...children.filter((child) => child !== null && child !== undefined && child !== false),
  );
  return element;
}

const PROPERTIES = {checked: 1, value: 1, indeterminate: 1, disabled: 1, readOnly: 1};

/** Replaces the children of an element. */
export function fill(element, ...children) {
  element.replaceChildren(...children.filter(Boolean));
  return element;
}

/**
 * Roving focus: one of the matching elements takes part in the tab order, the arrow keys, Home and
 * End move it on. Hidden and disabled ones are passed over.
 *
 * @param {HTMLElement} container
 * @param {string} selector
 * @param {{vertical?: boolean, wrap?: boolean}} [options]
 */
export function roving(container, selector, {vertical = false, wrap = true} = {}) {
  const [back, forth] = vertical ? ['ArrowUp', 'ArrowDown'] : ['ArrowLeft', 'ArrowRight'];
  const items = () =>
    [...container.querySelectorAll(selector)].filter(
      (item) => !item.disabled && item.offsetParent !== null,
    );
  const settle = (chosen) => {
    for (const item of container.querySelectorAll(selector)) item.tabIndex = -1;
    if (chosen) chosen.tabIndex = 0;
  };
  container.addEventListener('focusin', (event) => {
    const item = event.target.closest(selector);
    if (item) settle(item);
  });
  container.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const item = event.target.closest(selector);
    if (!item || usesArrows(event.target)) return;
    const all = items();
    const at = all.indexOf(item);
    const to = {[back]: at - 1, [forth]: at + 1, Home: 0, End: all.length - 1}[event.key];
    if (to === undefined || !all.length) return;
    event.preventDefault();
    event.stopPropagation();
    const within = wrap
      ? (to + all.length) % all.length
      : Math.min(Math.max(to, 0), all.length - 1);
    all[within].focus();
  });
  settle(container.querySelector(selector));
  return {settle: () => settle(items()[0])};
}

/** Whether an element needs the arrow keys, Home and End for itself. */
function usesArrows(element) {
  return isTextInput(element) || element.matches('input[type=range], input[type=radio]');
}

/** Whether key presses in this element are text, and so no hotkeys. */
export function isTextInput(element) {
  if (!(element instanceof HTMLElement)) return false;
  if (element.isContentEditable || element.matches('textarea, select')) return true;
  return (
    element.matches('input') &&
    !['checkbox', 'radio', 'button', 'range', 'color'].includes(element.type)
  );
}

/** A click on the element or Enter and Space on it, for things that are no buttons. */
export function onActivate(element, handler) {
  element.addEventListener('click', handler);
  element.addEventListener('keydown', (event) => {
    if (event.target !== element || (event.key !== 'Enter' && event.key !== ' ')) return;
    event.preventDefault();
    event.stopPropagation();
    handler(event);
  });
}

/**
 * Runs a function at most once a frame, however often it is asked for.
 *
 * @param {() => void} run
 * @returns {() => void}
 */
export function onceAFrame(run) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      run();
    });
  };
}

/** A colour of the theme as the canvas wants it. */
export function themeColor(name) {
  const probe = h('span', {style: `color: var(--${name}); display: none`});
  document.body.append(probe);
  const color = getComputedStyle(probe).color;
  probe.remove();
  return color;
}

/** What is remembered in this browser only: widths, open rows, the theme. */
export const remembered = {
  get(key, fallback) {
    try {
      const text = localStorage.getItem(`world-editor.${key}`);
      return text === null ? fallback : JSON.parse(text);
    } catch {
      // A private window without storage forgets; that is all.
      return fallback;
    }
  },
  set(key, value) {
    try {
      localStorage.setItem(`world-editor.${key}`, JSON.stringify(value));
    } catch {
      // As above.
    }
  },
};
