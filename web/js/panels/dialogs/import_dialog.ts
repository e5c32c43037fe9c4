/** Files of the desktop that were dropped on the ground: asks what must be known, then inserts. */
import {encoded, filesOf, kindOf, modelsOfWorld} from '../../dropped_files.js';
import {askToReplace} from '../../saved_models.js';
import {Dialog, labelled} from '../../ui/dialog.js';
import {h} from '../../ui/dom.js';
import type {Dropped, DroppedFile} from '../../dropped_files.js';
import type {Operation} from '../../protocol.js';
import type {Vec3} from '../../pose.js';
import type {Page} from '../panels.js';

const WATER = 1000;

/** @param place  on what carries it */
export async function importDialog(page: Page, entries: Dropped[], place: Vec3) {
  const files: DroppedFile[] = await filesOf(entries);
  const found = kindOf(files);
  if (!found) {
    page.notices.say('Drop a model folder, an SDF, URDF or world file, or one mesh (DAE, STL, OBJ, GLB) ' +
      'with its textures.');
    return;
  }
  if (found.kind === 'text') {
    const sdf = await files[0].file.text();
    const source = files[0].path;
    const {model, light} = await page.request('preview', {sdf, source});
    await insert(page, {kind: 'insert', sdf, source, pose: at(place, model ?? light)});
  } else if (found.kind === 'world') {
    await insert(page, {kind: 'paste', text: modelsOfWorld(await files[0].file.text()),
      source: files[0].path});
  } else if (await store(page, files, found)) {
    const uri = `model://${found.name}`;
    const {model, light} = await page.request('library_get', {uri});
    await insert(page, {kind: 'insert', uri, pose: at(place, model ?? light)});
  }
}

/** It keeps its own turn, and its height over what carries it. */
function at([x, y, z]: Vec3, entity: {pose: number[]}|null|undefined) {
  const [, , height, ...turn] = entity?.pose ?? [0, 0, 0, 0, 0, 0, 1];
  return [x, y, z + height, ...turn];
}

async function insert({actions, store: {select}, store}: Page, op: Operation) {
  const outcome = await actions.edit(op);
  const names = outcome.value?.names ?? (outcome.value?.name ? [outcome.value.name] : []);
  if (names.length) select.call(store, names);
}

/** Stores the files as a model folder; `found.name` is the one that was chosen. */
async function store({request}: Page, files: DroppedFile[],
    found: {kind: string, name: string}) {
  const name = h('input', {value: found.name, 'aria-label': 'Model name'});
  const density = h('input', {type: 'number', value: WATER, min: 1, step: 'any', 'aria-label': 'Density'});
  const mesh = found.kind === 'mesh';
  const dialog = new Dialog({
    title: mesh ? 'Import Mesh' : 'Import Model',
    content: [
      h('p', {text: `${files.length === 1 ? files[0].path : `${files.length} files`} will be stored ` +
        'in ~/.gazebo/models.'}),
      labelled('Model name', name),
      ...(mesh ? [labelled('Density (kg/m\u00b3)', density),
        h('p', {class: 'soft', text: 'Mass and inertia follow from the volume. Water has 1000, wood 600, ' +
          'steel 7800 kg/m\u00b3.'})] : []),
    ],
    buttons: [{title: 'Cancel'}, {title: 'Import', primary: true, run: async () => {
      found.name = name.value.trim();
      if (mesh && !(density.valueAsNumber > 0)) throw new Error('The density must be greater than 0.');
      const fields = {name: found.name, files: await encoded(files),
        ...(mesh ? {density: density.valueAsNumber} : {})};
      return Boolean(await askToReplace((overwrite) => request('import_model', {...fields, overwrite})));
    }}],
  });
  return await dialog.open() === true;
}
