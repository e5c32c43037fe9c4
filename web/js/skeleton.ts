/** The skeleton of a model: how its links hang together through their joints. Pure. */
import {compose, inverse, position, transform} from './pose.js';
import type {Link, Model} from './protocol.js';
import type {Vec3} from './pose.js';

const ORIGIN = [0, 0, 0];

/**
 * A link's share of its model's skeleton, in the link's frame.
 * @param model  its link poses are in the model's frame
 * @returns a bone runs from the link's origin to a
 * joint, as the file has it; sockets are the joints that the link hangs on.
 */
export function skeletonOf(model: Pick<Model, 'links'|'joints'>, link: Pick<Link, 'name'|'pose'>):
    {bones: number[][][], sockets: number[][]} {
  const bones: Vec3[][] = [];
  const sockets: Vec3[] = [];
  for (const joint of model.joints) {
    if (joint.child === link.name) {
      bones.push([ORIGIN, position(joint.pose)]);
      sockets.push(position(joint.pose));
    }
    const child = model.links.find(({name}) => name === joint.child);
    if (joint.parent === link.name && child) {
      const between = compose(inverse(link.pose), child.pose);
      bones.push([ORIGIN, transform(between, position(joint.pose))]);
    }
  }
  return {bones, sockets};
}
