/** Who else has this world open, beside the menus: their names, and what they hold. */
import {askText} from '../ui/dialog.js';
import {fill, h, remembered} from '../ui/dom.js';
import {colorOf} from '../person_color.js';
import type {Person} from '../protocol.js';
import type {Page} from './panels.js';

const SELECTED = 3;

/** Who this page is to the simulator: the same after it was loaded again. */
export function identity() {
  let person = '';
  try {
    person = sessionStorage.getItem('person') ?? '';
    if (!person) {
      person = Array.from(crypto.getRandomValues(new Uint32Array(4)), (part) =>
        part.toString(36)).join('');
      sessionStorage.setItem('person', person);
    }
  } catch {
    // Storage may be forbidden: then a page that is loaded again is a new guest.
  }
  const name = remembered.get('person-name', '');
  return {...(person ? {person} : {}), ...(name ? {name} : {})};
}

/** Describes the current activity of a user. */
export function doing({held, selected}: Person) {
  if (held.length) return `is moving ${held.join(', ')}`;
  if (!selected.length) return 'has nothing selected';
  const more = selected.length - SELECTED;
  return `has selected ${selected.slice(0, SELECTED).join(', ')}${more > 0 ? ` and ${more} more` : ''}`;
}

/** Shows the other users of this world. The bar is hidden while there are none. */
export function mountPeople(element: HTMLElement, {store}: Page) {
  const show = () => {
    const {others, people, me} = store;
    element.hidden = others.length === 0;
    const own = people.find(({number}) => number === me);
    fill(element,
      ...others.map((person) => h('button', {
        class: 'plain person',
        title: `${person.name} ${doing(person)}`,
        style: `--person: ${colorOf(person)}`,
        onclick: () => {
          const [name] = person.held.length ? person.held : person.selected;
          if (name && store.entity(name)) store.select([name]);
        },
      }, h('i', {'aria-hidden': 'true'}), h('span', {text: person.name}),
      person.held.length > 0 && h('span', {class: 'soft', text: person.held.join(', ')}))),
      h('button', {
        class: 'plain', text: `${own?.name ?? ''} (you)`, title: 'Change your name',
        onclick: () => askName(store, own?.name ?? ''),
      }));
  };
  for (const event of ['people', 'connection'] as const) store.listen(event, show);
  show();
  let company = 0;
  store.listen('people', () => {
    // New users receive this page's selection; without other users it is not sent.
    if (store.others.length > company) store.tellPresence({selected: store.selection});
    company = store.others.length;
  });
}

const askName = (store: Page['store'], value: string) =>
  askText('Your name', {label: 'Name', value, maxlength: 30}, 'OK', (name) => {
    remembered.set('person-name', name);
    store.tellPresence({name});
  });
