/** Making elements of SVG. */
type Attributes = Record<string, string|number|boolean|null|undefined>;

const SVG = 'http://www.w3.org/2000/svg';

export function svg(tag: string, attributes = {}, ...children: (Node|string)[]): SVGElement {
  const element = document.createElementNS(SVG, tag);
  set(element, attributes);
  element.append(...children);
  return element;
}

/** Sets attributes; null takes one away, `text` is the content. */
export function set(element: Element, attributes: Attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name === 'text') element.textContent = String(value);
    else if (value === null || value === undefined || value === false) element.removeAttribute(name);
    else element.setAttribute(name, String(value));
  }
  return element;
}
