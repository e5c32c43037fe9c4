/** Saving what was built as a model folder, and meshes that become links. */
import {encoded} from '../dropped_files.js';
import {RequestError} from '../connection.js';
import {ask, Dialog, faultText, labelled} from '../ui/dialog.js';
import {h} from '../ui/dom.js';
import type {BuildingAbout} from '../protocol.js';
import type {RequestFunction} from '../connection.js';

const blankAbout = (name: string) => ({name, version: '1.0', description: '', author: '', email: ''});

/**
 * Asks again where there is something of that name.
 * @returns false: the user would rather not
 */
async function replacing<T>(request: (overwrite: boolean) => Promise<T>): Promise<T|false> {
  try {
    return await request(false);
  } catch (fault) {
    if (!(fault instanceof RequestError) || fault.issues[0]?.code !== 'exists') throw fault;
    const answer = await ask('Replace the model?', `${faultText(fault)}.`,
      [{title: 'Cancel'}, {title: 'Replace', value: true, danger: true}]);
    return answer ? request(true) : false;
  }
}

/** What is saved, under which name. */
export class ModelFiles {
  request;
  #about: BuildingAbout & {name: string} = blankAbout('');
  /** The name under which this session has saved. */
  saved = '';

  constructor(request: RequestFunction) {
    this.request = request;
  }

  /** @returns path, or null when it was not saved */
  async save(model: string): Promise<string|null> {
    return this.saved ? this.#write(model, this.saved, true) : this.saveAs(model);
  }

  /** Asks for a name. */
  async saveAs(model: string): Promise<string|null> {
    const about = this.#about.name ? this.#about : blankAbout(model);
    const input = (value: string) => h('input', {type: 'text', value, spellcheck: 'false'});
    const name = input(about.name);
    const more = {version: input(about.version), description: input(about.description),
      author: input(about.author), email: input(about.email)};
    const dialog = new Dialog({
      title: 'Save Model', name: 'model-save',
      content: [
        h('p', {text: 'The model becomes a folder in ~/.gazebo/models, and an entry of the Insert tab.'}),
        labelled('Name', name),
        h('details', {}, h('summary', {text: 'Advanced'}), labelled('Version', more.version),
          labelled('Description', more.description), labelled('Author', more.author), labelled('E-mail', more.email)),
      ],
      buttons: [{title: 'Cancel'}, {title: 'Save', primary: true, run: async () => {
        this.#about = {name: name.value.trim(), version: more.version.value, description: more.description.value,
          author: more.author.value, email: more.email.value};
        return await this.#write(model, this.#about.name, false) ?? false;
      }}],
    });
    const path = await dialog.open();
    return typeof path === 'string' ? path : null;
  }

  async #write(model: string, name: string, again: boolean) {
    const {name: _, ...about} = this.#about;
    const reply = await replacing((overwrite) =>
      this.request('save_model', {model, name, about, overwrite: overwrite || again}));
    if (!reply) return null;
    this.saved = name;
    return reply.path;
  }
}

/**
 * Stores a mesh of the desktop as a model folder.
 * @param files  the mesh, and its textures
 * @returns URI of the mesh; null: the user would rather not
 */
async function storedMesh(request: RequestFunction, files: File[]): Promise<string|null> {
  const mesh = files.find(({name}) => /\.(dae|stl|obj|glb)$/i.test(name));
  if (!mesh) throw new Error('Choose a DAE, STL, OBJ or GLB file, with its textures where it has any.');
  const name = mesh.name.replace(/\.[^.]*$/, '').replace(/[^A-Za-z0-9_ .-]/g, '_').replace(/^[^A-Za-z0-9]+/, '') || 'mesh';
  const packed = await encoded(files.map((file) => ({path: file.name, file})));
  const reply = await replacing((overwrite) => request('import_model', {name, files: packed, overwrite}));
  return reply ? `${reply.uri}/meshes/${mesh.name}` : null;
}

/**
 * Asks for a mesh: a file, or the URI of one that is there.
 * @param use  rejects with what is wrong
 */
export function meshDialog(request: RequestFunction, use: (uri: string) => Promise<unknown>) {
  const file = h('input', {type: 'file', multiple: true, accept: '.dae,.stl,.obj,.glb,.mtl,.png,.jpg,.jpeg',
    'aria-label': 'Mesh files'});
  const uri = h('input', {type: 'text', placeholder: 'model://NAME/meshes/FILE', spellcheck: 'false',
    'aria-label': 'Mesh URI'});
  return new Dialog({
    title: 'Add Mesh', name: 'model-mesh',
    content: [labelled('File', file),
      h('p', {class: 'soft', text: 'With its textures; stored in ~/.gazebo/models. Or enter the URI of an existing file:'}),
      labelled('URI', uri)],
    buttons: [{title: 'Cancel'}, {title: 'Add', primary: true, run: async () => {
      const found = file.files?.length ? await storedMesh(request, [...file.files]) : uri.value.trim();
      if (found === null) return false;
      if (!found) throw new Error('Choose a file or enter a URI.');
      await use(found);
      return true;
    }}],
  }).open();
}
