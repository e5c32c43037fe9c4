/**
 * The model editor: a palette over the 3D view. The model that is built stands in the world, whose tree,
 * properties, tools and history work on it as ever; the palette adds links, joints and the rest.
 */
import {ask} from '../ui/dialog.js';
import {byId} from '../ui/dom.js';
import {styled} from '../ui/stylesheet.js';
import {ConnectTool} from './connect_tool.js';
import {linkNames, ownSteps, renamedModel, stepsSince} from '../model_edits.js';
import {ModelFiles} from './model_files.js';
import {Palette} from './model_palette.js';
import {withParts} from '../parts.js';
import type {Actions} from '../actions.js';
import type {RequestFunction} from '../connection.js';
import type {Model} from '../protocol.js';
import type {Notices} from '../panels/notices.js';
import type {Store} from '../store.js';

type EditorParts = {store: Store, request: RequestFunction, actions: Actions, notices: Notices};

/** Shown of the edited model alone. */
const OVERLAYS = ['joints', 'transparent'] as const;

export class ModelEditor extends withParts<EditorParts>() {
  files;
  connect;

  constructor(parts: EditorParts) {
    super(parts);
    const {request} = parts;
    this.files = new ModelFiles(request);
    this.connect = new ConnectTool(this);
  }

  /** Called when the editor has ended by itself. */
  onExit = () => {};
  #palette: Palette|null = null;
  #running = false;
  /** Steps of the history before the first change. */
  #mark = 0;
  /** State of the history when the model was saved; -1: never. */
  #savedAt = -1;
  #ends: (() => void)[] = [];
  /** Names of the links of the model when it was last seen, to know it under another name. */
  #links = '';
  /** Names of the models that were there then. */
  #names: Set<string> = new Set();

  /** The model that is edited, once it has a first link. */
  get model(): Model|undefined {
    const name = this.store.modelEditing?.name;
    return name ? this.store.model(name) : undefined;
  }

  /** Whether this page's user has changed something that no folder has. */
  get dirty() {
    return this.#own.oldest >= 0 && this.store.history.state !== this.#savedAt;
  }

  /** The user's own steps of the history since the editor was opened. */
  get #own() {
    const {store} = this;
    return ownSteps(stepsSince(store.history, this.#mark), (at) => store.authorOf('undo', at));
  }

  /**
   * Begins; time stands still meanwhile.
   * @param name  of the model to edit; null: a new one
   */
  async open(name: string|null) {
    await styled('model_editor.css');
    const {store, actions} = this;
    this.#running = !store.stats.paused;
    if (this.#running) await actions.pause();
    this.#mark = store.history.depth;
    store.setModelEditing({name});
    this.#palette = new Palette(byId('view'), this);
    document.body.classList.add('model-editing');
    this.#ends = [
      ...(['entity', 'document'] as const).map((event) => store.listen(event, () => this.#follow())),
      store.listen('modelEditing', () => this.#show()),
      ...(['selection', 'history'] as const).map((event) =>
        store.listen(event, () => this.#palette?.update())),
      this.connect.listen(),
    ];
    this.#show();
    if (name) store.select([name]);
  }

  /** Shows the links and joints as a diagram, or hides it. */
  toggleSchematic() {
    this.#palette?.schematic.toggle();
  }

  /**
   * Saves; a first time asks for a name.
   * @param as  asks for another name
   */
  async save(as = false) {
    const {model} = this;
    if (!model) {
      this.notices.say('There is nothing to save yet: add a link first.');
      return false;
    }
    const path = await (as ? this.files.saveAs(model.name) : this.files.save(model.name));
    if (!path) return false;
    this.#savedAt = this.store.history.state;
    this.notices.say(`Saved ${path}`);
    this.#palette?.update();
    return true;
  }

  /**
   * Asks what becomes of changes, and leaves.
   * @returns false: the user stays
   */
  async close(): Promise<boolean> {
    if (this.dirty) {
      const {others} = this.#own;
      const text = 'The model has changes that are not saved as a model folder.' + (others.length
        ? ` They cannot be discarded at once: ${others.join(' and ')} edited the world after them.` : '');
      const answer = await ask('Exit model editor?', text, [
        {title: 'Cancel'},
        ...(others.length ? [] : [{title: 'Discard Changes', value: 'discard', danger: true}]),
        {title: 'Keep in World', value: 'keep'},
        {title: 'Save and Exit', value: 'save', primary: true},
      ]);
      if (!answer) return false;
      if (answer === 'save' && !await this.save()) return false;
      if (answer === 'discard' && !await this.discard()) return false;
    }
    await this.#end();
    return true;
  }

  /** Undoes the user's own steps; false where that would undo what others did after them. */
  async discard() {
    const {oldest, others} = this.#own;
    if (others.length) {
      this.notices.say(`Not discarded: ${others.join(' and ')} edited the world meanwhile.`);
      return false;
    }
    // Without `to` the newest step is undone.
    if (oldest >= 0) await this.actions.undo(oldest || undefined);
    return true;
  }

  async #end() {
    for (const end of this.#ends.splice(0)) end();
    this.#overlay(null);
    this.connect.stop();
    this.#palette?.remove();
    document.body.classList.remove('model-editing');
    this.store.setModelEditing(null);
    if (this.#running) await this.actions.play();
    this.onExit();
  }

  /** The model may have got another name, or have gone: undone, say. */
  #follow() {
    const {store, model} = this;
    if (!store.modelEditing) return;
    if (!model && store.modelEditing.name) {
      const renamed = renamedModel(store.document?.models ?? [], this.#links, this.#names);
      store.setModelEditing({name: renamed?.name ?? null});
      return;
    }
    this.#show();
  }

  #show() {
    const {model} = this;
    if (model) {
      this.#links = linkNames(model);
      this.#names = new Set(this.store.document?.models.map(({name}) => name));
    }
    this.#overlay(model?.name ?? null);
    this.#palette?.update();
  }

  #overlaid: string|null = null;

  #overlay(name: string|null) {
    if (name === this.#overlaid) return;
    for (const flag of OVERLAYS) {
      if (this.#overlaid) this.actions.setOverlay(flag, null, this.#overlaid);
      if (name) this.actions.setOverlay(flag, true, name);
    }
    this.#overlaid = name;
  }
}
