/** What the page waits for, written over the view. */
import {h} from '../ui/dom.js';
import type {LoadingPush} from '../protocol.js';
import type {Page} from './panels.js';

/** What is waited for: the line, the simulator that reads its world, meshes and textures. */
export function mountConnectionNote(element: HTMLElement, {store, connection}: Page) {
  const text = h('span');
  const detail = h('span', {class: 'soft'});
  const bar = h('progress', {'aria-label': 'Progress'});
  const note = h('div', {class: 'connection-note', role: 'status', hidden: true}, text, detail, bar);
  element.append(note);
  let begun = false;
  let loading: LoadingPush|null = null;
  const words = () => {
    if (connection.refused) {
      return 'This address now belongs to another start of a simulator, or to another simulator. ' +
        'Run “gzclient”: it opens the editor of the present one.';
    }
    if (loading) return loading.title || 'Loading the world';
    return begun ? 'Connection to the simulator lost. Reconnecting…' : 'Connecting to the simulator…';
  };
  const show = () => {
    begun ||= store.connected;
    note.hidden = store.connected && !loading;
    text.textContent = words();
    const {done = 0, of = 0} = loading ?? {};
    const count = of ? `${done} of ${of}` : '';
    detail.textContent = [loading?.text, count].filter(Boolean).join(' · ');
    bar.hidden = !loading;
    if (of) Object.assign(bar, {max: of, value: done});
    else bar.removeAttribute('value');
  };
  store.listen('connection', () => {
    loading = null;
    show();
  });
  connection.listen('refused', show);
  store.listen('loading', ({detail: news}) => {
    loading = news.of && news.done >= news.of && store.connected ? null : news;
    show();
  });
  // A page that connects at once need not say so.
  setTimeout(show, 600);
}
