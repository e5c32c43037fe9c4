/** From the document's numbers to three's objects. */
import {Color, LinearSRGBColorSpace, Matrix4, Quaternion, SRGBColorSpace, Vector3} from 'three';
import type {Numbers} from '../pose.js';
import type {Box3, Object3D} from 'three';

const position = new Vector3();
const turn = new Quaternion();
const ONE = new Vector3(1, 1, 1);

/** @param pose  pose7 */
export function matrixOf(pose: ArrayLike<number>, into: Matrix4 = new Matrix4()) {
  position.set(pose[0], pose[1], pose[2]);
  turn.set(pose[3], pose[4], pose[5], pose[6]);
  return into.compose(position, turn, ONE);
}

/** A colour as files write it: as it should look on the screen. */
export const colorOf = (rgba: Numbers|null|undefined, fallback = [1, 1, 1]): Color => {
  const color = rgba ?? fallback;
  return new Color().setRGB(color[0], color[1], color[2], SRGBColorSpace);
};

/** A colour of light: a part of full strength in each channel. */
export const lightColorOf = ([r, g, b]: number[]): Color => new Color().setRGB(r, g, b,
    LinearSRGBColorSpace);

/** Opposite corners of a box, m. */
export const cornersOf = ({min, max}: Box3) => ({min: min.toArray(), max: max.toArray()});

/** Puts a three object where a pose says. */
export function place(object: Object3D, pose: Numbers) {
  object.position.set(pose[0], pose[1], pose[2]);
  object.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
}
