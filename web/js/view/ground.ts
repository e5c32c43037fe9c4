/** Where the ground of a world is. */
import {compose} from '../pose.js';
import type {Model} from '../protocol.js';

/** The highest level plane of a static model, m; null where there is none. */
export function groundHeight(models: readonly Model[]): number|null {
  const heights = models.filter((model) => model.static).flatMap((model) =>
    model.links.flatMap((link) => link.visuals.flatMap(({geometry, pose}) => {
      if (geometry.type !== 'plane' || geometry.normal[2] < 0.999) return [];
      const [, , z, x, y] = compose(model.pose, compose(link.pose, pose));
      return Math.hypot(x, y) < 1e-3 ? [z] : [];
    })));
  return heights.length ? Math.max(...heights) : null;
}
