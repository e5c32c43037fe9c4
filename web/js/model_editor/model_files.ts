/** Saving what was built as a model folder, and meshes that become links. */
import {encoded} from '../dropped_files.js';
import {aboutFields, askToReplace, NO_AUTHOR} from '../saved_models.js';
import {Dialog, labelled} from '../ui/dialog.js';
import {h} from '../ui/dom.js';
import type {RequestFunction} from '../connection.js';

/** What is saved, under which name. */
export class ModelFiles {
  request;
  #about = {name: '', ...NO_AUTHOR};
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
    const name = h('input', {value: this.#about.name || model});
    const about = aboutFields(this.#about);
    const dialog = new Dialog({
      title: 'Save Model', name: 'model-save',
      content: [
        h('p', {text: 'The model becomes a folder in ~/.gazebo/models, and an entry of the Insert tab.'}),
        labelled('Name', name), about.element,
      ],
      buttons: [{title: 'Cancel'}, {title: 'Save', primary: true, run: async () => {
        this.#about = {name: name.value.trim(), ...about.values()};
        return await this.#write(model, this.#about.name, false) ?? false;
      }}],
    });
    const path = await dialog.open();
    return typeof path === 'string' ? path : null;
  }

  async #write(model: string, name: string, again: boolean) {
    const {name: _, ...about} = this.#about;
    const reply = await askToReplace((overwrite) =>
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
  const reply = await askToReplace((overwrite) => request('import_model', {name, files: packed, overwrite}));
  return reply ? `${reply.uri}/meshes/${mesh.name}` : null;
}

/**
 * Asks for a mesh: a file, or the URI of one that is there.
 * @param use  rejects with what is wrong
 */
export function meshDialog(request: RequestFunction, use: (uri: string) => Promise<unknown>) {
  const file = h('input', {type: 'file', multiple: true, accept: '.dae,.stl,.obj,.glb,.mtl,.png,.jpg,.jpeg',
    'aria-label': 'Mesh files'});
  const uri = h('input', {placeholder: 'model://NAME/meshes/FILE',
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
