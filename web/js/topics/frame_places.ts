/**
 * Where the frame of a message is: data of a sensor where the sensor is in the simulated world, a
 * frame with the name of a link at that link, other frames where tf has them beside a link.
 */
import {compose, inverse} from '../pose.js';
import type {Link, Model, Mount} from '../protocol.js';
import type {Pose7} from '../pose.js';

/** a pose in a link's frame; null: the world's */
export type FramePlace = {link: number|null, pose: Pose7};
/** By the child's frame. */
export type Transforms = Map<string, {parent: string, pose: Pose7}>;

const IDENTITY: Pose7 = [0, 0, 0, 0, 0, 0, 1];
const WORLD = ['', 'world'];

/**
 * @param known.model  the one that the topic belongs to
 * @param known.mount  of the sensor whose data it is
 * @returns null for an unknown frame
 */
export function placeOf(frame: string, {models, model = '', mount = null,
    transforms = new Map()}: {models: Model[], model?: string|undefined,
    mount?: Mount|null|undefined, transforms?: Transforms}): FramePlace|null {
  const own = models.find(({name}) => name === model);
  const carrier = mount && own?.links.find(({name}) => name === mount.link);
  if (carrier && mount) return {link: carrier.id, pose: mount.pose};
  const name = frame.replace(/^\//, '');
  const link = linkOf(name, models, model);
  if (link) return {link: link.id, pose: IDENTITY};
  if (WORLD.includes(name)) return {link: null, pose: IDENTITY};
  return byTransforms(name, models, model, transforms);
}

/**
 * The link that a frame is named after: of the topic's own model first, else of the only model that
 * has one; a prefix may be a model's name or a namespace.
 */
function linkOf(frame: string, models: Model[], preferred: string): Link|null {
  const cut = frame.lastIndexOf('/');
  const prefix = cut < 0 ? '' : frame.slice(0, cut);
  const last = frame.slice(cut + 1);
  const found = models.flatMap((model) => {
    const link = model.links.find(({name}) => name === frame) ??
      model.links.find(({name}) => name === last);
    return link ? [{model: model.name, link}] : [];
  });
  const best = found.find(({model}) => model === prefix) ??
    found.find(({model}) => model === preferred) ??
    (found.length === 1 ? found[0] : undefined);
  return best?.link ?? null;
}

function byTransforms(start: string, models: Model[], model: string, transforms: Transforms):
    FramePlace|null {
  /** The poses of `start` in the frames that were reached. */
  const queue: [string, Pose7][] = [[start, IDENTITY]];
  const seen = new Set([start]);
  for (let at = 0; at < queue.length; at++) {
    const [frame, pose] = queue[at];
    const link = linkOf(frame, models, model);
    if (link) return {link: link.id, pose};
    const go = (next: string, there: Pose7) => {
      if (seen.has(next)) return;
      seen.add(next);
      queue.push([next, there]);
    };
    const up = transforms.get(frame);
    if (up) go(up.parent, compose(up.pose, pose));
    for (const [child, {parent, pose: down}] of transforms) {
      if (parent === frame) go(child, compose(inverse(down), pose));
    }
  }
  return seen.has('world') ? {link: null, pose: queue.find(([name]) => name === 'world')?.[1] ?? IDENTITY}
    : null;
}
