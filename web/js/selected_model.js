/** The model of what was selected last. */
/** @import {Model} from './protocol.js' */
/** @import {Store} from './store.js' */

/** @param {Store} store @returns {Model|undefined} */
export function modelOfSelection(store) {
  const last = store.selection.at(-1);
  return last ? store.split(last)[0] : undefined;
}
