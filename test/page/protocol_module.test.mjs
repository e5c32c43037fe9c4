import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';
import {moduleOf, typeOf} from '../../tools/protocol_module.mjs';
import * as made from '../../web/js/protocol.js';
import {protocol} from './protocol.mjs';

test('web/js/protocol.ts is what tools/protocol_module.mjs makes of web/protocol.json', () => {
  const text = readFileSync(new URL('../../web/js/protocol.ts', import.meta.url), 'utf8');
  assert.equal(text, moduleOf(protocol), 'run tools/protocol_module.mjs');
});

test('the numbers of the page are those of the protocol', () => {
  assert.equal(made.PROTOCOL_VERSION, protocol.version);
  assert.deepEqual({...made.LIMITS}, protocol.limits);
  assert.deepEqual({...made.FRAME_KINDS}, protocol.frames.kinds);
  assert.equal(made.FRAME_HEAD_BYTES, protocol.frames.head_bytes);
  assert.equal(made.FRAME_RECORD_BYTES, protocol.frames.record_bytes);
  assert.deepEqual(Object.keys(made.FRAME_HEAD), protocol.frames.head.map(([name]) => name));
  assert.deepEqual(Object.keys(made.FRAME_RECORD), protocol.frames.record.map(([name]) => name));
});

test('offsets follow each other without gaps', () => {
  const bytes = {u32: 4, u64: 8, f64: 8, f32: 4};
  for (const [fields, offsets, end] of [
    [protocol.frames.head, made.FRAME_HEAD, made.FRAME_HEAD_BYTES],
    [protocol.frames.record, made.FRAME_RECORD, made.FRAME_RECORD_BYTES]]) {
    let at = 0;
    for (const [name, kind] of fields) {
      assert.equal(offsets[name], at, name);
      at += bytes[kind];
    }
    assert.equal(at, end);
  }
});

for (const [expression, expected] of [
  ['integer', 'number'], ['any', 'unknown'], ['vec3?', 'vec3|null'], ['Link[]', 'Link[]'],
  ['vec2[][]', 'vec2[][]'], ['number[7]', 'number[]'], ['{Model?}?', 'Record<string, Model|null>|null'],
  ["'a'|'b'", "'a'|'b'"], ['some Light', 'Partial<Light>'], ['Box|Empty', 'Box|Empty'],
]) {
  test(`a type of the protocol as the page's: ${expression}`, () => {
    assert.equal(typeOf(expression), expected);
  });
}
