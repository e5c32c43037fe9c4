/**
 * The camera's moves. A view is {position, yaw, pitch}: m and rad, pitch up positive; there is no
 * roll. It looks along its forward vector; the world's z is up.
 */
import {add, axisAngle, cross, dot, length, rotate, scale, subtract} from './pose.js';
/** @import {Pose7, Vec3} from './pose.js' */

/** @typedef {{position: Vec3, yaw: number, pitch: number}} View */

const RADIANS_PER_PIXEL = 0.004;
const LOOK_PER_PIXEL = Math.PI / 1800;
const HORIZONTAL_FOV = Math.PI / 3;
/** Resolution (pixels per meter) of an orthographic view at first. */
export const ORTHOGRAPHIC_ZOOM = 100;
const STEEPEST = Math.PI / 2 - 1e-4;
const NEAREST = 0.05;

/** @param {number} pitch */
const clampPitch = (pitch) => Math.max(-STEEPEST, Math.min(STEEPEST, pitch));

/** @param {{yaw: number, pitch: number}} options */
export const forward = ({yaw, pitch}) => [
  Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch),
];
/** @param {{yaw: number}} options */
export const right = ({yaw}) => [Math.sin(yaw), -Math.cos(yaw), 0];
/** @param {{yaw: number, pitch: number}} view */
export const up = (view) => cross(right(view), forward(view));

/**
 * @param {Vec3} position
 * @param {Vec3} point
 * @returns {View} from a position towards a point
 */
export function lookAt(position, point) {
  const [x, y, z] = subtract(point, position);
  return {position: [...position], yaw: Math.atan2(y, x),
    pitch: clampPitch(Math.atan2(z, Math.hypot(x, y)))};
}

/**
 * The view of a camera pose of a world file: it looks along its x.
 * @param {Pose7} pose
 * @returns {View}
 */
export function fromPose(pose) {
  const ahead = rotate(pose.slice(3), [1, 0, 0]);
  return lookAt(pose.slice(0, 3), add(pose.slice(0, 3), ahead));
}

/** Gazebo's first view. */
export const HOME = Object.freeze(lookAt([5, -5, 2], [0, 0, 0]));

/**
 * Vertical field of view, rad, of a picture `aspect` times as wide as high.
 * @param {number} aspect
 */
export const verticalFov = (aspect) => 2 * Math.atan(Math.tan(HORIZONTAL_FOV / 2) / aspect);

/**
 * Metres that a pixel covers at a point.
 * @param {View} view
 * @param {Vec3} point
 * @param {number} fov
 * @param {number} height of the picture, px
 */
export function metresPerPixel(view, point, fov, height) {
  const depth = Math.max(dot(subtract(point, view.position), forward(view)), NEAREST);
  return 2 * depth * Math.tan(fov / 2) / height;
}

/**
 * Turns the camera about a pivot, which stays where it is in the picture.
 * @param {View} view
 * @param {Vec3} pivot
 * @param {number} dx
 * @param {number} dy
 * @param {'pitch'|'yaw'|null} only
 * @returns {View}
 */
export function orbit(view, pivot, dx, dy, only = null) {
  const turn = only === 'pitch' ? 0 : -dx * RADIANS_PER_PIXEL;
  const wanted = only === 'yaw' ? view.pitch : view.pitch - dy * RADIANS_PER_PIXEL;
  const pitch = clampPitch(wanted);
  const lever = subtract(view.position, pivot);
  const pitched = rotate(axisAngle(right(view), pitch - view.pitch), lever);
  const turned = rotate(axisAngle([0, 0, 1], turn), pitched);
  return {position: add(pivot, turned), yaw: view.yaw + turn, pitch};
}

/**
 * Looks round from where the camera is.
 * @param {View} view
 * @param {number} dx
 * @param {number} dy
 * @returns {View}
 */
export function look(view, dx, dy) {
  return {position: view.position, yaw: view.yaw - dx * LOOK_PER_PIXEL,
    pitch: clampPitch(view.pitch - dy * LOOK_PER_PIXEL)};
}

/**
 * Shifts the camera so that a point keeps under the mouse.
 * @param {View} view
 * @param {number} dx
 * @param {number} dy
 * @param {number} unit  metres per pixel at that point
 * @param {'x'|'y'|'z'|null} axis  only along this world axis
 * @returns {View}
 */
export function pan(view, dx, dy, unit, axis = null) {
  const shift = add(scale(right(view), -dx * unit), scale(up(view), dy * unit));
  const kept = axis ? ['x', 'y', 'z'].map((name, i) => (name === axis ? shift[i] : 0)) : shift;
  return {...view, position: add(view.position, kept)};
}

/**
 * Goes towards a point (factor < 1) or away from it.
 * @param {View} view
 * @param {Vec3} point
 * @param {number} factor
 * @returns {View}
 */
