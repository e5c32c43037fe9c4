/** Two windows to read: the hotkey chart and About. */
import {Dialog} from '../../ui/dialog.js';
import {h} from '../../ui/dom.js';
import type {Hotkey} from '../../hotkeys.js';
import type {Requests} from '../../protocol.js';

/** @param hotkeys  the one table of them */
export function hotkeyDialog(hotkeys: readonly Hotkey[]) {
  const groups: Map<string, Hotkey[]> = new Map();
  for (const hotkey of hotkeys) {
    groups.set(hotkey.group, [...(groups.get(hotkey.group) ?? []), hotkey]);
  }
  const columns = [...groups].map(([group, keys]) =>
    h(
      'section',
      {},
      h('h3', {text: group}),
      h(
        'dl',
        {},
        ...keys.flatMap(({keys: pressed, title}) => [
          h('dt', {}, h('kbd', {text: pressed})),
          h('dd', {text: title}),
        ]),
      ),
    ),
  );
  return new Dialog({
    title: 'Hotkeys',
    name: 'hotkeys',
    content: [h('div', {class: 'hotkey-columns', role: 'group', 'aria-label': 'Hotkeys', tabindex: 0, autofocus: true}, ...columns)],
    buttons: [{title: 'Close', primary: true, value: true}],
  }).open();
}

/** @param about  what the server said of itself */
export function aboutDialog(about: Partial<Requests['hello']['reply']>) {
  return new Dialog({
    title: 'About',
    name: 'about',
    content: [
      h('p', {
        text: `my_simulations ${about.app ?? ''}, protocol ${about.version ?? ''}`,
      }),
      h('p', {
        text: 'A drop-in replacement for gazebo_ros, powered by PyBullet.',
      }),
      h('p', {class: 'soft', text: `Rendered with three.js. Browser: ${navigator.userAgent}`}),
    ],
    buttons: [{title: 'Close', primary: true, value: true}],
  }).open();
}
