/** What the page waits for, written over the view. */
import {h} from '../ui/dom.js';
import type {AskedRequest} from '../connection.js';
import type {Pushes, Requests} from '../protocol.js';
import type {Page} from './panels.js';

/** Milliseconds after which a request is said to be under way. */
const SLOW_REQUEST = 500;

const TITLES: Partial<Record<keyof Requests, string>> = {
  undo: 'Undo', redo: 'Redo', save: 'Saving the world', copy: 'Copying', open: 'Opening the world', new: 'Opening a new world',
  import_model: 'Importing the model', preview: 'Reading the files', save_model: 'Saving the model',
  building_save: 'Saving the building', building_load: 'Opening the building', template: 'Making the robot',
  autosave: 'Recovering', library_get: 'Loading the model',
};

const VERBS: Record<string, string> = {delete: 'Deleting', insert: 'Inserting', paste: 'Pasting', move: 'Moving'};

/** What a request does, for those that can take long; '' for others. */
function titleOf({type, fields}: AskedRequest) {
  if (type !== 'edit') return TITLES[type] ?? '';
  const {op} = fields as Requests['edit']['fields'];
  const names = op.kind === 'delete' ? op.names : op.kind === 'move' ? Object.keys(op.poses) : [];
  const count = names.length > 1 ? ` ${names.length} models` : '';
  return op.kind === 'group' ? op.label ?? 'Changing the world' : `${VERBS[op.kind] ?? 'Changing the world'}${count}`;
}

/** What is waited for: the line, the simulator that reads its world, meshes and textures. */
export function mountConnectionNote(element: HTMLElement, {store, connection}: Page) {
  const text = h('span');
  const detail = h('span', {class: 'soft'});
  const bar = h('progress', {'aria-label': 'Progress'});
  const note = h('div', {class: 'connection-note', role: 'status', hidden: true}, text, detail, bar);
  element.append(note);
  let begun = false;
  let loading: Pushes['loading']|null = null;
  /** What takes long, by request. */
  const asked: Map<number, {title: string, timer: ReturnType<typeof setTimeout>, slow: boolean}> = new Map();
  const slow = () => [...asked.values()].find((one) => one.slow)?.title ?? '';
  const words = () => {
    if (connection.refused) {
      return 'This address now belongs to another start of a simulator, or to another simulator. ' +
        'Run “gzclient”: it opens the editor of the present one.';
    }
    if (loading) return loading.title || 'Loading the world';
    if (store.connected && slow()) return `${slow()}…`;
    return begun ? 'Connection to the simulator lost. Reconnecting…' : 'Connecting to the simulator…';
  };
  const show = () => {
    begun ||= store.connected;
    note.hidden = store.connected && !loading && !slow();
    text.textContent = words();
    const {done = 0, of = 0} = loading ?? {};
    const count = of ? `${done} of ${of}` : '';
    detail.textContent = [loading?.text, count].filter(Boolean).join(' · ');
    bar.hidden = !loading && !slow();
    if (of) Object.assign(bar, {max: of, value: done});
    else bar.removeAttribute('value');
  };
  store.listen('connection', () => {
    loading = null;
    show();
  });
  connection.listen('refused', show);
  connection.listen('asked', ({detail}) => {
    const title = titleOf(detail);
    if (!title) return;
    const timer = setTimeout(() => {
      const one = asked.get(detail.id);
      if (one) one.slow = true;
      show();
    }, SLOW_REQUEST);
    asked.set(detail.id, {title, timer, slow: false});
  });
  connection.listen('answered', ({detail: {id}}) => {
    const one = asked.get(id);
    if (!one) return;
    clearTimeout(one.timer);
    asked.delete(id);
    if (one.slow) show();
  });
  store.listen('loading', ({detail: news}) => {
    loading = news.of && news.done >= news.of && store.connected ? null : news;
    show();
  });
  // A page that connects at once need not say so.
  setTimeout(show, 600);
}
