/** A joint by two choices, in the view, in the tree or in a list: the parent link, then the child link. */
import {connection, isLinkOf} from '../model_edits.js';
import type {ModelEditor} from './model_editor.js';

export class ConnectTool {
  editor;
  type = 'revolute';
  /** The link that was clicked first, or "world". */
  parent: string|null = null;
  /** Called when what is to be clicked next has changed. */
  onChange = () => {};

  constructor(editor: ModelEditor) {
    this.editor = editor;
  }

  get active() { return this.editor.store.mode === 'connect'; }

  /** What the user is asked for; '' when nothing. */
  get hint() {
    if (!this.active) return '';
    return this.parent === null ? 'Click the parent link, in the view or in the tree.'
      : `Parent: ${this.parent}. Click the child link. A second click on the parent chooses the link behind it.`;
  }

  /** @returns stops listening */
  listen(): () => void {
    const {store} = this.editor;
    const ends = [
      store.listen('pick', ({detail}) => this.#picked(detail)),
      store.listen('selection', () => this.#selected()),
      store.listen('mode', () => {
        if (!this.active) this.parent = null;
        this.onChange();
      }),
    ];
    return () => ends.forEach((end) => end());
  }

  /** Begins with the first click, or gives up. */
  toggle() {
    const {store, notices, model} = this.editor;
    if (!this.active && (model?.links.length ?? 0) < 1) {
      notices.say('A joint connects two links: add them first.');
      return;
    }
    this.parent = null;
    // A click in the tree on the link that was selected selects it again, and so is noticed.
    if (!this.active) store.select([]);
    store.setMode(this.active ? 'select' : 'connect');
    this.onChange();
  }

  /** The world instead of a first click. */
  fromWorld() {
    if (!this.active) this.toggle();
    if (!this.active) return;
    this.parent = 'world';
    this.onChange();
  }

  stop() {
    if (this.active) this.editor.store.setMode('select');
  }

  /** The nearest link of the model that is not the parent. */
  #picked(under: {model: string, link: string}[]) {
    const {notices, model} = this.editor;
    if (!this.active || !model) return;
    const links = under.filter((one) => one.model === model.name && isLinkOf(model, `${model.name}::${one.link}`));
    const found = links.find(({link}) => link !== this.parent);
    if (found) this.choose(found.link);
    else if (!links.length) notices.say(`Click a link of ${model.name}.`);
  }

  #selected() {
    const {store, model} = this.editor;
    const [name] = store.selection;
    if (!this.active || !model || store.selection.length !== 1 || !isLinkOf(model, name)) return;
    this.choose(name.slice(model.name.length + 2));
  }

  /** A link of the model becomes the parent, then another the child. */
  async choose(link: string) {
    const {store, actions, model} = this.editor;
    if (!this.active || !model || link === this.parent) return;
    const name = `${model.name}::${link}`;
    if (this.parent === null) {
      this.parent = link;
      store.select([name]);
      this.onChange();
      return;
    }
    const op = connection(model.name, this.type, this.parent, link);
    store.setMode('select');
    const outcome = await actions.edit(op);
    if (outcome.ok) store.select([name]);
  }
}
