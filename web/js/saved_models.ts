/** Dialogs that save models as folders: fields for version and author, and the question before a folder is replaced. */
import {hasIssue} from './connection.js';
import {ask, faultText, labelled} from './ui/dialog.js';
import {h} from './ui/dom.js';
import type {BuildingAbout} from './protocol.js';

const FIELDS = [['version', 'Version'], ['description', 'Description'], ['author', 'Author'], ['email', 'E-mail']] as const;

export const NO_AUTHOR: BuildingAbout = {version: '1.0', description: '', author: '', email: ''};

/** Fields for what `model.config` says of a model, under "Advanced". */
export function aboutFields(about: BuildingAbout) {
  const inputs = FIELDS.map(([key]) => h('input', {value: about[key]}));
  return {
    element: h('details', {}, h('summary', {text: 'Advanced'}), ...FIELDS.map(([, label], at) => labelled(label, inputs[at]))),
    values: () => Object.fromEntries(FIELDS.map(([key], at) => [key, inputs[at].value])) as BuildingAbout,
  };
}

/**
 * Sends a request that saves a model; if the model exists, asks and sends it again.
 * @returns false if the user does not want to replace the model
 */
export async function askToReplace<T>(request: (overwrite: boolean) => Promise<T>): Promise<T|false> {
  try {
    return await request(false);
  } catch (fault) {
    if (!hasIssue(fault, 'exists')) throw fault;
    const answer = await ask('Replace the model?', `${faultText(fault)}.`,
      [{title: 'Cancel'}, {title: 'Replace', value: true, danger: true}]);
    return answer ? request(true) : false;
  }
}
