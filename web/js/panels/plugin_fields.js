/**
 * The parameters of a model's plugin as fields: one for each element of its XML that holds only text.
 * Pure.
 */
/** @import {Field} from './property_fields.js' */
/** @import {Model} from '../protocol.js' */

const ELEMENT = /<!--[^]*?-->|<!\[CDATA\[[^]*?\]\]>|<([\w.:-]+)(?:\s[^<>]*)?>([^<]*)<\/\1\s*>/g;
/** @type {Record<string, string>} */
const ENTITIES = {'&': '&amp;', '<': '&lt;', '>': '&gt;'};
/** @type {Record<string, string>} */
const CHARACTERS = {'&lt;': '<', '&gt;': '>', '&quot;': '"', '&apos;': "'", '&amp;': '&'};

/** @param {string} text @returns {{type: Field['type'], value: unknown}} */
function typed(text) {
  if (/^(true|false)$/i.test(text)) return {type: 'flag', value: text.toLowerCase() === 'true'};
  if (text && Number.isFinite(Number(text))) return {type: 'number', value: Number(text)};
  return {type: 'text', value: text.replace(/&\w+;/g, (one) => CHARACTERS[one] ?? one)};
}

/**
 * @param {Model} model
 * @param {number} index of the plugin
 * @returns {{entity: Record<string, unknown>, fields: Field[]}} values and fields by path
 */
export function pluginFields(model, index) {
  const {xml} = model.plugins[index];
  /** @type {Record<string, unknown>} */
  const entity = {};
  /** @type {Field[]} */
  const fields = [];
  for (const found of xml.matchAll(ELEMENT)) {
    const [whole, name, text] = found;
    if (!name) continue;
    const path = `parameter${fields.length}`;
    const {type, value} = typed(text.trim());
    const end = found.index + whole.lastIndexOf('</');
    entity[path] = value;
    fields.push({path, label: name, type, ops: (next) => {
      const written = String(next).replace(/[&<>]/g, (one) => ENTITIES[one]);
      const changed = xml.slice(0, end - text.length) + written + xml.slice(end);
      const all = model.plugins.map((one, at) => (at === index ? changed : one.xml));
      return {label: `Set ${name} of ${model.name}`,
        ops: [{kind: 'set_plugins', model: model.name, text: all.join('\n')}]};
    }});
  }
  return {entity, fields};
}
