/**
 * BVH files: a skeleton and its movement, as they come from motion capture. Numbers are lengths of
 * no unit, taken for metres, and degrees; no axis is turned (Gazebo behaviour, as for cameras).
 */
import {
  AnimationClip, Bone, Group, QuaternionKeyframeTrack, VectorKeyframeTrack,
} from 'three';
import {axisAngle, multiply} from '../pose.js';

type Joint = {name: string, parent: number, offset: number[], channels: string[]};

const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

function numbers(words: string[]): number[] {
  const found = words.map(Number);
  if (found.some((number) => !Number.isFinite(number))) {
    throw new Error(`expected numbers, found ${words.join(' ')}`);
  }
  return found;
}

/** Joints, without end sites, up to `MOTION`. */
function jointsOf(rows: Iterator<string[]>): Joint[] {
  if (rows.next().value?.[0] !== 'HIERARCHY') throw new Error('it does not begin with HIERARCHY');
  const joints: Joint[] = [];
  const above: number[] = [];
  let begun = -1;
  for (let {value: words} = rows.next(); words && words[0] !== 'MOTION'; {value: words} = rows.next()) {
    const [kind, ...rest] = words;
    const joint = joints[above.at(-1) ?? -1];
    if (kind === 'ROOT' || kind === 'JOINT') {
      begun = joints.length;
      joints.push({name: rest.join(' '), parent: above.at(-1) ?? -1, offset: [0, 0, 0], channels: []});
    } else if (kind === 'End') begun = -1;
    else if (kind === '{') above.push(begun);
    else if (kind === '}') above.pop();
    else if (kind === 'OFFSET' && joint) joint.offset = numbers(rest.slice(0, 3));
    else if (kind === 'CHANNELS' && joint) joint.channels = rest.slice(1);
  }
  return joints;
}

/** @returns step: s between two frames */
export function parsed(text: string): {joints: Joint[], step: number, frames: number[][]} {
  const rows = text.split(/\r\n?|\n/).map((row) => row.split(/\s+/).filter(Boolean))
    .filter((words) => words.length).values();
  const joints = jointsOf(rows);
  const [count] = numbers((rows.next().value ?? []).slice(1, 2));
  const [step] = numbers((rows.next().value ?? []).slice(2, 3));
  const width = joints.reduce((sum, {channels}) => sum + channels.length, 0);
  const frames = [...rows].slice(0, count).filter((words) => words.length >= width)
    .map((words) => numbers(words.slice(0, width)));
  if (!(step > 0) || !frames.length) throw new Error('it has no whole frame');
  return {joints, step, frames};
}

/**
 * Where a joint is in a frame. Channels of other names say nothing (Gazebo
 * behaviour, as for cameras).
 * @param values  of its channels
 */
export function placed({offset, channels}: Joint, values: number[]) {
  const place = [...offset];
  let turn = [0, 0, 0, 1];
  channels.forEach((channel, index) => {
    const axis = 'XYZ'.indexOf(channel[0]);
    const kind = axis < 0 ? '' : channel.slice(1);
    if (kind === 'position') place[axis] = values[index];
    else if (kind === 'rotation') {
      turn = multiply(turn, axisAngle(AXES[axis], values[index] * Math.PI / 180));
    }
  });
  return {place, turn};
}

/** A scene of bones with one animation. */
export function sceneOf(text: string) {
  const {joints, step, frames} = parsed(text);
  const scene = new Group();
  const times = frames.map((_, index) => index * step);
  let column = 0;
  const bones: Bone[] = [];
  const tracks = joints.flatMap((joint) => {
    const bone = new Bone();
    bone.name = joint.name;
    bone.position.fromArray(joint.offset);
    (bones[joint.parent] ?? scene).add(bone);
    bones.push(bone);
    const first = column;
    column += joint.channels.length;
    const found = frames.map((frame) => placed(joint, frame.slice(first, column)));
    return [
      new VectorKeyframeTrack(`${bone.uuid}.position`, times, found.flatMap(({place}) => place)),
      new QuaternionKeyframeTrack(`${bone.uuid}.quaternion`, times, found.flatMap(({turn}) => turn)),
    ];
  });
  scene.animations = [new AnimationClip('', -1, tracks)];
  return scene;
}
