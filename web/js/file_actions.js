/** Opening, saving, cloning and recovering worlds, and what the browser remembers of a view. */
/** @import {ActionParts, Outcome} from './actions.js' */

/** @param {ActionParts} parts */
export function fileActions({store, ask, dialog, note, view}) {
  const files = {
    /**
     * An empty world; asks first when there are unsaved changes and `discard` is not given.
     * @param {{discard?: boolean}} [options]
     */
    newWorld: (options) =>
      options || !store.history.dirty ? ask('new', options ?? {}) : dialog('newWorld'),
    /**
     * Opens a world; without a path asks which (a dialog).
     * @param {string} [path]
     * @param {{discard?: boolean}} [options]
     */
    open: (path, options = {}) =>
      path ? ask('open', {path, ...options}, {quiet: true}) : dialog('open'),
    /**
     * Saves to the file of the world; asks for a name the first time.
     * @returns {Promise<Outcome|void>}
     */
    async save() {
      if (store.modelEditing) return dialog('saveModel');
      if (!store.history.file) return files.saveAs();
      const outcome = await ask('save', {}, {quiet: true});
      // A world that was launched from a file is not written over without a word.
      if (outcome.issues.some(({code}) => code === 'path-needed')) return files.saveAs();
      outcome.issues.forEach((issue) => store.addIssue(issue));
      if (outcome.ok) note(`Saved ${outcome.value.path}${without(outcome.value.left_out)}`);
      return outcome;
    },
    /** @param {string} [path] @param {{overwrite?: boolean}} [options] */
    saveAs: (path, options = {}) =>
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
    /** @param {string} [path] */
    folders: (path) => ask('folders', path ? {path} : {}),
    /** @param {'restore'|'discard'} action */
    autosave: (action) => ask('autosave', {action}),

    /** What can be recovered. */
    recoverable: () => ask('autosave', {action: 'list'}, {quiet: true}),
    /** @param {string} name  of what can be recovered */
    recoverEntry: (name) => ask('autosave', {action: 'restore', name}, {quiet: true}),
    recover: () => dialog('recover'),
  };
  return files;
}

/**
 * What is said about models that a saved world does not hold.
 * @param {string[]} [names]
 */
function without(names = []) {
  return names.length ? ` without ${names.join(', ')}, which the launch file spawns` : '';
}
