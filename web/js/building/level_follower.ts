/** Where a level is while others are added and deleted: levels have no numbers of their own. */
import type {Session} from './drawing_session.js';

/**
 * Follows the level being drawn through the edits of its building.
 * @returns `at`: its place in the plan, -1 where it is
 * deleted or another building was opened
 */
export function followLevel(session: Session): {at: () => number, end: () => void} {
  const {history, at: first} = session;
  let {levels} = history.plan;
  let at = first;
  let level = levels[first];
  const follow = () => {
    const now = history.plan.levels;
    if (now === levels) return;
    const before = levels;
    levels = now;
    const same = now.indexOf(level);
    // An edited level is a new object in its place; a deleted one leaves it to one that was there.
    const edited = at >= 0 && at < now.length && !before.includes(now[at]);
    if (same >= 0) at = same;
    else if (!edited) at = -1;
    if (at >= 0) level = now[at];
  };
  const end = session.listen('change', follow);
  return {at: () => session.history === history ? at : -1, end};
}
