/** Saving, opening and leaving: the windows that ask, and the requests behind them. */
import {Dialog, ask, faultText, labelled, mayDiscard} from '../ui/dialog.js';
import {h} from '../ui/dom.js';
import {aboutFields, NO_AUTHOR} from '../saved_models.js';
import {emptyPlan} from './plan.js';
import {rescaled, withImage} from './draw_tools.js';
import type {BuildingAbout, BuildingOptions} from '../protocol.js';
import type {RequestFunction} from '../connection.js';
import type {Session} from './drawing_session.js';
import type {Draft} from './unsaved_plan.js';

/** The largest picture that is taken as a floor plan. */
const LARGEST_IMAGE = 16 * 1024 * 1024;

/** How a building is saved, besides its plan. */
type SaveOptions = BuildingOptions & BuildingAbout & {folder: string};

/** The folder that a building's name becomes, as on the server. */
const folderName = (name: string) => name.trim().split(/\s+/).join('_');

/** The folder that contains a building's folder. */
const parentOf = (path: string) => path.slice(0, path.lastIndexOf('/'));

const NOT_SAVED: BuildingAbout & {folder: string} = {folder: '', ...NO_AUTHOR};

export class Files {
  session;
  request;
  about = NOT_SAVED;

  constructor(session: Session, request: RequestFunction) {
    this.session = session;
    this.request = request;
  }

  /**
   * Saves where the building was saved before. Asks the first time, and where the building's name
   * would lead to another folder than its own: a copied or renamed one.
   */
  async save(): Promise<boolean> {
    const {file} = this.session;
    if (!file || !this.#isOwn(file.name, this.about.folder)) return this.saveAs();
    try {
      await this.#write(file.name, {...this.about, overwrite: true});
      return true;
    } catch (fault) {
      this.session.say(faultText(fault));
      await ask('Failed to save the building', faultText(fault), [{title: 'OK', primary: true}]);
      return false;
    }
  }

  /** Whether a building of this name in this folder is the one that is drawn. */
  #isOwn(name: string, folder: string) {
    return this.session.file?.path === `${folder.replace(/\/+$/, '')}/${folderName(name)}`;
  }

  /** @returns whether it was saved */
  async saveAs(): Promise<boolean> {
    const {session, about} = this;
    const text = (value: string, more = {}) => h('input', {value, ...more});
    const name = text(session.plan.name, {placeholder: 'Untitled', autofocus: true});
    const folder = text(about.folder, {placeholder: '~/building_editor_models'});
    const more = aboutFields(about);
    const overwrite = h('input', {type: 'checkbox'});
    const replace = h('label', {hidden: true}, overwrite, 'Overwrite the existing building');
    const dialog = new Dialog({
      title: 'Save Building', name: 'building-save',
      content: [labelled('Model name', name), labelled('Location', folder), replace, more.element],
      buttons: [{title: 'Cancel'}, {title: 'Save', primary: true, run: async () => {
        const chosen = {folder: folder.value.trim(), ...more.values()};
        const own = this.#isOwn(name.value, chosen.folder);
        try {
          await this.#write(name.value, {...chosen, overwrite: overwrite.checked || own});
        } catch (fault) {
          if (/already exists|exists already/.test(faultText(fault))) replace.hidden = false;
          throw fault;
        }
        return 'saved';
      }}],
    });
    return (await dialog.open()) === 'saved';
  }

