/** The plan that was never saved, kept in this browser: a crash or a closed tab loses nothing. */
import {remembered} from '../panels/dom.js';
import {isEmpty, withoutImages} from './plan.js';
/** @import {Plan} from '../protocol.js' */
/** @import {Session} from './drawing_session.js' */

const KEY = 'building-draft';
const PAUSE = 500;

/** What was left unsaved. @returns {{plan: Plan, file: Session['file']}|null} */
export function leftDraft() {
  const draft = remembered.get(KEY, /** @type {{plan: Plan, file: Session['file']}|null} */ (null));
  return draft?.plan?.format === 1 && !isEmpty(draft.plan) ? draft : null;
}

export const forgetDraft = () => remembered.set(KEY, null);

/**
 * Keeps the plan of a session while it has unsaved changes; pictures are left out, being too large.
 * @param {Session} session
 * @returns {() => void} stops, and forgets it
 */
export function keepDraft(session) {
  /** @type {ReturnType<typeof setTimeout>|0} */
  let timer = 0;
  /** @type {Plan|null} */
  let kept = null;
  const keep = () => {
    timer = 0;
    const {plan} = session.history;
    if (plan === kept) return;
    kept = plan;
    if (session.dirty) remembered.set(KEY, {plan: withoutImages(plan), file: session.file});
    else forgetDraft();
  };
  const changed = () => { timer ||= setTimeout(keep, PAUSE); };
  const unlisten = session.listen('change', changed);
  window.addEventListener('pagehide', keep);
  return () => {
    clearTimeout(timer);
    window.removeEventListener('pagehide', keep);
    unlisten();
    forgetDraft();
  };
}
