/** Opening, saving, cloning and recovering worlds, and what the browser remembers of a view. */
import type {ActionParts, Outcome} from './actions.js';

export function fileActions({store, ask, dialog, note, view}: ActionParts) {
  /** Looks at a world once all of it has come: it may come in parts. */
  async function begun(asked: Promise<Outcome>) {
    const outcome = await asked;
    if (outcome.ok) view()?.rig.resetForNewWorld();
    return outcome;
  }

  const files = {
    /** An empty world; asks first when there are unsaved changes and `discard` is not given. */
    async newWorld(options?: {discard?: boolean}): Promise<Outcome|void> {
      if (!options && store.history.dirty) return dialog('newWorld');
      return begun(ask('new', options ?? {}));
    },
    /** Opens a world; without a path asks which (a dialog). */
    open: (path?: string, options: {discard?: boolean} = {}) =>
      path ? begun(ask('open', {path, ...options}, {quiet: true})) : dialog('open'),
    /** Saves to the file of the world; asks for a name the first time. */
    async save(): Promise<Outcome|void> {
      if (store.modelEditing) return dialog('saveModel');
      if (!store.history.file) return files.saveAs();
      const outcome = await ask('save', {}, {quiet: true});
      // A world that was launched from a file is not written over without a word.
      if (outcome.issues.some(({code}) => code === 'path-needed')) return files.saveAs();
      outcome.issues.forEach((issue) => store.addIssue(issue));
      if (outcome.ok) note(`Saved ${outcome.value.path}${without(outcome.value.left_out)}`);
      return outcome;
    },
    saveAs: (path?: string, options: {overwrite?: boolean} = {}) =>
      path ? ask('save', {path, ...options}, {quiet: true}) : dialog('saveAs'),
    /** A copy of the world as it is now, for another simulator. */
    cloneWorld: () => dialog('cloneWorld'),
    /** Remembers the camera and what is shown, for this browser's next visits. */
    saveConfiguration() {
      view()?.saveConfiguration();
      note('Saved the camera and the View menu\'s choices for this browser.');
    },
    /** Forgets them. */
    resetConfiguration() {
      view()?.resetConfiguration();
      note('The next world opens with the default camera and View menu.');
    },
    folders: (path?: string) => ask('folders', path ? {path} : {}),
    autosave: (action: 'restore'|'discard') => ask('autosave', {action}),

    /** What can be recovered. */
    recoverable: () => ask('autosave', {action: 'list'}, {quiet: true}),
    /** @param name  of what can be recovered */
    recoverEntry: (name: string) => ask('autosave', {action: 'restore', name}, {quiet: true}),
    recover: () => dialog('recover'),
  };
  return files;
}

/** What is said about models that a saved world does not hold. */
function without(names: string[] = []) {
  return names.length ? ` without ${names.join(', ')}, which the launch file spawns` : '';
}
