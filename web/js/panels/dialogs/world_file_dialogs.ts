/**
 * Save As and Open: the folders that the server allows, a list, a name.
 *
 * The server answers `folders {path}` with {path, parent, roots, folders, files}.
 */
import {hasIssue} from '../../connection.js';
import {Dialog, ask, askText, faultText, labelled, mayDiscard} from '../../ui/dialog.js';
import {fill, h, roving, textButton} from '../../ui/dom.js';
import {bytesText} from '../../ui/text_format.js';
import {icon} from '../../ui/icons.js';
import type {Page} from '../panels.js';
import type {RequestFunction} from '../../connection.js';
import type {Requests} from '../../protocol.js';

interface FolderHandlers {
  /** a file was chosen */
  onFile: (file: string) => void;
  /** a file was double-clicked */
  onOpen: (file: string) => void;
  /** null: there is none any more */
  onFault: (fault: unknown) => void;
}

/** What the dialogs need of the page. */
type FileDialogPage = Pick<Page, 'store'|'request'>;

const ENDINGS = /\.(world|sdf|xml)$/i;

/** The ends of paths: the last two folders, and as many more as make each one different. */
export function rootLabels(roots: string[]): string[] {
  const tail = (root: string, count: number) => root.split('/').slice(-count).join('/');
  return roots.map((root) => {
    let count = 2;
    while (count < root.split('/').length &&
      roots.some((other) => other !== root && tail(other, count) === tail(root, count))) count += 1;
    return tail(root, count);
  });
}

/** The list of one folder, with its way up and the allowed roots above it. */
class FolderList {
  request;
  handlers;
  listing: Requests['folders']['reply']|null = null;
  path = h('output', {class: 'folder-path', 'aria-label': 'Folder'});
  roots = h('div', {class: 'folder-roots', role: 'group', 'aria-label': 'Places'});
  list = h('div', {class: 'folder-list', role: 'listbox', 'aria-label': 'Files'});
  element;

  /** @param create  whether a folder can be created: a file of a new one can be saved, not opened */
  constructor(request: RequestFunction, {onFile, onOpen, onFault}: FolderHandlers, create: boolean) {
    this.request = request;
    this.handlers = {onFile, onOpen, onFault};
    const creates = create && textButton('New Folder…', () => this.#create());
    this.element = h(
      'div',
      {class: 'folders'},
      this.roots,
      h('div', {class: 'folder-main'}, h('div', {class: 'folder-head'}, this.path, creates), this.list),
    );
  }

  #rove = roving(this.list, '[role=option]', {vertical: true, wrap: false});

  /** Ends when the folder that was asked for last is shown or refused. */
  arrived: Promise<void> = Promise.resolve();

  /** Shows a folder; without a path, the one the server starts in. */
  go(path?: string) {
    const before = this.arrived;
    this.arrived = (async () => {
      await before;
      await this.#load(path);
    })();
    return this.arrived;
  }

  async #load(path?: string) {
    try {
      this.listing = await this.request('folders', path ? {path} : {});
    } catch (fault) {
      this.handlers.onFault(fault);
      return;
    }
    this.handlers.onFault(null);
    this.#show();
  }

  /** Asks for a name, creates a folder in the one that is shown, and shows it. */
  async #create() {
    const parent = this.listing?.path;
    if (!parent) return;
    const path = await askText('New Folder', {label: 'Folder name'}, 'Create', async (name) =>
      (await this.request('new_folder', {parent, name})).path);
    if (path) await this.go(path);
  }

  #show() {
    if (!this.listing) return;
    const {path, parent, roots, folders, files} = this.listing;
    this.path.textContent = path;
    this.path.title = path;
    const labels = rootLabels(roots);
    fill(
      this.roots,
      ...roots.map((root, at) =>
        h(
          'button',
          {
            class: 'plain wide',
            title: root,
            onclick: () => this.go(root),
            'aria-pressed': String(path === root || path.startsWith(`${root}/`)),
          },
          icon('folder', 15),
          h('span', {class: 'label'}, ...labels[at].split(/(?<=\/)/).flatMap((part) => [part, h('wbr')])),
        ),
      ),
    );
    const rows: HTMLElement[] = [];
    if (parent) rows.push(this.#row('..', 'up', '', () => this.go(parent)));
    for (const folder of folders) {
      rows.push(this.#row(folder.name, 'folder', '', () => this.go(folder.path)));
    }
    for (const file of files) {
      const row = this.#row(file.name, 'file', bytesText(file.size), () =>
        this.handlers.onOpen(file.name),
      );
      row.addEventListener('click', () => this.handlers.onFile(file.name));
      row.addEventListener('focus', () => this.handlers.onFile(file.name));
      rows.push(row);
    }
    if (!rows.length) rows.push(h('p', {class: 'empty', role: 'option', 'aria-disabled': 'true', text: 'This folder is empty.'}));
    fill(this.list, ...rows);
    this.#rove.settle();
  }

  #row(name: string, glyph: string, more: string, open: () => void) {
    const row = h(
      'div',
      {
        class: 'folder-row',
        role: 'option',
        tabindex: -1,
        'aria-selected': 'false',
        ondblclick: open,
        onkeydown: (event) => {
          if (event.key !== 'Enter') return;
          event.preventDefault();
          open();
        },
        onfocus: () => {
          for (const other of this.list.children) other.setAttribute('aria-selected', 'false');
          row.setAttribute('aria-selected', 'true');
        },
      },
      icon(glyph, 15),
      h('span', {class: 'label', text: name}),
      h('span', {class: 'more', text: more}),
    );
    if (glyph !== 'file') row.addEventListener('click', open);
    return row;
  }
}