export function zoom(view, point, factor) {
  const lever = subtract(view.position, point);
  const distance = length(lever);
  if (distance === 0) return view;
  const wanted = Math.max(distance * factor, NEAREST);
  return {...view, position: add(point, scale(lever, wanted / distance))};
}

/**
 * Walks: metres forward and to the right.
 * @param {View} view
 * @param {number} ahead
 * @param {number} sideways
 * @returns {View}
 */
export function walk(view, ahead, sideways) {
  return {...view, position: add(view.position,
    add(scale(forward(view), ahead), scale(right(view), sideways)))};
}

/** @type {Record<string, Vec3>} */
const SIDES = {
  top: [0, 0, 1], bottom: [0, 0, -1], front: [1, 0, 0], back: [-1, 0, 0], left: [0, 1, 0],
  right: [0, -1, 0],
};

/**
 * A look at `centre` from one side, as far from it as now.
 * @param {View} view
 * @param {string} side
 * @param {Vec3} centre
 * @returns {View}
 */
export function fromSide(view, side, centre) {
  const distance = Math.max(length(subtract(view.position, centre)), 0.5);
  const from = SIDES[side];
  const ahead = scale(from, -1);
  return {
    position: add(centre, scale(from, distance)),
    yaw: side === 'top' || side === 'bottom' ? 0 : Math.atan2(ahead[1], ahead[0]),
    pitch: clampPitch(Math.asin(ahead[2])),
  };
}

/**
 * From the same direction, so near that a box fills the picture.
 * @param {View} view
 * @param {{min: Vec3, max: Vec3}} box
 * @param {number} fov
 * @param {number} aspect
 * @returns {View}
 */
export function framing(view, {min, max}, fov, aspect) {
  const centre = scale(add(min, max), 0.5);
  const radius = Math.max(length(subtract(max, min)) / 2, 0.1);
  const narrow = 2 * Math.atan(Math.tan(fov / 2) * Math.min(1, aspect));
  const distance = radius / Math.sin(narrow / 2) * 1.1;
  return {...view, position: subtract(centre, scale(forward(view), distance))};
}

/**
 * Returns the length of the axes at the origin, m. They must not hide models at the origin.
 * @param {number} distance  of the eye, m
 */
export const originScale = (distance) => Math.min(Math.max(distance * 0.12, 0.02), 1);

/** How steeply the first view of a world looks down, rad; steeper where walls would hide what is in it. */
export const FIRST_PITCHES = [-0.42, -0.6, -0.78, -0.96];
/** Things smaller than this, m, are not looked at from nearer. */
const SMALLEST = 0.75;
/** Of the picture's width and height that all there is takes. */
const FILL = 0.78;

/**
 * The first view of a world that has no camera: all of a box from Gazebo's side, from above, as large as
 * it goes into the picture.
 * @param {{min: Vec3, max: Vec3}} box
 * @param {number} fov
 * @param {number} aspect
 * @param {number} [pitch]
 * @returns {View}
 */
export function first({min, max}, fov, aspect, pitch = FIRST_PITCHES[0]) {
  let centre = scale(add(min, max), 0.5);
  const half = scale(subtract(max, min), 0.5);
  const grown = scale(half, Math.max(SMALLEST / 2 / Math.max(length(half), 1e-9), 1));
  const corners = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) =>
    add(centre, [x * grown[0], y * grown[1], z * grown[2]]))));
  const way = {yaw: HOME.yaw, pitch};
  const [ahead, side] = [forward(way), right(way)];
  const top = cross(side, ahead);
  const high = Math.tan(fov / 2) * FILL;
  const wide = high * aspect;
  let distance = 0;
  // What is near looks larger: the middle of the box is not the middle of its picture.
  for (let round = 0; round < 4; round++) {
    const seen = corners.map((corner) => subtract(corner, centre))
      .map((lever) => [dot(lever, side), dot(lever, top), dot(lever, ahead)]);
    distance = Math.max(...seen.map(([x, y, z]) => Math.max(Math.abs(x) / wide, Math.abs(y) / high) - z));
    const [across, upwards] = [0, 1].map((axis) => {
      const slopes = seen.map((lever) => lever[axis] / (distance + lever[2]));
      return (Math.min(...slopes) + Math.max(...slopes)) / 2 * distance;
    });
    centre = add(centre, add(scale(side, across), scale(top, upwards)));
  }
  return {...way, position: subtract(centre, scale(ahead, distance))};
}

/**
 * Between two views; `part` 0..1, slow at both ends; the shorter way round.
 * @param {View} a
 * @param {View} b
 * @param {number} part
 * @returns {View}
 */
export function between(a, b, part) {
  const eased = part * part * (3 - 2 * part);
  /** @param {number} from @param {number} to */
  const mix = (from, to) => from + (to - from) * eased;
  const turn = Math.atan2(Math.sin(b.yaw - a.yaw), Math.cos(b.yaw - a.yaw));
  return {position: a.position.map((value, index) => mix(value, b.position[index])),
    yaw: a.yaw + turn * eased, pitch: mix(a.pitch, b.pitch)};
}
