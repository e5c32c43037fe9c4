/** The model of what was selected last. */
import type {Model} from './protocol.js';
import type {Store} from './store.js';

export function modelOfSelection(store: Store): Model|undefined {
  const last = store.selection.at(-1);
  return last ? store.split(last)[0] : undefined;
}
