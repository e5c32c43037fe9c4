/** From the document's numbers to three's objects. */
import {Color, LinearSRGBColorSpace, Matrix4, Quaternion, SRGBColorSpace, Vector3} from 'three';
/** @import {Numbers} from '../pose.js' */
/** @import {Object3D} from 'three' */

const position = new Vector3();
const turn = new Quaternion();
const ONE = new Vector3(1, 1, 1);

/** @param {ArrayLike<number>} pose  pose7 @param {Matrix4} [into] */
export function matrixOf(pose, into = new Matrix4()) {
  position.set(pose[0], pose[1], pose[2]);
  turn.set(pose[3], pose[4], pose[5], pose[6]);
  return into.compose(position, turn, ONE);
}

/**
 * A colour as files write it: as it should look on the screen.
 * @param {Numbers|null|undefined} rgba
 * @returns {Color}
 */
export const colorOf = (rgba, fallback = [1, 1, 1]) => {
  const color = rgba ?? fallback;
  return new Color().setRGB(color[0], color[1], color[2], SRGBColorSpace);
};

/**
 * A colour of light: a part of full strength in each channel.
 * @param {number[]} number
 * @returns {Color}
 */
export const lightColorOf = ([r, g, b]) => new Color().setRGB(r, g, b, LinearSRGBColorSpace);

/**
 * Puts a three object where a pose says.
 * @param {Object3D} object
 * @param {Numbers} pose
 */
export function place(object, pose) {
  object.position.set(pose[0], pose[1], pose[2]);
  object.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
}