  async #write(name: string, options: SaveOptions) {
    const {session} = this;
    const {history} = session;
    const present = history.plan;
    const renamed = name.trim() || present.name;
    const plan = renamed === present.name ? present : {...present, name: renamed};
    const given = Object.fromEntries(Object.entries(options).filter(([, value]) => value !== ''));
    const saved = await this.request('building_save', {plan, name: plan.name, options: given});
    // Another building was opened meanwhile.
    if (session.history !== history) return;
    if (plan !== present) {
      // Users can draw during saving: these edits stay in the plan and are unsaved.
      const untouched = history.plan === present;
      session.commit(untouched ? plan : {...history.plan, name: renamed}, 'rename building');
    }
    history.markSaved(plan);
    session.file = {path: saved.path, name: plan.name};
    const {version, description, author, email} = options;
    this.about = {version, description, author, email, folder: parentOf(saved.path)};
    session.say(`Saved to ${saved.path}`);
    for (const issue of saved.issues) session.say(`Saved with a warning: ${issue.message}`);
  }

  /** Opens a saved building: one of the list, or the folder or SDF file that is typed. */
  async open() {
    if (!await this.mayDiscard()) return false;
    const buildings = await this.request('building_list', {});
    const path = h('input', {placeholder: 'folder or .sdf file'});
    const list = h('div', {class: 'building-list', ...(buildings.length ? {role: 'listbox', 'aria-label': 'Buildings'} : {})},
      ...buildings.map(({name, path: where}) => h('button', {
        role: 'option', class: 'wide', title: where, text: name,
        onclick: () => { path.value = where; },
        ondblclick: () => { path.value = where; dialog.submit(); },
      })));
    if (!buildings.length) list.append(h('p', {class: 'empty', text: 'No saved buildings'}));
    const dialog = new Dialog({
      title: 'Open Building', name: 'building-open', content: [list, labelled('Path', path)],
      buttons: [{title: 'Cancel'}, {title: 'Open', primary: true, run: async () => {
        await this.load(path.value.trim());
        return 'opened';
      }}],
    });
    return (await dialog.open()) === 'opened';
  }

  /** Opens a building by name or path. */
  async load(name: string) {
    const {plan, path, issues, about} = await this.request('building_load', {name});
    const isFolder = !/\.(sdf|world)$/.test(path);
    this.about = {...NOT_SAVED, ...about, folder: isFolder ? parentOf(path) : ''};
    this.session.open(plan, isFolder ? {path, name: plan.name} : null);
    this.session.say(issues.length ? `Opened with a warning: ${issues[0].message}` : '');
  }

  /**
   * Takes up what an earlier page left unsaved, on top of the saved building: that gives folder,
   * author and pictures. Says what is missing.
   */
  async restore({plan, file, pictures = []}: Draft) {
    const {session} = this;
    let trouble = '';
    if (file) {
      try {
        await this.load(file.path);
      } catch (fault) {
        // Without its folder, saving asks for a place.
        trouble = `${file.path} cannot be opened: ${faultText(fault)}. `;
      }
    }
    const {levels} = session.history.saved;
    const missing: string[] = [];
    let restored = plan;
    for (const {at, savedAt, resolution} of pictures) {
      const image = savedAt === null ? null : levels[savedAt]?.image;
      if (image) restored = withImage(restored, at, {...image, resolution});
      else missing.push(plan.levels[at].name);
    }
    session.commit(restored, 'restore');
    if (missing.length) trouble += `Import the floor plan of ${missing.join(', ')} again: it was not saved.`;
    if (trouble) session.say(trouble);
  }

  /** An empty plan, after a question where something would be lost. */
  async fresh() {
    if (!await this.mayDiscard()) return false;
    this.about = NOT_SAVED;
    this.session.open(emptyPlan());
    return true;
  }

  /** Asks what becomes of changes: true when the plan may go. */
  async mayDiscard(): Promise<boolean> {
    if (!this.session.dirty) return true;
    // Asks again for what was drawn while it was saved.
    return mayDiscard('Save building?', 'The building has unsaved changes.', async () => await this.save() && this.mayDiscard());
  }

  /** Asks before leaving. */
  async leave(): Promise<'cancel'|'saved'|'dropped'> {
    const {session} = this;
    if (!session.dirty) return session.file ? 'saved' : 'dropped';
    const answer = await ask('Exit building editor?', session.file
      ? 'The building has unsaved changes.' : 'The building has not been saved.',
    [{title: 'Cancel'}, {title: "Don't Save, Exit", value: 'drop', danger: true},
      {title: 'Save and Exit', value: 'save', primary: true}]);
    if (answer === 'drop') return session.file ? 'saved' : 'dropped';
    return answer === 'save' && await this.save() ? this.leave() : 'cancel';
  }
}

/**
 * Asks for a picture as floor plan and how its pixels become metres.
 * @param measure  lets the user draw a line
 */
export async function importImage(session: Session, measure: (done: (drawn: number) => void) => void) {
  const {at} = session;
  const present = session.level.image;
  const file = h('input', {type: 'file', accept: '.png,.jpg,.jpeg,image/png,image/jpeg', 'aria-label': 'Image'});
  const resolution = h('input', {type: 'number', value: present?.resolution ?? 100, min: 0.01, step: 'any', 'aria-label': 'Resolution'});
  const line = h('input', {type: 'checkbox', checked: true});
  const dialog = new Dialog({
    title: 'Import Floor Plan', name: 'building-import',
    content: [h('p', {text: 'The image (PNG or JPEG) is shown below this level, centered on the origin.'}),
      labelled('Image', file), labelled('Resolution (pixels per meter)', resolution),
      h('label', {}, line, 'Calibrate with a line of known length')],
    buttons: [{title: 'Cancel'}, ...(present ? [{title: 'Remove', value: 'remove', danger: true}] : []),
      {title: 'Import', primary: true, run: async () => {
        const scale = Number(resolution.value);
        if (!(scale > 0)) throw new Error('The resolution must be greater than 0 pixels per meter.');
        const chosen = file.files?.[0];
        if (!chosen && !present) throw new Error('Select an image first.');
        const image = chosen ? {file: chosen.name, data: await readPicture(chosen)} : present;
        if (image) {
          session.commit(withImage(session.history.plan, at, {...image, resolution: scale}),
            'import floor plan');
        }
        return 'done';
      }}],
  });
  const answer = await dialog.open();
  if (answer === 'remove') session.commit(withImage(session.history.plan, at, null), 'remove floor plan');
  if (answer !== 'done' || !line.checked) return;
  measure(async (drawn) => {
    const length = h('input', {type: 'number', min: 0.001, step: 'any', autofocus: true, 'aria-label': 'Length in meters'});
    const done = Number(await new Dialog({
      title: 'Length of the line', content: [labelled('Length (m)', length)],
      buttons: [{title: 'Cancel'}, {title: 'OK', primary: true, run: () => {
        if (!(Number(length.value) > 0)) throw new Error('The length must be greater than 0 m.');
        return Number(length.value);
      }}],
    }).open());
    const {image} = session.history.plan.levels[at] ?? {};
    if (done && image) {
      session.commit(withImage(session.history.plan, at, rescaled(image, drawn, done)), 'scale floor plan');
    }
  });
}

/** The picture as a data URL; rejects what the browser cannot show. */
async function readPicture(file: File) {
  if (!/^image\/(png|jpeg)$/.test(file.type)) {
    throw new Error(`${file.name} is not a PNG or JPEG image.`);
  }
  if (file.size > LARGEST_IMAGE) throw new Error(`${file.name} is larger than 16 MB.`);
  const data: string = await new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result));
    reader.onerror = () => reject(new Error(`${file.name} cannot be read.`));
    reader.readAsDataURL(file);
  });
  await new Promise((resolve, reject) => {
    const image = new Image();
    image.onload = resolve;
    image.onerror = () => reject(new Error(`${file.name} is not a valid image.`));
    image.src = data;
  });
  return data;
}
