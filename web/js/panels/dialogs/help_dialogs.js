/** Two windows to read: the hotkey chart and About. */
import {Dialog} from '../dialog.js';
import {h} from '../dom.js';

/**
 * @param {{keys: string, title: string, group: string}[]} hotkeys the one table of them
 */
export function hotkeyDialog(hotkeys) {
  const groups = new Map();
  for (const hotkey of hotkeys) {
    if (!groups.has(hotkey.group)) groups.set(hotkey.group, []);
    groups.get(hotkey.group).push(hotkey);
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
    content: [h('div', {class: 'hotkey-columns'}, ...columns)],
    buttons: [{title: 'Close', primary: true, value: true}],
  }).open();
}

/** @param {{version?: string, app?: string}} about what the server said of itself */
export function aboutDialog(about) {
  return new Dialog({
    title: 'About',
    name: 'about',
    content: [
      h('p', {
        text: `my_simulations ${about.app ?? ''}, protocol ${about.version ?? ''}`,
      }),
      h('p', {
        text: 'Worlds as Gazebo Classic describes them, moved by Bullet, edited in a browser.',
      }),
      h('p', {class: 'soft', text: `Drawn with three.js. Browser: ${navigator.userAgent}`}),
    ],
    buttons: [{title: 'Close', primary: true, value: true}],
  }).open();
}