/** A file's path below a folder. */
function joined(folder: string, name: string) {
  return `${folder.replace(/\/$/, '')}/${name}`;
}

/** The name as it is saved: with the ending of a world, where the user gave none. */
export function withEnding(name: string) {
  return ENDINGS.test(name) ? name : `${name}.world`;
}

/**
 * A window with a field for a name above the list of files.
 * @param options.button  what its button says
 * @param options.nameless  said where no name was given
 * @param options.field  attributes of the field
 * @param options.run  as a button's, for the chosen path
 * @param options.create  whether a folder can be created
 * @param options.more  below the list
 * @param options.onListing  gets the first folder's listing
 * @returns what `run` answered, undefined when cancelled
 */
async function filesDialog(
  request: RequestFunction,
  {title, button, nameless, field, run, create, more = [], onListing = () => {}}: {title: string,
      button: string, nameless: string, field: Record<string, unknown>, run: (path: string) =>
      Promise<string|false>, create: boolean, more?: Node[], onListing?: (listing: Requests['folders']['reply']) =>
      void},
): Promise<string|undefined> {
  const name = h('input', {
    autofocus: true,
    'aria-label': 'File name',
    ...field,
  });
  const folders = new FolderList(request, {
    onFile: (file: string) => {
      name.value = file;
    },
    onOpen: (file: string) => {
      name.value = file;
      dialog.submit();
    },
    onFault: (fault: unknown) => dialog.say(fault ? faultText(fault) : ''),
  }, create);
  const chosen = async () => {
    const wanted = name.value.trim();
    if (!wanted) {
      dialog.say(nameless);
      return false;
    }
    if (wanted.startsWith('/')) return run(wanted);
    // A name belongs to the folder that is shown, which the server may not have told yet.
    await folders.arrived;
    return folders.listing ? run(joined(folders.listing.path, wanted)) : false;
  };
  const dialog = new Dialog({
    title,
    name: 'files',
    content: [labelled('File name', name), folders.element, ...more],
    buttons: [{title: 'Cancel'}, {title: button, primary: true, run: chosen}],
  });
  const closed = dialog.open();
  // Typing replaces the whole name: an ending that is typed decides the format.
  name.select();
  await folders.go();
  if (folders.listing) onListing(folders.listing);
  const answer = await closed;
  return typeof answer === 'string' ? answer : undefined;
}

/**
 * Asks for a name and what belongs into the file, and saves; asks again before it overwrites.
 * @returns the path, undefined when cancelled
 */
export function saveAsDialog({store, request}: FileDialogPage): Promise<string|undefined> {
  const file = baseName(store.history?.file || store.document?.file);
  const choices = new SaveChoices();
  return filesDialog(request, {
    title: 'Save World As',
    button: 'Save',
    nameless: 'Enter a file name.',
    field: {value: file || 'untitled.world'},
    create: true,
    more: [choices.element],
    onListing: (listing) => choices.show(listing),
    run: (path) => saveTo(request, {path: withEnding(path), ...choices.values()}),
  });
}

