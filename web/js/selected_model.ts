/** The model of what was selected last, and what a model is to selections. */
import type {Model} from './protocol.js';
import type {Store} from './store.js';

/** Whether nothing is seen of a model but planes. */
export function isGround(model: Model) {
  const visuals = model.links.flatMap((link) => link.visuals);
  return visuals.length > 0 && visuals.every(({geometry}) => geometry.type === 'plane');
}

export function modelOfSelection(store: Store): Model|undefined {
  const last = store.selection.at(-1);
  return last ? store.split(last)[0] : undefined;
}
