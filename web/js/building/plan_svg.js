/**
 * SVG elements, and the path data of what a plan holds, in pixels of the sheet: 100 a metre, y
 * down.
 */
import {fromLocal} from './plane_geometry.js';
import {placeOf, wallLength, wallYaw} from './plan.js';
/** @import {Floor, Level, Opening, Stairs} from '../protocol.js' */
/** @import {Point} from './plane_geometry.js' */

/** @typedef {Record<string, string|number|boolean|null|undefined>} Attributes */

export const SCALE = 100;
const SVG = 'http://www.w3.org/2000/svg';

/**
 * @param {string} tag
 * @param {...Node|string} children
 * @returns {SVGElement}
 */
export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, tag);
  set(element, attributes);
  element.append(...children);
  return element;
}

/**
 * Sets attributes; null takes one away, `text` is the content.
 * @param {Element} element
 * @param {Attributes} attributes
 */
export function set(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name === 'text') element.textContent = String(value);
    else if (value === null || value === undefined || value === false) element.removeAttribute(name);
    else element.setAttribute(name, String(value));
  }
  return element;
}

/** @param {number} value */
const round = (value) => Math.round(value * 1000) / 1000;

/** A point of the plan on the sheet. @param {Point} point */
export const onSheet = ([x, y]) => [round(x * SCALE), round(-y * SCALE)];

/** @param {Point[]} points */
export const pathOf = (points, closed = true) =>
  points.map((point, at) => `${at ? 'L' : 'M'}${onSheet(point).join(' ')}`).join('') + (closed ? 'Z' : '');

/**
 * The footprint of a wall as it is built: longer than its middle line by its thickness.
 * @param {{start: Point, end: Point, thickness: number}} wall
 */
export function wallPath(wall) {
  const [length, half, yaw] = [wallLength(wall), wall.thickness / 2, wallYaw(wall)];
  return pathOf([[-half, -half], [length + half, -half], [length + half, half], [-half, half]]
    .map((point) => fromLocal(point, wall.start, yaw)));
}

/**
 * The parts of an opening's sign: the gap, and the lines in it.
 * @param {string} kind
 * @param {Opening} opening
 * @param {Level} level
 */
export function openingPaths(kind, opening, level) {
  const {point, yaw, wall} = placeOf(opening, level);
  const [half, deep] = [opening.width / 2, (wall?.thickness ?? opening.depth) / 2 + 0.005];
  /** @param {number} x @param {number} y */
  const at = (x, y) => fromLocal([x, y], point, yaw);
  const frame = pathOf([at(-half, -deep), at(half, -deep), at(half, deep), at(-half, deep)]);
  if (kind === 'windows') {
    return {frame, lines: pathOf([at(-half, 0), at(half, 0)], false)};
  }
  const [leafX, leafY] = onSheet(at(-half, opening.width));
  const [endX, endY] = onSheet(at(half, 0));
  const radius = round(opening.width * SCALE);
  return {frame, lines: `${pathOf([at(-half, 0), at(-half, opening.width)], false)}` +
    `M${leafX} ${leafY}A${radius} ${radius} 0 0 1 ${endX} ${endY}`};
}

/**
 * The outline of stairs, their steps, and an arrow that points up.
 * @param {Omit<Stairs, 'id'>} stairs
 */
export function stairsPaths(stairs) {
  /** @param {number} x @param {number} y */
  const at = (x, y) => fromLocal([x, y], stairs.position, stairs.yaw);
  const [x, y] = [stairs.width / 2, stairs.depth / 2];
  const steps = [];
  for (let step = 1; step < stairs.steps; step++) {
    const v = -y + stairs.depth * step / stairs.steps;
    steps.push(pathOf([at(-x, v), at(x, v)], false));
  }
  const head = Math.min(x, y) * 0.5;
  return {
    frame: pathOf([at(-x, -y), at(x, -y), at(x, y), at(-x, y)]),
    lines: steps.join(''),
    arrow: pathOf([at(0, -y * 0.8), at(0, y * 0.8)], false) +
      pathOf([at(-head, y * 0.8 - head), at(0, y * 0.8), at(head, y * 0.8 - head)], false),
  };
}

/** @param {Floor} floor */
export const floorPath = (floor) => [floor.outline, ...floor.holes].map((loop) => pathOf(loop)).join('');
