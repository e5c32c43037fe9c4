import assert from 'node:assert/strict';

/** Asserts that two lists of numbers agree. */
export function near(actual, expected, tolerance = 1e-9) {
  assert.equal(actual.length, expected.length);
  actual.forEach((value, index) => assert.ok(Math.abs(value - expected[index]) <= tolerance,
    `[${[...actual]}] instead of [${[...expected]}]`));
}

/** Asserts that two unit quaternions turn alike. */
export function sameTurn(actual, expected, tolerance = 1e-9) {
  const product = actual.reduce((sum, part, index) => sum + part * expected[index], 0);
  assert.ok(Math.abs(Math.abs(product) - 1) <= tolerance,
    `[${[...actual]}] instead of [${[...expected]}]`);
}
