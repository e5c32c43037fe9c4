#!/usr/bin/env node
/**
 * Writes web/js/protocol.ts, the page's side of web/protocol.json: the numbers that the page needs
 * and a type for everything that is sent. Run it after an edit of the protocol; a test
 * compares the file with what this makes.
 */
import {readFileSync, writeFileSync} from 'node:fs';
import {fileURLToPath} from 'node:url';

const SOURCE = new URL('../web/protocol.json', import.meta.url);
const TARGET = new URL('../web/js/protocol.ts', import.meta.url);

const BASIC = {
  string: 'string', number: 'number', integer: 'number', boolean: 'boolean',
  object: 'Record<string, unknown>', any: 'unknown',
};
const BYTES = {u32: 4, u64: 8, f64: 8, f32: 4};
const WIDEST = 98;

/** A type expression of the protocol in TypeScript's. */
export function typeOf(expression) {
  if (expression.endsWith('?')) return `${typeOf(expression.slice(0, -1))}|null`;
  if (expression.startsWith("'")) return expression;
  const list = /^(.*)\[\d*\]$/s.exec(expression);
  if (list) return `${typeOf(list[1])}[]`;
  if (expression.startsWith('{')) return `Record<string, ${typeOf(expression.slice(1, -1))}>`;
  if (expression.startsWith('some ')) return `Partial<${typeOf(expression.slice(5))}>`;
  if (expression.includes('|')) return expression.split('|').map(typeOf).join('|');
  return BASIC[expression] ?? expression;
}

/** An object type; what may be absent is optional. */
function objectOf(fields, indent = '  ') {
  const members = Object.entries(fields).map(([name, expression]) =>
    `${name}${expression.endsWith('?') ? '?' : ''}: ${typeOf(expression)}`);
  return wrapped(members, ', ', indent, '{}');
}

/** Members in one short line, or in lines of their own that are filled. */
function wrapped(members, separator, indent, [open = '', close = ''] = '') {
  const one = `${open}${members.join(separator)}${close}`;
  if (one.length < 60) return one;
  const lines = [''];
  for (const member of members) {
    const last = lines[lines.length - 1];
    const longer = last ? `${last}${separator}${member}` : member;
    if (last && indent.length + longer.length + separator.length > WIDEST) lines.push(member);
    else lines[lines.length - 1] = longer;
  }
  // TypeScript reads no union that begins or ends with a line break.
  if (!open) return lines.join(`${separator}\n${indent}`);
  const outer = indent.slice(0, -2);
  return `${open}\n${indent}${lines.join(`${separator.trimEnd()}\n${indent}`)}\n${outer}${close}`;
}

const typedef = (name, type) => `export type ${name} = ${type};`;

/** Where each field of a head or a record begins: {kind: 0, revision: 4, …}. */
function offsetsOf(fields) {
  let at = 0;
  return Object.fromEntries(fields.map(([name, kind]) => {
    const start = at;
    at += BYTES[kind];
    return [name, start];
  }));
}

function constant(about, name, value) {
  const text = typeof value === 'object' ? `Object.freeze(${wrapped(
    Object.entries(value).map(([key, number]) => `${key}: ${number}`), ', ', '  ', '{}')})` : value;
  return `${about ? `/** ${about} */\n` : ''}export const ${name} = ${text};`;
}

/** The text of web/js/protocol.ts for a protocol. */
export function moduleOf(protocol) {
  const {version, limits, types, operations, requests, notices, pushes, frames} = protocol;
  const named = Object.entries(types).map(([name, type]) => typedef(name,
    typeof type === 'string' ? wrapped(typeOf(type).split('|'), '|', '  ') : objectOf(type)));
  const map = (entries, of) => `{\n${Object.entries(entries).map(([name, entry]) =>
    `  ${name}: ${of(entry)}`).join(',\n')},\n}`;
  const fieldsOf = (fields) => objectOf(fields, '    ');
  const union = (name, entries, tag) => typedef(name,
    `{[Name in keyof ${entries}]: {${tag}: Name} & ${entries}[Name]}[keyof ${entries}]`);
  const replyOf = ({fields, reply}) => `{fields: ${objectOf(fields, '      ')},\n    reply: ${
    typeof reply === 'string' ? typeOf(reply) : objectOf(reply, '      ')}}`;
  const text = `${[
    '/**\n * The messages between page and simulator. Written by tools/protocol_module.mjs from\n' +
    ' * web/protocol.json: edit that file, not this one.\n */',
    constant('Grows when page and server no longer understand each other.', 'PROTOCOL_VERSION',
      version),
    constant('Sizes in bytes, rates in Hz.', 'LIMITS', limits),
    constant('The kinds of binary frames.', 'FRAME_KINDS', frames.kinds),
    constant("Offsets of the fields of a frame's head, in bytes; little endian.",
      'FRAME_HEAD', offsetsOf(frames.head)),
    constant('', 'FRAME_HEAD_BYTES', frames.head_bytes),
    constant("Offsets of the fields of a link's record, in bytes.", 'FRAME_RECORD',
      offsetsOf(frames.record)),
    constant('', 'FRAME_RECORD_BYTES', frames.record_bytes),
    ...named,
    typedef('Operations', map(operations, fieldsOf)),
    union('Operation', 'Operations', 'kind'),
    typedef('Pushes', map(pushes, fieldsOf)), union('Push', 'Pushes', 'type'),
    typedef('Requests', map(requests, replyOf)),
    typedef('Notices', map(notices, fieldsOf)),
  ].join('\n\n')}\n`;
  // Types of one line follow each other without empty lines.
  return text.replace(/^(export type .*;\n)\n(?=export type .*;$)/gm, '$1');
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  writeFileSync(TARGET, moduleOf(JSON.parse(readFileSync(SOURCE, 'utf8'))));
}
