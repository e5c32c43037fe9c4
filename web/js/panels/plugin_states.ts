/** Whether a plugin runs, as the tree and the property panel show it. */
import {h} from '../ui/dom.js';
import {defaultFields, pluginOwner} from './plugin_fields.js';
import {sensorPlugin, stateSection} from './sensor_fields.js';
import type {PluginOwner} from './plugin_fields.js';
import type {PluginState, Sensor, World} from '../protocol.js';
import type {Found} from './property_sections.js';
import type {Row} from './world_rows.js';
import type {Section} from './property_fields.js';

/** The state of the plugin of a row; undefined before the simulator has sent it. */
export function pluginState({document, pluginStates}: {document: World|null,
    pluginStates: PluginState[]}, {model = '', index = -1}: Row): PluginState|undefined {
  const plugin = pluginOwner(document, model)?.plugins[index];
  return plugin && pluginStates.find((one) =>
    one.model === model && one.name === plugin.name && one.filename === plugin.filename);
}

/** The sensor of a row, and the state of its plugin; undefined without one. */
function sensorOf({document, pluginStates}: {document: World|null, pluginStates: PluginState[]},
    {model = '', owner, name}: Row): {sensor: Sensor, state: PluginState}|undefined {
  const found = document?.models.find((one) => one.name === model);
  const holder = found && [...found.links, ...found.joints].find((one) => one.name === owner);
  const sensor = holder?.sensors?.find((one) => one.name === name);
  const state = sensor && pluginStates.find((one) => one.model === model &&
    sensor.parameters.some(({path}) => path.startsWith(`plugin:${one.name}/`)));
  return sensor && state && {sensor, state};
}

/** The state of the plugin of a sensor's row; undefined without one. */
export const sensorState = (store: {document: World|null, pluginStates: PluginState[]}, row: Row) =>
  sensorOf(store, row)?.state;

/** The sections of a sensor with those of its plugin at the end. */
export function withSensorState(found: Found, store: {document: World|null, pluginStates: PluginState[]},
    row: Row): Found {
  const {sensor, state} = sensorOf(store, row) ?? {};
  if (!sensor || !state) return found;
  const target = `${row.model}::${row.owner}::sensor:${sensor.name}`;
  return {...found, sections: [...found.sections, ...sensorPlugin(sensor, state, target)]};
}

/** A tag at the end of a row, red where something failed. */
export const stateTag = (text: string, reason: string) =>
  h('span', {class: text.endsWith('failed') ? 'tag failed' : 'tag', text, title: reason});

/**
 * The sections of a plugin, with its state after its name, and the defaults of what its XML leaves out.
 * @param owner  of the plugin
 */
export function withState({title, sections}: Found, state: PluginState, owner: PluginOwner,
    index: number): Found {
  const [first, ...others] = sections;
  const made: Section[] = [first, stateSection(state), ...others];
  const left = defaultFields(owner, index, state.parameters);
  if (left.fields.length) {
    made.splice(-1, 0, {key: 'defaults', title: 'Parameters with default values', target: '', ...left});
  }
  return {title, sections: made};
}
