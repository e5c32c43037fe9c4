/** What the first view of a world hides: it is chosen so that this is little. */
import type {Item} from './batches.js';
import type {ViewParts} from './view.js';
import type {Vec3} from '../pose.js';

/** More models are not asked for: the first view shall not wait for them. */
const MOST_MODELS = 12;
/** Meshes with more triangles are taken for what is looked at, not for walls. */
const MOST_TRIANGLES = 20000;

function mayHide({geometry, material, owner}: Item) {
  const corners = geometry.index?.count ?? geometry.getAttribute('position')?.count ?? 0;
  return !owner.plane && corners <= 3 * MOST_TRIANGLES &&
    ![material].flat().some(({transparent}) => transparent);
}

/**
 * How many models that can move have their middle behind another model.
 * @param eye  world, m
 */
export function hiddenFrom(eye: Vec3, {store, models, batches, picker}: Pick<ViewParts,
    'store'|'models'|'batches'|'picker'>) {
  const items = [...batches.items()].filter(mayHide);
  const movable = (store.document?.models ?? []).filter((model) => !model.static);
  return movable.slice(0, MOST_MODELS).filter(({name}) => {
    const box = models.bounds(name);
    const middle = box && [0, 1, 2].map((axis) =>
      (box.min.getComponent(axis) + box.max.getComponent(axis)) / 2);
    return middle && picker.isBetween(items, eye, middle, ({owner}) => owner.model !== name);
  }).length;
}
