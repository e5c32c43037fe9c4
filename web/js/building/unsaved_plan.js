/** The plan that was never saved, kept in this browser: a crash or a closed tab loses nothing. */
import {remembered} from '../panels/dom.js';
import {isEmpty, withoutImages} from './plan.js';

const KEY = 'building-draft';
const PAUSE = 500;

/** What was left unsaved: {plan, file}, or null. */
export function leftDraft() {
  const draft = remembered.get(KEY, null);
  return draft?.plan?.format === 1 && !isEmpty(draft.plan) ? draft : null;
}

export const forgetDraft = () => remembered.set(KEY, null);

/**
 * Keeps the plan of a session while it has unsaved changes; pictures are left out, being too large.
 * @param {import('./drawing_session.js').Session} session
 * @returns {() => void} stops, and forgets it
 */
export function keepDraft(session) {
  let timer = 0;
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
  session.addEventListener('change', changed);
  window.addEventListener('pagehide', keep);
  return () => {
    clearTimeout(timer);
    window.removeEventListener('pagehide', keep);
    session.removeEventListener('change', changed);
    forgetDraft();
  };
}
