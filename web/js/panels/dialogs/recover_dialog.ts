/** Recover: unsaved changes of earlier sessions, and what was discarded in the last week. */
import {Dialog} from '../../ui/dialog.js';
import {fill, h, textButton} from '../../ui/dom.js';
import {icon} from '../../ui/icons.js';
import type {Recoverable} from '../../protocol.js';
import type {Page} from '../panels.js';

export function recoverDialog({store, actions, notices}: Page):
    Promise<unknown> {
  const list = h('div', {class: 'folder-list', 'aria-label': 'Changes that can be recovered'});
  const now = store.history.file || store.document?.file || 'the world without a file';
  const dialog = new Dialog({
    title: 'Recover',
    name: 'logs',
    content: [
      h('p', {text: `What you recover replaces ${now}, which is open now${
        store.history.dirty ? '; its unsaved changes can be recovered in turn' : ''}.`}),
      list,
      h('p', {class: 'soft', text: 'Discarded changes are kept for a week.'}),
    ],
    buttons: [{title: 'Close', primary: true}],
  });
  const row = ({name, file, time, discarded}: Recoverable) => {
    const title = file || 'World without a file';
    return h(
      'div',
      {class: 'folder-row', title: file},
      icon('file', 15),
      h('span', {class: 'label', text: file.split('/').pop() || title}),
      h('span', {class: 'more', text: `${new Date(time * 1000).toLocaleString()}${
        discarded ? ', discarded' : ''}`}),
      textButton('Recover', async () => {
        const {ok, issues} = await actions.recoverEntry(name);
        if (!ok) {
          dialog.say(issues[0].message);
          return;
        }
        dialog.close(name);
        notices.say(`Recovered unsaved changes to ${title}`);
      }, {'aria-label': `Recover ${title}`}),
    );
  };
  actions.recoverable().then(({ok, value, issues}) => {
    if (!ok) dialog.say(issues[0].message);
    const entries = value?.entries ?? [];
    fill(list, ...entries.map(row),
      !entries.length && h('p', {class: 'empty', text: 'Nothing to recover'}));
  });
  return dialog.open();
}
