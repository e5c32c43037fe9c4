/** A joint by two clicks: the parent link, then the child link. */
import {connection, isLinkOf} from './model_edits.js';
/** @import {ModelEditor} from './model_editor.js' */

export class ConnectTool {
  type = 'revolute';
  /** The link that was clicked first, or "world". @type {string|null} */
  parent = null;
  /** Called when what is to be clicked next has changed. */
  onChange = () => {};

  /** @param {ModelEditor} editor */
  constructor(editor) {
    this.editor = editor;
  }

  get active() { return this.editor.store.mode === 'connect'; }

  /** What the user is asked for; '' when nothing. */
  get hint() {
    if (!this.active) return '';
    return this.parent === null ? 'Click the parent link.' : `Parent: ${this.parent}. Click the child link.`;
  }

  /** @returns {() => void} stops listening */
  listen() {
    const {store} = this.editor;
    const ends = [
      store.listen('pick', ({detail}) => this.#picked(detail.model, detail.link)),
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

  /** @param {string} owner @param {string} link */
  async #picked(owner, link) {
    const {store, actions, notices, model} = this.editor;
    if (!this.active || !model) return;
    if (owner !== model.name || !isLinkOf(model, `${owner}::${link}`)) {
      notices.say(`Click a link of ${model.name}.`);
      return;
    }
    if (this.parent === null) {
      this.parent = link;
      store.select([`${owner}::${link}`]);
      this.onChange();
      return;
    }
    if (this.parent === link) return;
    const op = connection(owner, this.type, this.parent, link);
    store.setMode('select');
    const outcome = await actions.edit(op);
    if (outcome.ok) store.select([`${owner}::${link}`]);
  }
}
