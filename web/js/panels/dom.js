/**
 * Making elements, and moving the focus among them with the arrow keys.
 */

/**
 * What may stand in an element; null and false stand for nothing.
 * @typedef {Node|string|number|null|undefined|false} Child
 */

/**
 * Attributes of an element by name; `on…` are listeners.
 * @typedef {{[K in keyof HTMLElementEventMap as `on${K}`]?: ((event: HTMLElementEventMap[K]) => unknown)|null}
 *   & Record<string, unknown>} Attributes
 */

/**
 * An element. Attributes are set by name; `on…` functions become listeners, `class`, `text`,
 * `dataset` and boolean attributes do what one expects; null and false leave an attribute out.
 *
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Attributes} [attributes]
 * @param {...Child} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function') {
      element.addEventListener(name.slice(2), /** @type {EventListener} */ (value));
    } else if (name === 'text') element.textContent = String(value);
    else if (name === 'dataset') Object.assign(element.dataset, value);
    else if (name in PROPERTIES) Object.assign(element, {[name]: value});
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(...nodesOf(children));
  return element;
}

/** @param {Child[]} children */
function nodesOf(children) {
  return children.flatMap((child) =>
    child === null || child === undefined || child === false ? [] :
      [typeof child === 'number' ? String(child) : child],
  );
}

const PROPERTIES = {checked: 1, value: 1, indeterminate: 1, disabled: 1, readOnly: 1};

/**
 * Replaces the children of an element.
 * @template {Element} T
 * @param {T} element
 * @param {...Child} children
 */
export function fill(element, ...children) {
  element.replaceChildren(...nodesOf(children));
  return element;
}

/**
 * Roving focus: one of the matching elements takes part in the tab order, the arrow keys move it on, in
 * lists Home and End, too. Bars leave these to the view. Hidden and disabled ones are passed over.
 *
 * @param {HTMLElement} container
 * @param {string} selector
 * @param {{vertical?: boolean, wrap?: boolean}} [options]
 */
export function roving(container, selector, {vertical = false, wrap = true} = {}) {
  const [back, forth] = vertical ? ['ArrowUp', 'ArrowDown'] : ['ArrowLeft', 'ArrowRight'];
  const items = () =>
    elementsOf(container, selector).filter(
      (item) => !('disabled' in item && item.disabled) && item.offsetParent !== null,
    );
  /** @param {HTMLElement|undefined} chosen */
  const settle = (chosen) => {
    for (const item of elementsOf(container, selector)) item.tabIndex = -1;
    if (chosen) chosen.tabIndex = 0;
  };
  container.addEventListener('focusin', (event) => {
    const item = closestTo(event, selector);
    if (item) settle(item);
  });
  container.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const item = closestTo(event, selector);
    if (!item || usesArrows(event.target)) return;
    const all = items();
    const at = all.indexOf(item);
    /** @type {Record<string, number>} */
    const steps = {[back]: at - 1, [forth]: at + 1};
    if (vertical) Object.assign(steps, {Home: 0, End: all.length - 1});
    const to = steps[event.key];
    if (to === undefined || !all.length) return;
    event.preventDefault();
    event.stopPropagation();
    const within = wrap
      ? (to + all.length) % all.length
      : Math.min(Math.max(to, 0), all.length - 1);
    all[within].focus();
  });
  settle(elementsOf(container, selector)[0]);
  return {settle: () => settle(items()[0])};
}

/**
 * The elements below another one that match a selector.
 * @param {ParentNode} container
 * @param {string} selector
 * @returns {HTMLElement[]}
 */
export function elementsOf(container, selector) {
  return [...container.querySelectorAll(selector)].filter((one) => one instanceof HTMLElement);
}

/**
 * The element with an id; the page has all that are asked for.
 * @param {string} id
 * @returns {HTMLElement}
 */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element #${id}`);
  return element;
}

/**
 * What an event happened in that matches a selector; null for nothing.
 * @param {Event} event
 * @param {string} selector
 * @returns {HTMLElement|null}
 */
export function closestTo(event, selector) {
  const found = event.target instanceof Element ? event.target.closest(selector) : null;
  return found instanceof HTMLElement ? found : null;
}

/** Whether an element needs the arrow keys, Home and End for itself. @param {unknown} element */
function usesArrows(element) {
  return isTextInput(element) ||
    (element instanceof Element && element.matches('input[type=range], input[type=radio]'));
}

/** Whether key presses in this element are text, and so no hotkeys. @param {unknown} element */
export function isTextInput(element) {
  if (!(element instanceof HTMLElement)) return false;
  if (element.isContentEditable || element.matches('textarea, select')) return true;
  return (
    element instanceof HTMLInputElement &&
    !['checkbox', 'radio', 'button', 'range', 'color'].includes(element.type)
  );
}

/**
 * A click on the element or Enter and Space on it, for things that are no buttons.
 * @param {HTMLElement|SVGElement} element
 * @param {(event: Event) => void} handler
 */
export function onActivate(element, handler) {
  element.addEventListener('click', handler);
  element.addEventListener('keydown', (/** @type {Event} */ event) => {
    if (!(event instanceof KeyboardEvent) || event.target !== element || (event.key !== 'Enter' && event.key !== ' ')) return;
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

/** A colour of the theme as the canvas wants it. @param {string} name */
export function themeColor(name) {
  const probe = h('span', {style: `color: var(--${name}); display: none`});
  document.body.append(probe);
  const color = getComputedStyle(probe).color;
  probe.remove();
  return color;
}

/** What is remembered in this browser only: widths, open rows, the theme. */
export const remembered = {
  /**
   * What was stored under a key, or the fallback.
   * @template T
   * @param {string} key
   * @param {T} fallback
   * @returns {T}
   */
  get(key, fallback) {
    try {
      const text = localStorage.getItem(`world-editor.${key}`);
      return text === null ? fallback : JSON.parse(text);
    } catch {
      // A private window without storage forgets; that is all.
      return fallback;
    }
  },
  /** @param {string} key @param {unknown} value */
  set(key, value) {
    try {
      localStorage.setItem(`world-editor.${key}`, JSON.stringify(value));
    } catch {
      // As above.
    }
  },
};
