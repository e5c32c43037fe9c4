/**
 * The parameters of a model's plugin as fields: one for each element of its XML that holds only text.
 * Pure.
 */
import {parameterUnit} from './parameter_units.js';
import type {Field} from './property_fields.js';
import type {Model, PluginParameter} from '../protocol.js';

const ELEMENT = /<!--[^]*?-->|<!\[CDATA\[[^]*?\]\]>|<([\w.:-]+)(?:\s[^<>]*)?>([^<]*)<\/\1\s*>/g;
const ENTITIES: Record<string, string> = {'&': '&amp;', '<': '&lt;', '>': '&gt;'};
const CHARACTERS: Record<string, string> = {'&lt;': '<', '&gt;': '>', '&quot;': '"', '&apos;': "'",
    '&amp;': '&'};

function typed(text: string): {type: Field['type'], value: unknown} {
  if (/^(true|false)$/i.test(text)) return {type: 'flag', value: text.toLowerCase() === 'true'};
  if (text && Number.isFinite(Number(text))) return {type: 'number', value: Number(text)};
  return {type: 'text', value: text.replace(/&\w+;/g, (one) => CHARACTERS[one] ?? one)};
}

/**
 * @param index  of the plugin
 * @returns values and fields by path
 */
export function pluginFields(model: Model, index: number): {entity: Record<string, unknown>,
    fields: Field[]} {
  const {xml} = model.plugins[index];
  const entity: Record<string, unknown> = {};
  const fields: Field[] = [];
  for (const found of xml.matchAll(ELEMENT)) {
    const [whole, name, text] = found;
    if (!name) continue;
    const path = `parameter${fields.length}`;
    const {type, value} = typed(text.trim());
    const end = found.index + whole.lastIndexOf('</');
    entity[path] = value;
    fields.push({path, label: name, type, ...unitOf(name, type), ops: (next) => replaced(model, index, name,
        xml.slice(0, end - text.length) + escaped(next) + xml.slice(end))});
  }
  return {entity, fields};
}

/**
 * Fields for the parameters that the plugin has read and its XML leaves out. A change adds the element.
 * @param index  of the plugin
 * @returns defaults and fields by path
 */
export function defaultFields(model: Model, index: number, parameters: PluginParameter[]):
    {entity: Record<string, unknown>, fields: Field[]} {
  const {xml} = model.plugins[index];
  const shown = xml.replace(/<!--[^]*?-->/g, '');
  const entity: Record<string, unknown> = {};
  const fields: Field[] = [];
  for (const parameter of parameters) {
    const {name} = parameter;
    if (shown.includes(`<${name}>`) || shown.includes(`<${name} `) || shown.includes(`<${name}/`)) continue;
    const {field, value} = defaultField(parameter, (next) =>
      replaced(model, index, name, withElement(xml, `<${name}>${escaped(next)}</${name}>`)));
    entity[field.path] = value;
    fields.push(field);
  }
  return {entity, fields};
}

/**
 * The field of a parameter with its default value.
 * @param ops  what a change does
 */
export function defaultField({name, type, default: text, choices}: PluginParameter, ops: NonNullable<Field['ops']>):
    {field: Field, value: unknown} {
  const path = `default:${name.replaceAll('.', '_')}`;
  return {field: {path, label: name, type, ...unitOf(name, type), ...(choices.length ? {choices} : {}), ops},
    value: READ[type](text)};
}

/** The unit of a number, as a part of its field. */
function unitOf(name: string, type: Field['type']): {unit?: string} {
  const unit = type === 'number' ? parameterUnit(name) : undefined;
  return unit ? {unit} : {};
}

const READ: Record<PluginParameter['type'], (text: string) => unknown> =
    {number: Number, integer: Number, flag: (text) => text === 'true', text: String, choice: String};

const escaped = (value: unknown) => String(value).replace(/[&<>]/g, (one) => ENTITIES[one]);

/** The XML of a plugin with one more element at its end. */
function withElement(xml: string, element: string) {
  const end = xml.lastIndexOf('</');
  const [, name = ''] = /^\s*<([\w.:-]+)/.exec(xml) ?? [];
  if (end >= 0 && /\/\s*>\s*$/.exec(xml) === null) return `${xml.slice(0, end)}  ${element}\n${xml.slice(end)}`;
  return xml.replace(/\/\s*>\s*$/, `>\n  ${element.replaceAll('$', '$$$$')}\n</${name}>`);
}

function replaced(model: Model, index: number, name: string, changed: string) {
  const all = model.plugins.map((one, at) => (at === index ? changed : one.xml));
  return {label: `Set ${name} of ${model.name}`,
    ops: [{kind: 'set_plugins' as const, model: model.name, text: all.join('\n')}]};
}
