/**
 * The camera's moves. A view is {position, yaw, pitch}: m and rad, pitch up positive; there is no
 * roll. It looks along its forward vector; the world's z is up.
 */
import {add, axisAngle, cross, dot, length, rotate, scale, subtract} from './pose.js';
import type {Pose7, Vec3} from './pose.js';

export type View = {position: Vec3, yaw: number, pitch: number};

const RADIANS_PER_PIXEL = 0.004;
const LOOK_PER_PIXEL = Math.PI / 1800;
const HORIZONTAL_FOV = Math.PI / 3;
/** Resolution (pixels per meter) of an orthographic view at first. */
export const ORTHOGRAPHIC_ZOOM = 100;
const STEEPEST = Math.PI / 2 - 1e-4;
const NEAREST = 0.05;

const clampPitch = (pitch: number) => Math.max(-STEEPEST, Math.min(STEEPEST, pitch));

export const forward = ({yaw, pitch}: {yaw: number, pitch: number}) => [
  Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch),
];
export const right = ({yaw}: {yaw: number}) => [Math.sin(yaw), -Math.cos(yaw), 0];
export const up = (view: {yaw: number, pitch: number}) => cross(right(view), forward(view));

/** @returns from a position towards a point */
export function lookAt(position: Vec3, point: Vec3): View {
  const [x, y, z] = subtract(point, position);
  return {position: [...position], yaw: Math.atan2(y, x),
    pitch: clampPitch(Math.atan2(z, Math.hypot(x, y)))};
}

/** The view of a camera pose of a world file: it looks along its x. */
export function fromPose(pose: Pose7): View {
  const ahead = rotate(pose.slice(3), [1, 0, 0]);
  return lookAt(pose.slice(0, 3), add(pose.slice(0, 3), ahead));
}

/** Gazebo's first view. */
export const HOME = Object.freeze(lookAt([5, -5, 2], [0, 0, 0]));

/** Vertical field of view, rad, of a picture `aspect` times as wide as high. */
export const verticalFov = (aspect: number) => 2 * Math.atan(Math.tan(HORIZONTAL_FOV / 2) / aspect);

/**
 * Metres that a pixel covers at a point.
 * @param height  of the picture, px
 */
export function metresPerPixel(view: View, point: Vec3, fov: number, height: number) {
  const depth = Math.max(dot(subtract(point, view.position), forward(view)), NEAREST);
  return 2 * depth * Math.tan(fov / 2) / height;
}

/** Turns the camera about a pivot, which stays where it is in the picture. */
export function orbit(view: View, pivot: Vec3, dx: number, dy: number,
    only: 'pitch'|'yaw'|null = null): View {
  const turn = only === 'pitch' ? 0 : -dx * RADIANS_PER_PIXEL;
  const wanted = only === 'yaw' ? view.pitch : view.pitch - dy * RADIANS_PER_PIXEL;
  const pitch = clampPitch(wanted);
  const lever = subtract(view.position, pivot);
  const pitched = rotate(axisAngle(right(view), pitch - view.pitch), lever);
  const turned = rotate(axisAngle([0, 0, 1], turn), pitched);
  return {position: add(pivot, turned), yaw: view.yaw + turn, pitch};
}

/** Looks round from where the camera is. */
export function look(view: View, dx: number, dy: number): View {
  return {position: view.position, yaw: view.yaw - dx * LOOK_PER_PIXEL,
    pitch: clampPitch(view.pitch - dy * LOOK_PER_PIXEL)};
}

/**
 * Shifts the camera so that a point keeps under the mouse.
 * @param unit  metres per pixel at that point
 * @param axis  only along this world axis
 */
export function pan(view: View, dx: number, dy: number, unit: number, axis: 'x'|'y'|'z'|null = null):
    View {
  const shift = add(scale(right(view), -dx * unit), scale(up(view), dy * unit));
  const kept = axis ? ['x', 'y', 'z'].map((name, i) => (name === axis ? shift[i] : 0)) : shift;
  return {...view, position: add(view.position, kept)};
}

/** Goes towards a point (factor < 1) or away from it. */
export function zoom(view: View, point: Vec3, factor: number): View {
  const lever = subtract(view.position, point);
  const distance = length(lever);
  if (distance === 0) return view;
  const wanted = Math.max(distance * factor, NEAREST);
  return {...view, position: add(point, scale(lever, wanted / distance))};
}

/** Walks: metres forward and to the right. */
export function walk(view: View, ahead: number, sideways: number): View {
  return {...view, position: add(view.position,
    add(scale(forward(view), ahead), scale(right(view), sideways)))};
}

const SIDES: Record<string, Vec3> = {
  top: [0, 0, 1], bottom: [0, 0, -1], front: [1, 0, 0], back: [-1, 0, 0], left: [0, 1, 0],
  right: [0, -1, 0],
};

/** A look at `centre` from one side, as far from it as now. */
export function fromSide(view: View, side: string, centre: Vec3): View {
  const distance = Math.max(length(subtract(view.position, centre)), 0.5);
  const from = SIDES[side];
  const ahead = scale(from, -1);
  return {
    position: add(centre, scale(from, distance)),
    yaw: side === 'top' || side === 'bottom' ? 0 : Math.atan2(ahead[1], ahead[0]),
    pitch: clampPitch(Math.asin(ahead[2])),
  };
}

/** From the same direction, so near that a box fills the picture. */
export function framing(view: View, {min, max}: {min: Vec3, max: Vec3}, fov: number, aspect: number):
    View {
  const centre = scale(add(min, max), 0.5);
  const radius = Math.max(length(subtract(max, min)) / 2, 0.1);
  const narrow = 2 * Math.atan(Math.tan(fov / 2) * Math.min(1, aspect));
  const distance = radius / Math.sin(narrow / 2) * 1.1;
  return {...view, position: subtract(centre, scale(forward(view), distance))};
}

/**
 * Returns the length of the axes at the origin, m. They must not hide models at the origin.
 * @param distance  of the eye, m
 */
export const originScale = (distance: number) => Math.min(Math.max(distance * 0.12, 0.02), 1);

/** How steeply the first view of a world looks down, rad; steeper where walls would hide what is in it. */
export const FIRST_PITCHES = [-0.42, -0.6, -0.78, -0.96];
/** How steeply a view looks into a room, rad. */
export const STEEP = -1.2;
/** Things smaller than this, m, are not looked at from nearer. */
const SMALLEST = 0.75;
/** Of the picture's width and height that all there is takes. */
const FILL = 0.78;

/**
 * The first view of a world that has no camera: all of a box from Gazebo's side, from above, as large as
 * it goes into the picture.
 */
export function first({min, max}: {min: Vec3, max: Vec3}, fov: number, aspect: number,
    pitch: number = FIRST_PITCHES[0]): View {
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

/** Between two views; `part` 0..1, slow at both ends; the shorter way round. */
export function between(a: View, b: View, part: number): View {
  const eased = part * part * (3 - 2 * part);
  const mix = (from: number, to: number) => from + (to - from) * eased;
  const turn = Math.atan2(Math.sin(b.yaw - a.yaw), Math.cos(b.yaw - a.yaw));
  return {position: a.position.map((value, index) => mix(value, b.position[index])),
    yaw: a.yaw + turn * eased, pitch: mix(a.pitch, b.pitch)};
}
