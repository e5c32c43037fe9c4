/**
 * The parameters of a plugin as fields: one for each element of its XML that holds only text. Pure.
 */
import {freeName} from '../scoped_names.js';
import {parameterUnit} from './parameter_units.js';
import type {Field} from './property_fields.js';
import type {Plugin, PluginParameter, World} from '../protocol.js';

/** What has plugins: a model, or the world under the name ''. */
export type PluginOwner = {name: string, plugins: Plugin[]};

/** The owner of a plugin's row; undefined for a model that has gone. */
export const pluginOwner = (world: World|null, model: string): PluginOwner|undefined =>
  (model ? world?.models.find(({name}) => name === model)
    : world ? {name: '', plugins: world.plugins} : undefined);

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
export function pluginFields(owner: PluginOwner, index: number): {entity: Record<string, unknown>,
    fields: Field[]} {
  const {xml} = owner.plugins[index];
  const entity: Record<string, unknown> = {};
  const fields: Field[] = [];
  for (const found of xml.matchAll(ELEMENT)) {
    const [whole, name, text] = found;
    if (!name) continue;
    const path = `parameter${fields.length}`;
    const {type, value} = typed(text.trim());
    const end = found.index + whole.lastIndexOf('</');
    entity[path] = value;
    fields.push({path, label: name, type, ...unitOf(name, type), ops: (next) => replaced(owner, index, name,
        xml.slice(0, end - text.length) + escaped(next) + xml.slice(end))});
  }
  return {entity, fields};
}

/**
 * Fields for the parameters that the plugin has read and its XML leaves out. A change adds the element.
 * @param index  of the plugin
 * @returns defaults and fields by path
 */
export function defaultFields(owner: PluginOwner, index: number, parameters: PluginParameter[]):
    {entity: Record<string, unknown>, fields: Field[]} {
  const {xml} = owner.plugins[index];
  const shown = xml.replace(/<!--[^]*?-->/g, '');
  const entity: Record<string, unknown> = {};
  const fields: Field[] = [];
  for (const parameter of parameters) {
    const {name} = parameter;
    if (shown.includes(`<${name}>`) || shown.includes(`<${name} `) || shown.includes(`<${name}/`)) continue;
    const {field, value} = defaultField(parameter, (next) =>
      replaced(owner, index, name, withElement(xml, `<${name}>${escaped(next)}</${name}>`)));
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

/**
 * The XML of a plugin as text that can be edited.
 * @param index  of the plugin
 */
export const sourceField = (owner: PluginOwner, index: number): Field => ({path: 'xml', label: 'XML', type: 'xml',
  hint: 'Ctrl+Enter or a click elsewhere commits it, Escape discards it',
  ops: (text) => replaced(owner, index, 'XML', String(text))});

/** A button that removes a plugin. */
export const removalField = (owner: PluginOwner, index: number): Field => ({path: 'remove', label: 'Remove plugin', type: 'button',
  ops: () => {
    const {name, filename} = owner.plugins[index];
    return {label: `Remove plugin ${name || filename}`, ops: setPlugins(owner, owner.plugins.flatMap(({xml}, at) =>
      (at === index ? [] : [xml])))};
  }});

/** Plugins that have a use in every world: words, library, and the elements that each requires. */
const KNOWN = [
  ['wind', 'libWindPlugin.so', '<force_approximation_scaling_factor>1</force_approximation_scaling_factor>'],
  ['link attacher', 'libgazebo_ros_link_attacher.so', ''],
];

/** Buttons for plugins that a world can get, and a field for the library of any other. */
export function newPluginFields(owner: PluginOwner): {entity: Record<string, unknown>, fields: Field[]} {
  const added = (library: string, inside = '') => {
    const name = freeName(library.replace(/^lib/, '').replace(/\.so$/, ''),
      (one) => owner.plugins.some((plugin) => plugin.name === one));
    const xml = `<plugin name="${escaped(name).replaceAll('"', '&quot;')}" filename="${escaped(library).replaceAll('"', '&quot;')}"${inside ? `>
  ${inside}
</plugin>` : '/>'}`;
    return {label: `Add plugin ${name}`, ops: setPlugins(owner, [...owner.plugins.map((one) => one.xml), xml])};
  };
  const fields: Field[] = KNOWN.map(([word, library, inside]) => ({path: `add_${word.replaceAll(' ', '_')}`, label: `Add ${word} plugin`,
    type: 'button', hint: library, ops: () => added(library, inside)}));
  fields.push({path: 'add', label: 'add library', type: 'text', hint: 'file name of a plugin, for example libWindPlugin.so',
    ops: (library) => added(String(library).trim())});
  return {entity: Object.fromEntries(fields.map(({path}) => [path, null])), fields};
}

const setPlugins = (owner: PluginOwner, all: string[]) =>
  [{kind: 'set_plugins' as const, model: owner.name, text: all.join('\n')}];

function replaced(owner: PluginOwner, index: number, name: string, changed: string) {
  return {label: `Set ${name} of ${owner.name || owner.plugins[index].name || 'a plugin of the world'}`,
    ops: setPlugins(owner, owner.plugins.map((one, at) => (at === index ? changed : one.xml)))};
}
