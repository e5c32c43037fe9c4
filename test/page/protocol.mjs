/** Checks values against web/protocol.json, whose first lines say how its types are written. */
import {readFileSync} from 'node:fs';

export const protocol = JSON.parse(readFileSync(new URL('../../web/protocol.json',
  import.meta.url)));

const BASIC = {
  string: (value) => typeof value === 'string',
  number: (value) => Number.isFinite(value),
  integer: (value) => Number.isInteger(value),
  boolean: (value) => typeof value === 'boolean',
  object: (value) => value !== null && typeof value === 'object' && !Array.isArray(value),
  any: () => true,
};

/** The fault of a value as a text, or null. @param {string|object} type */
export function fault(type, value, where = 'value') {
  if (typeof type === 'object') return faultOfFields(type, value, where);
  if (type.endsWith('?')) {
    return value === null || value === undefined ? null : fault(type.slice(0, -1), value, where);
  }
  if (type.includes('|') && type.startsWith("'") || /^'[^']*'$/.test(type)) {
    return type.split('|').some((word) => word === `'${value}'`) ? null
      : `${where}: ${value} is not of ${type}`;
  }
  const list = /^(.*)\[(\d*)\]$/.exec(type);
  if (list) return faultOfList(list[1], list[2], value, where);
  if (type.startsWith('{')) return faultOfMap(type.slice(1, -1), value, where);
  if (type.startsWith('some ')) return faultOfFields(some(type.slice(5)), value, where);
  if (type.includes('|')) return fault(alternative(type.split('|'), value), value, where);
  if (type === 'Operation') return operationFault(value, where);
  if (BASIC[type]) return BASIC[type](value) ? null : `${where}: ${value} is no ${type}`;
  if (!(type in protocol.types)) throw new Error(`the protocol has no type ${type}`);
  return fault(protocol.types[type], value, where);
}

/** The fields of a type, all of which may be left out. */
function some(type) {
  return Object.fromEntries(Object.entries(protocol.types[type])
    .map(([name, of]) => [name, `${of.replace(/\?$/, '')}?`]));
}

/** Of several types of objects the one that the value's `type` tells, else the first. */
function alternative(types, value) {
  return types.find((name) => protocol.types[name]?.type === `'${value?.type}'`) ?? types[0];
}

function faultOfFields(fields, value, where) {
  if (!BASIC.object(value)) return `${where}: ${value} is no object`;
  for (const name of Object.keys(value)) {
    if (!(name in fields)) return `${where}.${name}: unknown`;
  }
  for (const [name, type] of Object.entries(fields)) {
    const problem = fault(type, value[name], `${where}.${name}`);
    if (problem) return problem;
  }
  return null;
}

function faultOfList(type, count, value, where) {
  if (!Array.isArray(value)) return `${where}: ${value} is no list`;
  if (count && value.length !== Number(count)) {
    return `${where}: ${value.length} in place of ${count}`;
  }
  for (const [index, item] of value.entries()) {
    const problem = fault(type, item, `${where}[${index}]`);
    if (problem) return problem;
  }
  return null;
}

function faultOfMap(type, value, where) {
  if (!BASIC.object(value)) return `${where}: ${value} is no object`;
  for (const [name, item] of Object.entries(value)) {
    const problem = fault(type, item, `${where}.${name}`);
    if (problem) return problem;
  }
  return null;
}

/** The fault of what a page sends as an answered request, or null. */
export function requestFault(type, fields) {
  const request = protocol.requests[type];
  if (!request) return `no request ${type}`;
  return fault(request.fields, fields, type);
}

function operationFault({kind, ...fields}, where) {
  const operation = protocol.operations[kind];
  if (!operation) return `${where}: no operation ${kind}`;
  return fault(operation, fields, `${where}.${kind}`);
}
