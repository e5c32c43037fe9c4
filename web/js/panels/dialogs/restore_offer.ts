/** Offers unsaved changes when a page opens. */
import {ask} from '../../ui/dialog.js';
import type {Pushes} from '../../protocol.js';
import type {Page} from '../panels.js';

/** Changes that no file has, from before a crash or an end without saving. */
export async function offerRestore(page: Page, {found, file, time, others}: Pushes['autosave']) {
  if (!found) {
    if (others) {
      page.notices.say(`Unsaved changes to ${others === 1 ? 'another world' :
        `${others} other worlds`} can be restored: File, Recover.`);
    }
    return;
  }
  const when = time ? ` of ${new Date(time * 1000).toLocaleString()}` : '';
  const choice = await ask(
    'Restore unsaved changes?',
    `Unsaved changes to ${file || 'a world without a file'}${when} were found. They replace the ` +
      'world as it is now. Discarded changes can be recovered for a week: File, Recover.',
    [
      {title: 'Discard', value: 'discard', danger: true},
      {title: 'Later'},
      {title: 'Restore', value: 'restore', primary: true},
    ],
  );
  if (choice !== 'discard' && choice !== 'restore') return;
  try {
    await page.request('autosave', {action: choice});
  } catch (fault) {
    page.notices.fault(fault);
  }
}
