/**
 * Where the frame of a message is: data of a sensor where the sensor is in the simulated world, a
 * frame with the name of a link at that link, other frames where tf has them beside a link.
 */
import {compose, inverse} from '../pose.js';
/** @import {Link, Model, Mount} from '../protocol.js' */
/** @import {Pose7} from '../pose.js' */

/** @typedef {{link: number|null, pose: Pose7}} FramePlace  a pose in a link's frame; null: the world's */
/** By the child's frame. @typedef {Map<string, {parent: string, pose: Pose7}>} Transforms */

/** @type {Pose7} */
const IDENTITY = [0, 0, 0, 0, 0, 0, 1];
const WORLD = ['', 'world'];

/**
 * @param {string} frame
 * @param {object} known
 * @param {Model[]} known.models
 * @param {string} [known.model]  the one that the topic belongs to
 * @param {Mount|null} [known.mount]  of the sensor whose data it is
 * @param {Transforms} [known.transforms]
 * @returns {FramePlace|null} null for an unknown frame
 */
export function placeOf(frame, {models, model = '', mount = null, transforms = new Map()}) {
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
 * @param {string} frame
 * @param {Model[]} models
 * @param {string} preferred
 * @returns {Link|null}
 */
function linkOf(frame, models, preferred) {
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

/**
 * @param {string} start
 * @param {Model[]} models
 * @param {string} model
 * @param {Transforms} transforms
 * @returns {FramePlace|null}
 */
function byTransforms(start, models, model, transforms) {
  /** The poses of `start` in the frames that were reached. @type {[string, Pose7][]} */
  const queue = [[start, IDENTITY]];
  const seen = new Set([start]);
  for (let at = 0; at < queue.length; at++) {
    const [frame, pose] = queue[at];
    const link = linkOf(frame, models, model);
    if (link) return {link: link.id, pose};
    /** @param {string} next @param {Pose7} there */
    const go = (next, there) => {
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
