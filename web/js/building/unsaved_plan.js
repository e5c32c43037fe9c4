/** The plan that was never saved, kept in this browser: a crash or a closed tab loses nothing. */
import {remembered} from '../panels/dom.js';
import {isEmpty, withoutImages} from './plan.js';
/** @import {Plan} from '../protocol.js' */
/** @import {Session} from './drawing_session.js' */

const KEY = 'building-draft';
const PAUSE = 500;
/** How many plans are kept; a new plan replaces the oldest. */
const MOST = 10;

/**
 * The floor-plan picture of a level, which is too large to be kept: its scale, and the level of the
 * saved building that has the same picture; null where the building was not saved with it.
 * @typedef {{at: number, savedAt: number|null, resolution: number}} KeptPicture
 */

/**
 * @typedef {object} Draft
 * @property {string} [by]  whose it is: each tab of the browser may draw a building of its own
 * @property {Plan} plan  without pictures
 * @property {Session['file']} file
 * @property {KeptPicture[]} [pictures]
 */

/** What sessions have left, the newest last. @returns {Draft[]} */
function drafts() {
  const kept = remembered.get(KEY, /** @type {Draft[]|Draft|null} */ (null));
  return Array.isArray(kept) ? kept : [kept].filter((draft) => draft !== null);
}

/** What was left unsaved last. @returns {Draft|null} */
export function leftDraft() {
  return drafts().reverse().find((draft) => draft?.plan?.format === 1
    && (!isEmpty(draft.plan) || draft.pictures?.length)) ?? null;
}

/** @param {string|undefined} by  whose it is */
export const forgetDraft = (by) => remembered.set(KEY, drafts().filter((draft) => draft?.by !== by));

/**
 * Keeps the plan of a session while it has unsaved changes, beside those of other sessions.
 * @param {Session} session
 * @param {Draft|null} [restored]  what the session has begun with, kept as its own from here on
 * @returns {() => void} stops, and forgets what this session kept
 */
export function keepDraft(session, restored = null) {
  const by = `${Date.now()}-${Math.random()}`;
  /** @type {ReturnType<typeof setTimeout>|0} */
  let timer = 0;
  const write = () => {
    const others = drafts().filter((draft) => draft?.by !== by);
    if (session.dirty) others.push({...draftOf(session), by});
    remembered.set(KEY, others.slice(-MOST));
  };
  let kept = session.history.plan;
  let {dirty} = session;
  if (dirty) write();
  if (restored) forgetDraft(restored.by);
  const keep = () => {
    timer = 0;
    const {plan} = session.history;
    if (plan === kept && session.dirty === dirty) return;
    kept = plan;
    dirty = session.dirty;
    write();
  };
  const changed = () => { timer ||= setTimeout(keep, PAUSE); };
  const unlisten = session.listen('change', changed);
  window.addEventListener('pagehide', keep);
  return () => {
    clearTimeout(timer);
    window.removeEventListener('pagehide', keep);
    unlisten();
    forgetDraft(by);
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
