/** The plan that was never saved, kept in this browser: a crash or a closed tab loses nothing. */
import {remembered} from '../panels/dom.js';
import {isEmpty, withoutImages} from './plan.js';
/** @import {Plan} from '../protocol.js' */
/** @import {Session} from './drawing_session.js' */

const KEY = 'building-draft';
const PAUSE = 500;

/**
 * The floor-plan picture of a level, which is too large to be kept: its scale, and the level of the
 * saved building that has the same picture; null where the building was not saved with it.
 * @typedef {{at: number, savedAt: number|null, resolution: number}} KeptPicture
 */

/**
 * @typedef {object} Draft
 * @property {Plan} plan  without pictures
 * @property {Session['file']} file
 * @property {KeptPicture[]} [pictures]
 */

/** What was left unsaved. @returns {Draft|null} */
export function leftDraft() {
  const draft = remembered.get(KEY, /** @type {Draft|null} */ (null));
  const has = draft?.plan?.format === 1 && (!isEmpty(draft.plan) || draft.pictures?.length);
  return has ? draft : null;
}

export const forgetDraft = () => remembered.set(KEY, null);

/**
 * Keeps the plan of a session while it has unsaved changes. A draft of an earlier session stays
 * until this one has something to keep.
 * @param {Session} session
 * @returns {() => void} stops, and forgets what this session kept
 */
export function keepDraft(session) {
  /** @type {ReturnType<typeof setTimeout>|0} */
  let timer = 0;
  // What was restored is unsaved, and kept as this session's from here on.
  let own = session.dirty;
  let kept = session.history.plan;
  let dirty = session.dirty;
  const keep = () => {
    timer = 0;
    const {plan} = session.history;
    if (plan === kept && session.dirty === dirty) return;
    kept = plan;
    dirty = session.dirty;
    own ||= dirty;
    if (dirty) remembered.set(KEY, draftOf(session));
    else if (own) forgetDraft();
  };
  const changed = () => { timer ||= setTimeout(keep, PAUSE); };
  const unlisten = session.listen('change', changed);
  window.addEventListener('pagehide', keep);
  return () => {
    clearTimeout(timer);
    window.removeEventListener('pagehide', keep);
    unlisten();
    if (own) forgetDraft();
  };
}

/** @param {Session} session @returns {Draft} */
function draftOf({history: {plan, saved}, file}) {
  const pictures = plan.levels.flatMap(({image}, at) => {
    if (!image) return [];
    const savedAt = file ? saved.levels.findIndex((level) => level.image?.data === image.data) : -1;
    return [{at, savedAt: savedAt < 0 ? null : savedAt, resolution: image.resolution}];
  });
  return {plan: withoutImages(plan), file, pictures};
}
