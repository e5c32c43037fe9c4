import assert from 'node:assert/strict';
import test from 'node:test';
import {rpyOf, sevenOf, sixOf} from '../../web/js/panels/pose_rpy.js';
import {
  bytesText,
  clockText,
  colorOf,
  colorText,
  numberText,
  parseNumber,
} from '../../web/js/ui/text_format.js';

test('sim time is written as days, hours, minutes, seconds and milliseconds', () => {
  assert.equal(clockText(0), '00 00:00:00.000');
  assert.equal(clockText(1e6), '00 00:00:00.001');
  assert.equal(clockText(((25 * 60 + 1) * 60 + 2) * 1e9 + 345678901), '01 01:01:02.345');
});

test('numbers are short, and the limits of SDF are infinite', () => {
  assert.equal(numberText(0.5), '0.5');
  assert.equal(numberText(-0), '0');
  assert.equal(numberText(1 / 3), '0.3333333');
  assert.equal(numberText(1e16), 'inf');
  assert.equal(numberText(-1e16), '-inf');
  assert.equal(numberText(5.5645e-6), '5.5645e-6');
  assert.equal(numberText(1e12), '1e12');
  assert.equal(numberText(1000000), '1000000');
  assert.equal(numberText(null), '');
});

test('what is written is read as the same number', () => {
  for (const value of [0, 1, -1.5, 1e-9, 12345.678, -1e16, 1e12, 0.1 + 0.2]) {
    const again = parseNumber(numberText(value));
    assert.ok(Math.abs(again - value) <= 1e-6 * Math.abs(value), `${value} became ${again}`);
  }
});

test('number fields take sums, units and pi', () => {
  assert.equal(parseNumber(' 2 '), 2);
  assert.equal(parseNumber('pi/2'), Math.PI / 2);
  assert.equal(parseNumber('-90deg'), -Math.PI / 2);
  assert.equal(parseNumber('90°'), Math.PI / 2);
  assert.equal(parseNumber('25cm'), 0.25);
  assert.equal(parseNumber('(1 + 2) / 4'), 0.75);
  assert.equal(parseNumber('1 - 2 - 3'), -4);
  assert.equal(parseNumber('inf'), 1e16);
  assert.equal(parseNumber('1e-3'), 1e-3);
});

test('what is no number is none', () => {
  for (const text of ['', 'abc', '1 2', '1+', '(1', '1)', '1,5', '--', 'constructor', '2 pigs']) {
    assert.ok(Number.isNaN(parseNumber(text)), `"${text}" was read as ${parseNumber(text)}`);
  }
});

test('colours go to the picker and back', () => {
  assert.equal(colorText([1, 0.5, 0, 1]), '#ff8000');
  assert.equal(colorText([2, -1, 0, 1]), '#ff0000');
  assert.deepEqual(colorOf('#ff0000', 0.25), [1, 0, 0, 0.25]);
});

test('sizes of files are in words', () => {
  assert.deepEqual([999, 1500, 2.5e6, 3e9].map(bytesText), ['999 B', '2 kB', '2.5 MB', '3.0 GB']);
});

test('a pose of six numbers is the pose of seven', () => {
  const six = [1, 2, 3, 0.3, -0.7, 2.5];
  sixOf(sevenOf(six)).forEach((value, at) => assert.ok(Math.abs(value - six[at]) < 1e-12));
});

test('a pitch of a right angle keeps the rotation', () => {
  for (const sign of [1, -1]) {
    for (const yaw of [-2, 0, 1.2]) {
      const pose = sevenOf([0, 0, 0, 0.4, (sign * Math.PI) / 2, yaw]);
      const again = sevenOf([0, 0, 0, ...rpyOf(pose.slice(3))]);
      const dot = pose.slice(3).reduce((sum, part, at) => sum + part * again[3 + at], 0);
      assert.ok(Math.abs(Math.abs(dot) - 1) < 1e-9, `${sign} ${yaw}: ${dot}`);
    }
  }
});
