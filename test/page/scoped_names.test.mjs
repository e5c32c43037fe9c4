import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';
import {splitScoped} from '../../web/js/scoped_names.js';

const {cases} = JSON.parse(readFileSync(new URL('../data/scoped_names.json', import.meta.url)));

for (const {says, models, name, split} of cases) {
  test(`a scoped name is split by the longest model name: ${says}`, () => {
    assert.deepEqual(splitScoped(name, (one) => models.includes(one)), split);
  });
}
