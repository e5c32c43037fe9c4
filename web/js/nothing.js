/** What an action answers that had nothing to do. */
/** @import {Outcome} from './actions.js' */

/** @type {Outcome<{name?: string, names?: string[]}>} */
export const NOTHING = Object.freeze({ok: true, value: {}, issues: []});
