/** Whether a plugin runs, as the tree and the property panel show it. */
import {h} from './dom.js';
/** @import {PluginState, World} from '../protocol.js' */
/** @import {Found} from './property_sections.js' */
/** @import {Row} from './world_rows.js' */

/**
 * The state of the plugin of a row; undefined before the simulator has sent it.
 * @param {{document: World|null, pluginStates: PluginState[]}} store
 * @param {Row} row
 * @returns {PluginState|undefined}
 */
export function pluginState({document, pluginStates}, {model = '', index = -1}) {
  const owner = model ? document?.models.find(({name}) => name === model) : document;
  const plugin = owner?.plugins[index];
  return plugin && pluginStates.find((one) =>
    one.model === model && one.name === plugin.name && one.filename === plugin.filename);
}

/**
 * The state of the plugin of a sensor's row; undefined without one.
 * @param {{document: World|null, pluginStates: PluginState[]}} store
 * @param {Row} row
 * @returns {PluginState|undefined}
 */
export function sensorState({document, pluginStates}, {model = '', owner, name}) {
  const found = document?.models.find((one) => one.name === model);
  const holder = found && [...found.links, ...found.joints].find((one) => one.name === owner);
  const sensor = holder?.sensors?.find((one) => one.name === name);
  return sensor && pluginStates.find((state) => state.model === model &&
    sensor.parameters.some(({path}) => path.startsWith(`plugin:${state.name}/`)));
}

/**
 * A tag at the end of a row, red where something failed.
 * @param {string} text
 * @param {string} reason
 */
export const stateTag = (text, reason) =>
  h('span', {class: text.endsWith('failed') ? 'tag failed' : 'tag', text, title: reason});

/**
 * The sections of a plugin, with its state after its name.
 * @param {Found} found
 * @param {PluginState} state
 * @returns {Found}
 */
export function withState({title, sections}, state) {
  const [first, ...others] = sections;
  /** @type {import('./property_fields.js').Field[]} */
  const fields = [{path: 'state', label: 'state', type: 'text', fixed: true}];
  if (state.reason) fields.push({path: 'reason', label: 'reason', type: 'xml', fixed: true});
  return {title, sections: [first, {key: 'state', title: '', target: '', entity: state, fields}, ...others]};
}
