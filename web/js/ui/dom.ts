/**
 * Making elements, and moving the focus among them with the arrow keys.
 */

/** What may stand in an element; null and false stand for nothing. */
export type Child = Node|string|number|null|undefined|false;

/** Attributes of an element by name; `on…` are listeners. */
type Attributes = {[K in keyof HTMLElementEventMap as `on${K}`]?: ((event: HTMLElementEventMap[K]) => unknown)|null}
    & Record<string, unknown>;

/** Attributes of elements that are made without them: a button submits no form, names and paths are not checked as words. */
const DEFAULTS: Record<string, Attributes> = {button: {type: 'button'}, textarea: {spellcheck: 'false'},
  input: {type: 'text', spellcheck: 'false', autocomplete: 'off'}};

/**
 * An element. Attributes are set by name; `on…` functions become listeners, `class`, `text`,
 * `dataset` and boolean attributes do what one expects; null and false leave an attribute out.
 */
export function h<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Attributes = {},
    ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries({...DEFAULTS[tag], ...attributes})) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function') {
      element.addEventListener(name.slice(2), value as EventListener);
    } else if (name === 'text') element.textContent = String(value);
    else if (name === 'dataset') Object.assign(element.dataset, value);
    else if (name in PROPERTIES) Object.assign(element, {[name]: value});
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(...nodesOf(children));
  return element;
}

/** A button with a text. */
export const textButton = (text: string, run: (event: Event) => unknown, more: Attributes = {}) =>
  h('button', {text, onclick: run, ...more});

function nodesOf(children: Child[]) {
  return children.flatMap((child) =>
    child === null || child === undefined || child === false ? [] :
      [typeof child === 'number' ? String(child) : child],
  );
}

const PROPERTIES = {checked: 1, value: 1, indeterminate: 1, disabled: 1, readOnly: 1};

/** Replaces the children of an element. */
export function fill<T extends Element>(element: T, ...children: Child[]) {
  element.replaceChildren(...nodesOf(children));
  return element;
}

/**
 * Roving focus: one of the matching elements takes part in the tab order, the arrow keys move it on, in
 * lists Home and End, too. Bars leave these to the view. Hidden and disabled ones are passed over.
 */
export function roving(container: HTMLElement, selector: string, {vertical = false,
    wrap = true}: {vertical?: boolean, wrap?: boolean} = {}) {
  const [back, forth] = vertical ? ['ArrowUp', 'ArrowDown'] : ['ArrowLeft', 'ArrowRight'];
  const items = () =>
    elementsOf(container, selector).filter(
      (item) => !('disabled' in item && item.disabled) && item.offsetParent !== null,
    );
  const settle = (chosen: HTMLElement|undefined) => {
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
    const steps: Record<string, number> = {[back]: at - 1, [forth]: at + 1};
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

/** The elements below another one that match a selector. */
export function elementsOf(container: ParentNode, selector: string): HTMLElement[] {
  return [...container.querySelectorAll(selector)].filter((one) => one instanceof HTMLElement);
}

/** The element with an id; the page has all that are asked for. */
export function byId(id: string): HTMLElement {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element #${id}`);
  return element;
}

/** What an event happened in that matches a selector; null for nothing. */
export function closestTo(event: Event, selector: string): HTMLElement|null {
  const found = event.target instanceof Element ? event.target.closest(selector) : null;
  return found instanceof HTMLElement ? found : null;
}

/** Calls a function for each movement of a pressed pointer, until it is released. */
export function followPointer(element: HTMLElement, {pointerId}: PointerEvent, move: (event: PointerEvent) => void) {
  element.setPointerCapture(pointerId);
  element.addEventListener('pointermove', move);
  element.addEventListener('lostpointercapture', () => element.removeEventListener('pointermove', move), {once: true});
}

/** Whether an element needs the arrow keys, Home and End for itself. */
function usesArrows(element: unknown) {
  return isTextInput(element) ||
    (element instanceof Element && element.matches('input[type=range], input[type=radio]'));
}

/** Whether key presses in this element are text, and so no hotkeys. */
function isTextInput(element: unknown) {
  if (!(element instanceof HTMLElement)) return false;
  if (element.isContentEditable || element.matches('textarea, select')) return true;
  return (
    element instanceof HTMLInputElement &&
    !['checkbox', 'radio', 'button', 'range', 'color'].includes(element.type)
  );
}

/** A click on the element or Enter and Space on it, for things that are no buttons. */
export function onActivate(element: HTMLElement|SVGElement, handler: (event: Event) => void) {
  element.addEventListener('click', handler);
  element.addEventListener('keydown', (event: Event) => {
    if (!(event instanceof KeyboardEvent) || event.target !== element || (event.key !== 'Enter' && event.key !== ' ')) return;
    event.preventDefault();
    event.stopPropagation();
    handler(event);
  });
}

/** Runs a function at most once a frame, however often it is asked for. */
export function onceAFrame(run: () => void): () => void {
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
export function themeColor(name: string) {
  const probe = h('span', {style: `color: var(--${name}); display: none`});
  document.body.append(probe);
  const color = getComputedStyle(probe).color;
  probe.remove();
  return color;
}

/** @param storage  of the browser, or of one tab */
const memoryIn = (storage: () => Storage) => ({
  /** What was stored under a key, or the fallback. */
  get<T>(key: string, fallback: T): T {
    try {
      const text = storage().getItem(`world-editor.${key}`);
      return text === null ? fallback : JSON.parse(text);
    } catch {
      // A private window without storage forgets; that is all.
      return fallback;
    }
  },
  set(key: string, value: unknown) {
    try {
      storage().setItem(`world-editor.${key}`, JSON.stringify(value));
    } catch {
      // As above.
    }
  },
});

/** What is remembered in this browser only: widths, open rows, the theme. */
export const remembered = memoryIn(() => localStorage);

/** What a tab remembers until it is closed, also if its page is loaded again. */
export const rememberedInTab = memoryIn(() => sessionStorage);
