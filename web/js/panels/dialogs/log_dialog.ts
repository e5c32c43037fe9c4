/** Log data: records the state of the world, lists what was recorded, opens it to be replayed. */
import {Dialog} from '../../ui/dialog.js';
import {fill, h, textButton} from '../../ui/dom.js';
import {bytesText} from '../../ui/text_format.js';
import {icon} from '../../ui/icons.js';
import type {Issue} from '../../connection.js';
import type {Page} from '../panels.js';

export function logsDialog({store, actions}: Page): Promise<unknown> {
  const name = h('input', {
    placeholder: 'default: date and time',
    'aria-label': 'Log name',
  });
  const record = h('button');
  const list = h('div', {class: 'folder-list', 'aria-label': 'Logs'});
  const check = (outcome: {ok: boolean, issues: Issue[]}) => {
    dialog.say(outcome.ok ? '' : outcome.issues[0].message);
    return outcome.ok;
  };
  const showList = async () => {
    const outcome = await actions.logList();
    if (!outcome.ok) return;
    const logs = [...outcome.value.logs].sort((a, b) => b.modified - a.modified);
    fill(
      list,
      ...(logs.length
        ? logs.map((log) =>
            h(
              'div',
              {class: 'folder-row'},
              icon('log', 15),
              h('span', {class: 'label', text: log.name}),
              h('span', {
                class: 'more',
                text: `${bytesText(log.bytes)}, ${new Date(log.modified * 1000).toLocaleString()}`,
              }),
              textButton('Replay', async () => {
                if (check(await actions.logOpen(log.name))) dialog.close(log.name);
              }, {'aria-label': `Replay ${log.name}`}),
            ),
          )
        : [h('p', {class: 'empty', text: 'No logs'})]),
    );
  };
  const update = () => {
    const recording = store.log?.state === 'recording';
    fill(
      record,
      icon('log', 16),
      h('span', {text: recording ? `Stop recording ${store.log?.name ?? ''}` : 'Record'}),
    );
    record.classList.toggle('danger', recording);
    name.disabled = recording;
  };
  record.addEventListener('click', async () => {
    const recording = store.log?.state === 'recording';
    if (check(recording ? await actions.logStop() : await actions.logStart(name.value.trim()))) {
      await showList();
    }
    update();
  });
  const dialog = new Dialog({
    title: 'Log Data',
    name: 'logs',
    content: [
      h('div', {class: 'row'}, record, name),
      h('p', {
        class: 'soft',
        text: `Records the poses of all links while the simulation runs. A replay is shown in this
          window only; the simulation keeps running.`,
      }),
      list,
    ],
    buttons: [{title: 'Close', primary: true, value: true}],
  });
  const unlisten = store.listen('log', update);
  update();
  showList();
  return dialog.open().finally(unlisten);
}
