/**
 * The parameters of a model's plugin as fields: one for each element of its XML that holds only text.
 * Pure.
 */
import type {Field} from './property_fields.js';
import type {Model} from '../protocol.js';

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
