/** The plan that was never saved, kept in this browser: a crash or a closed tab loses nothing. */
import {remembered} from '../ui/dom.js';
import {isEmpty, withoutImages} from './plan.js';
import type {Plan} from '../protocol.js';
import type {Session} from './drawing_session.js';

const KEY = 'building-draft';
const PAUSE = 500;
/** How many plans are kept; a new plan replaces the oldest. */
const MOST = 10;

/**
 * The floor-plan picture of a level, which is too large to be kept: its scale, and the level of the
 * saved building that has the same picture; null where the building was not saved with it.
 */
type KeptPicture = {at: number, savedAt: number|null, resolution: number};

export interface Draft {
  /** whose it is: each tab of the browser may draw a building of its own */
  by?: string;
  /** without pictures */
  plan: Plan;
  file: Session['file'];
  pictures?: KeptPicture[];
}

/** What sessions have left, the newest last. */
function drafts(): Draft[] {
  const kept = remembered.get(KEY, null as Draft[]|Draft|null);
  return Array.isArray(kept) ? kept : [kept].filter((draft) => draft !== null);
}

/** What was left unsaved last. */
export function leftDraft(): Draft|null {
  return drafts().reverse().find((draft) => draft?.plan?.format === 1
    && (!isEmpty(draft.plan) || draft.pictures?.length)) ?? null;
}

/** @param by  whose it is */
export const forgetDraft = (by: string|undefined) => remembered.set(KEY, drafts().filter((draft) =>
    draft?.by !== by));

/**
 * Keeps the plan of a session while it has unsaved changes, beside those of other sessions.
 * @param restored  what the session has begun with, kept as its own from here on
 * @returns stops, and forgets what this session kept
 */
export function keepDraft(session: Session, restored: Draft|null = null): () => void {
  const by = `${Date.now()}-${Math.random()}`;
  let timer: ReturnType<typeof setTimeout>|0 = 0;
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

function draftOf({history: {plan, saved}, file}: Session): Draft {
  const pictures = plan.levels.flatMap(({image}, at) => {
    if (!image) return [];
    const savedAt = file ? saved.levels.findIndex((level) => level.image?.data === image.data) : -1;
    return [{at, savedAt: savedAt < 0 ? null : savedAt, resolution: image.resolution}];
  });
  return {plan: withoutImages(plan), file, pictures};
}