/** A copy of the world as it is now, for a second simulator beside this one. */
export async function cloneDialog({store, request}: FileDialogPage) {
  const name = baseName(store.history?.file || store.document?.file).replace(/\.[^.]*$/, '');
  const path = await filesDialog(request, {
    title: 'Clone World',
    button: 'Clone',
    nameless: 'Enter a file name.',
    field: {value: `${name || 'untitled'}_clone.world`},
    create: true,
    more: [h('p', {class: 'soft', text: 'The world as it is now, with sim time, velocities and launched models. ' +
      'This world keeps its own file.'})],
    run: (chosen) => saveTo(request, {path: withEnding(chosen), copy: true}),
  });
  if (!path) return;
  const command = `ROS_MASTER_URI=http://localhost:11399 gazebo ${/^[\w./-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`}`;
  const line = h('textarea', {rows: 2, readonly: true, 'aria-label': 'Command'});
  line.value = command;
  const dialog = new Dialog({
    title: 'World Cloned',
    content: [h('p', {text: `Saved ${path}. To run the clone beside this world, without ROS, type in another terminal:`}), line],
    buttons: [{title: 'Copy Command', run: async () => {
      try {
        await navigator.clipboard.writeText(command);
        dialog.say('Copied.');
      } catch {
        // A browser gives its clipboard only where it trusts the address.
        line.select();
        dialog.say('The browser does not allow copying here: press Ctrl+C.');
      }
      return false;
    }}, {title: 'Close', primary: true}],
  });
  await dialog.open();
}

/** What a saved world holds besides its models: what the launch file spawned, and its state. */
class SaveChoices {
  note = h('span', {});
  launched = h('input', {type: 'checkbox'});
  state = h('input', {type: 'checkbox'});
  spawned = h('label', {hidden: true}, this.launched, this.note);
  element = h(
    'div',
    {class: 'save-choices'},
    this.spawned,
    h(
      'label',
      {},
      this.state,
      'Include sim time and velocities; otherwise the world starts at time 0, at rest',
    ),
  );

  /** What the server knows, and what was chosen the last time. */
  show({launched = [], chosen = {}}: {launched?: string[], chosen?: {launched?: boolean,
      state?: boolean}}) {
    this.spawned.hidden = launched.length === 0;
    this.note.textContent =
      `Include ${launched.join(', ')}, which the launch file spawns at each start`;
    this.launched.checked = Boolean(chosen.launched);
    this.state.checked = Boolean(chosen.state);
  }

  values() {
    return {launched: this.launched.checked, state: this.state.checked};
  }
}

async function saveTo(request: RequestFunction, wanted: {path: string, launched?: boolean,
    state?: boolean, copy?: boolean}) {
  let said = '';
  try {
    return (await request('save', {...wanted, overwrite: false})).path;
  } catch (fault) {
    if (!hasIssue(fault, 'exists')) throw fault;
    said = fault instanceof Error ? fault.message : `${wanted.path} already exists`;
  }
  const overwrite = await ask('Overwrite the file?', `${said}.`, [
    {title: 'Cancel'},
    {title: 'Overwrite', value: true, primary: true, danger: true},
  ]);
  return overwrite ? (await request('save', {...wanted, overwrite: true})).path : false;
}

function baseName(path: string|undefined) {
  return path?.split('/').pop() ?? '';
}

/** Chooses a world file and opens it. */
export async function openDialog({store, request}: FileDialogPage): Promise<string|undefined> {
  if (!await mayClose({store, request})) return undefined;
  return filesDialog(request, {
    title: 'Open World',
    button: 'Open',
    nameless: 'Select a file.',
    field: {placeholder: 'file name or path'},
    create: false,
    async run(path) {
      await request('open', {path, discard: true});
      return path;
    },
  });
}

/**
 * Asks what becomes of unsaved changes.
 * @returns whether to go on
 */
const mayClose = async (page: FileDialogPage) => !page.store.history?.dirty ||
  mayDiscard('Save changes?', 'The world has unsaved changes.', () => saveWorld(page));

/** Saves to the world's own file, or asks for a name if it has no file that may be replaced. @returns whether it was saved */
async function saveWorld(page: FileDialogPage) {
  try {
    if (page.store.history.file) {
      await page.request('save', {});
      return true;
    }
  } catch (fault) {
    if (!hasIssue(fault, 'path-needed')) throw fault;
  }
  return Boolean(await saveAsDialog(page));
}

/** An empty world in place of this one. */
export async function newWorld(page: FileDialogPage) {
  if (await mayClose(page)) await page.request('new', {discard: true});
}
