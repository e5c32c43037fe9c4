/** As much of a document as panels need to be built and typed into in node. */

class Classes extends Set {
  remove(...names) { names.forEach((name) => this.delete(name)); }
  contains(name) { return this.has(name); }
  toggle(name, on = !this.has(name)) { if (on) this.add(name); else this.delete(name); }
}

class PlainElement extends EventTarget {
  children = [];
  classList = new Classes();
  dataset = {};
  style = {};
  value = '';
  textContent = '';
  isConnected = true;

  constructor(tag) {
    super();
    this.tag = tag;
  }

  append(...children) { this.children.push(...children); }
  replaceChildren(...children) { this.children = children; }
  setAttribute() {}
  contains() { return false; }
  closest() { return null; }
  querySelectorAll() { return []; }
  getContext() { return null; }
  focus() {}
  select() {}
  scrollIntoView() {}
}

/** All elements in and below one that a test function holds for. */
export function elementsWhere(element, holds) {
  const below = (element.children ?? []).flatMap((child) => elementsWhere(child, holds));
  return holds(element) ? [element, ...below] : below;
}

/** Types a text into an input and confirms it. */
export function typeInto(input, text) {
  input.value = text;
  input.dispatchEvent(new Event('input'));
  input.dispatchEvent(Object.assign(new Event('keydown'), {key: 'Enter'}));
}

/** Makes the document a global one; what it returns makes elements. */
export function installPlainDom() {
  const make = (tag) => new PlainElement(tag);
  Object.assign(globalThis, {
    HTMLElement: PlainElement, Element: PlainElement, HTMLInputElement: PlainElement,
    requestAnimationFrame: (run) => setTimeout(run, 0),
    document: {createElement: make, createElementNS: (_, tag) => make(tag),
      getElementById: () => make('div'), body: make('body'), activeElement: null},
  });
  return make;
}
