/** The command search: every item of the menus and every action that has a key, by its name. */
import {HOTKEYS, isReading, run} from '../../hotkeys.js';
import {LIGHTS, SHAPES} from '../../new_entities.js';
import {Dialog} from '../../ui/dialog.js';
import {fill, h} from '../../ui/dom.js';
import {keysOf, menus} from '../menu_items.js';
import type {MenuItem} from '../../ui/popup.js';
import type {Page} from '../panels.js';

type Command = {title: string, group: string, keys: string, run: () => unknown};

/** The most that are listed. */
const MOST = 12;

/** What can be done now. */
export function commandsOf(page: Page): Command[] {
  const {actions, store} = page;
  const found: Command[] = [];
  /** Keys of all items, also of those that cannot be chosen now. */
  const known = new Set();
  const take = (items: MenuItem[], group: string) => {
    for (const {title, keys = '', run: start, enabled, items: inner} of items) {
      known.add(keys);
      if (inner) take(inner, `${group}, ${title}`);
      else if (title && start && (enabled?.() ?? true)) found.push({title, group, keys, run: start});
    }
  };
  for (const {title, items, edits} of menus(page)) if (!(edits && store.readOnly)) take(items(), title);
  for (const shape of store.readOnly ? [] : SHAPES) {
    found.push({title: `Insert ${shape}`, group: 'Insert', keys: '', run: () => actions.insertShape(shape)});
  }
  for (const type of store.readOnly ? [] : LIGHTS) {
    found.push({title: `Insert ${type} light`, group: 'Insert', keys: '', run: () => actions.insertLight(type)});
  }
  for (const row of HOTKEYS) {
    const {keys, title, group, action} = row;
    if (store.readOnly && !isReading(row) || row.placing && !store.placing) continue;
    if (action && action !== 'commands' && !known.has(keysOf(action))) {
      found.push({title, group, keys, run: () => run(actions, action)});
    }
  }
  return found;
}

/**
 * The commands whose name or group has all typed words; those first whose name begins so, then those with words
 * that begin so. What follows a colon, as in "Undo: Insert unit_box", is not the command's own name.
 */
export function matching(commands: Command[], typed: string) {
  const words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  const fitting = commands.filter(({title, group}) =>
    words.every((word) => `${title} ${group}`.toLowerCase().includes(word)));
  const late = ({title}: Command) => {
    const own = title.toLowerCase().split(':')[0];
    if (own.startsWith(words[0] ?? '')) return 0;
    const starts = own.split(/[^\p{L}\p{N}]+/u);
    return words.every((word) => starts.some((start) => start.startsWith(word))) ? 1 : 2;
  };
  return fitting.sort((a, b) => late(a) - late(b));
}

export async function commandDialog(page: Page) {
  const commands = commandsOf(page);
  let [at, shown] = [0, commands];
  const list = h('div', {class: 'command-list', role: 'listbox', id: 'command-list', 'aria-label': 'Commands'});
  const input = h('input', {role: 'combobox', 'aria-expanded': 'true', 'aria-controls': 'command-list',
    'aria-autocomplete': 'list', 'aria-label': 'Command', autofocus: true,
    placeholder: 'Type a command'});
  const show = () => {
    const first = Math.max(0, Math.min(at - MOST + 1, shown.length - MOST));
    fill(list, ...shown.slice(first, first + MOST).map((command, index) => h('div', {
      class: 'command', role: 'option', id: `command-${first + index}`, 'aria-selected': String(first + index === at),
      onclick: () => {
        at = first + index;
        dialog.submit();
      },
    }, h('span', {class: 'label', text: command.title}), h('span', {class: 'soft', text: command.group}),
    command.keys && h('kbd', {text: command.keys}))));
    if (!shown.length) fill(list, h('p', {class: 'empty', text: 'No such command'}));
    input.setAttribute('aria-activedescendant', shown.length ? `command-${at}` : '');
  };
  input.addEventListener('input', () => {
    [at, shown] = [0, matching(commands, input.value)];
    show();
  });
  input.addEventListener('keydown', (event) => {
    const step = {ArrowDown: 1, ArrowUp: -1}[event.key];
    if (!step || !shown.length) return;
    event.preventDefault();
    at = (at + step + shown.length) % shown.length;
    show();
  });
  const dialog = new Dialog({title: 'Commands', name: 'commands', content: [input, list],
    buttons: [{title: 'Cancel'}, {title: 'Run', primary: true, run: () => shown[at] ?? false}]});
  show();
  const chosen = await dialog.open() as Command|undefined;
  // The window is closed: what opens another one has the page for itself.
  await chosen?.run();
}
