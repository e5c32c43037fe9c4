/** What an action answers that had nothing to do. */
import type {Outcome} from './actions.js';

export const NOTHING: Outcome<{name?: string, names?: string[]}> = Object.freeze({ok: true,
    value: {}, issues: []});
