/** The parameters of a sensor as fields, in a section for each of its elements. Pure. */
/** @import {Field, Section} from './property_fields.js' */
/** @import {Sensor} from '../protocol.js' */

/** @type {Record<string, string>} */
const UNITS = {
  min_angle: 'rad', max_angle: 'rad', horizontal_fov: 'rad', cutoff_angle: 'rad', near: 'm', far: 'm',
  'range/min': 'm', 'range/max': 'm', 'range/resolution': 'm', update_rate: 'Hz', width: 'pixels', height: 'pixels',
};
/** @type {Record<string, string[]>} */
const CHOICES = {'noise/@type': ['none', 'gaussian', 'gaussian_quantized']};

/** Of what a table says for the last element of a path, or the last two. @template T @param {Record<string, T>} table @param {string[]} parts */
const known = (table, parts) => table[parts.slice(-2).join('/')] ?? table[parts.at(-1) ?? ''];

/** @param {string} text */
const words = (text) => text.replace(/^@/, '').replaceAll('_', ' ');

/** `Camera clip` of `camera:0/clip/near`; '' of what is not in an element. @param {string[]} parts */
function titleOf(parts) {
  const title = parts.slice(0, -1).map((part) => part.replace(/^plugin:/, 'plugin ').replace(/:0$/, '').replace(':', ' '));
  return words(title.join(' ')).replace(/^./, (letter) => letter.toUpperCase());
}

/**
 * @param {Sensor} sensor
 * @param {string} target  `MODEL::LINK::sensor:NAME`
 * @returns {Section[]}
 */
export function sensorSections(sensor, target) {
  /** @type {Map<string, Section & {entity: Record<string, unknown>}>} */
  const sections = new Map();
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
      path: field, label: words(parts.at(-1) ?? ''), type: choices ? 'choice' : kind, unit: known(UNITS, parts),
      ...(choices ? {choices} : {}),
      ...(kind === 'vector' && Array.isArray(value) ? {parts: ['x', 'y', 'z'].slice(0, value.length)} : {}),
      ...(kind === 'pose' ? {unit: 'm, rad'} : {}),
      ops: (next) => ({label: `Set ${words(parts.at(-1) ?? '')} of ${sensor.name}`,
        ops: [{kind: 'set', target, path, value: next}]}),
    });
  });
  return [...sections.values()];
}

/** Kinds of sensors that can be added to a link. */
const NEW = /** @type {const} */ ([['camera', 'camera'], ['laser', 'laser scanner'], ['imu', 'IMU']]);

/**
 * Buttons that give a link a sensor with a plugin that publishes its data.
 * @param {string} target  `MODEL::LINK`
 * @returns {Section}
 */
export function newSensors(target) {
  return {
    key: `${target}|Sensors`, title: 'Sensors', target,
    entity: Object.fromEntries(NEW.map(([kind]) => [`sensor_${kind}`, null])),
    fields: NEW.map(([kind, word]) => /** @type {Field} */ ({
      path: `sensor_${kind}`, label: `Add ${word}`, type: 'button',
      ops: () => ({label: `Add ${word} to ${target}`, ops: [{kind: 'add_sensor', link: target, sensor: kind}]}),
    })),
  };
}

/** A button that removes a sensor. @param {Sensor} sensor @param {string} target @returns {Section} */
export function removal(sensor, target) {
  return {key: `${target}|Remove`, title: '', target, entity: {type: sensor.type, remove: null}, fields: [
    {path: 'type', label: 'type', type: 'text', fixed: true},
    {path: 'remove', label: 'Remove sensor', type: 'button',
      ops: () => ({label: `Remove ${sensor.name}`, ops: [{kind: 'remove_part', target}]})},
  ]};
}
