/** The parameters of a sensor as fields, in a section for each of its elements. Pure. */
import {parameterUnit} from './parameter_units.js';
import type {Field, Section} from './property_fields.js';
import {defaultField} from './plugin_fields.js';
import type {PluginState, Sensor} from '../protocol.js';

const UNITS: Record<string, string> = {
  min_angle: 'rad', max_angle: 'rad', horizontal_fov: 'rad', cutoff_angle: 'rad', near: 'm', far: 'm',
  'range/min': 'm', 'range/max': 'm', 'range/resolution': 'm', update_rate: 'Hz', width: 'pixels', height: 'pixels',
};
const CHOICES: Record<string, string[]> = {'noise/@type': ['none', 'gaussian', 'gaussian_quantized']};

/** Of what a table says for the last element of a path, or the last two. */
const known = <T>(table: Record<string, T>, parts: string[]) =>
    table[parts.slice(-2).join('/')] ?? table[parts.at(-1) ?? ''];

const words = (text: string) => text.replace(/^@/, '').replaceAll('_', ' ');

/** `Camera clip` of `camera:0/clip/near`; '' of what is not in an element. */
function titleOf(parts: string[]) {
  const title = parts.slice(0, -1).map((part) => part.replace(/^plugin:/, 'plugin ').replace(/:0$/, '').replace(':', ' '));
  return words(title.join(' ')).replace(/^./, (letter) => letter.toUpperCase());
}

/** @param target  `MODEL::LINK::sensor:NAME` */
export function sensorSections(sensor: Sensor, target: string): Section[] {
  const sections: Map<string, Section & {entity: Record<string, unknown>}> = new Map();
  sensor.parameters.forEach(({path, kind, value}, index) => {
    const parts = path.split('/');
    const title = titleOf(parts);
    const key = `${target}|${title}`;
    const section = sections.get(title) ?? {key, title, target, entity: {}, fields: []};
    sections.set(title, section);
    const field = `parameter${index}`;
    section.entity[field] = value;
    const choices = known(CHOICES, parts);
    section.fields.push({
      path: field, label: words(parts.at(-1) ?? ''), type: choices ? 'choice' : kind, unit: known(UNITS, parts) ?? (kind === 'number' ? parameterUnit(parts.at(-1) ?? '') : undefined),
      ...(choices ? {choices} : {}),
      ...(kind === 'vector' && Array.isArray(value) ? {parts: ['x', 'y', 'z'].slice(0, value.length)} : {}),
      ...(kind === 'pose' ? {unit: 'm, rad'} : {}),
      ops: (next) => ({label: `Set ${words(parts.at(-1) ?? '')} of ${sensor.name}`,
        ops: [{kind: 'set', target, path, value: next}]}),
    });
  });
  return [...sections.values()];
}

/**
 * The state of the plugin of a sensor, and fields for the parameters that it has read and its XML leaves
 * out. A change adds the element.
 * @param target  `MODEL::LINK::sensor:NAME`
 */
export function sensorPlugin(sensor: Sensor, state: PluginState, target: string): Section[] {
  const left = state.parameters.filter(({name}) =>
    !sensor.parameters.some(({path}) => path === `plugin:${state.name}/${name}`));
  const made = left.map((parameter) => defaultField(parameter, (next) => ({
    label: `Set ${parameter.name} of ${sensor.name}`,
    ops: [{kind: 'set', target, path: `plugin:${state.name}/${parameter.name}`, value: String(next)}]})));
  const title = `Plugin ${state.name}`;
  return [stateSection(state, `${title}: state`), {
    key: `${target}|defaults`, title: `${title}: parameters with default values`, target,
    entity: Object.fromEntries(made.map(({field, value}) => [field.path, value])),
    fields: made.map(({field}) => field)}].filter(({fields}) => fields.length);
}

/** Whether a plugin runs, and why not. */
export function stateSection(state: PluginState, title = ''): Section {
  const fields: Field[] = [{path: 'state', label: 'state', type: 'text', fixed: true}];
  if (state.reason) fields.push({path: 'reason', label: 'reason', type: 'xml', fixed: true});
  return {key: 'state', title, target: '', entity: state, fields};
}

/** Kinds of sensors that can be added to a link. */
const NEW = [['camera', 'camera'], ['laser', 'laser scanner'], ['imu', 'IMU']] as const;

/**
 * Buttons that give a link a sensor with a plugin that publishes its data.
 * @param target  `MODEL::LINK`
 */
export function newSensors(target: string): Section {
  return {
    key: `${target}|Sensors`, title: 'Sensors', target,
    entity: Object.fromEntries(NEW.map(([kind]) => [`sensor_${kind}`, null])),
    fields: NEW.map(([kind, word]) => ({
      path: `sensor_${kind}`, label: `Add ${word}`, type: 'button',
      ops: () => ({label: `Add ${word} to ${target}`, ops: [{kind: 'add_sensor', link: target, sensor: kind}]}),
    } as Field)),
  };
}

/** A button that removes a sensor. */
export function removal(sensor: Sensor, target: string): Section {
  return {key: `${target}|Remove`, title: '', target, entity: {type: sensor.type, remove: null}, fields: [
    {path: 'type', label: 'type', type: 'text', fixed: true},
    {path: 'remove', label: 'Remove sensor', type: 'button',
      ops: () => ({label: `Remove ${sensor.name}`, ops: [{kind: 'remove_part', target}]})},
  ]};
}
