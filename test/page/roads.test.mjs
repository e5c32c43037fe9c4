/** Roads: the strip that the page draws is the one that cameras see (test_roads.py reads the same). */
import {test} from 'node:test';
import {readFileSync} from 'node:fs';
import assert from 'node:assert/strict';
import {roadStrip} from '../../web/js/view/road_strip.js';
import {near} from './near.mjs';

const {cases} = JSON.parse(readFileSync(new URL('../data/road_strips.json', import.meta.url)));

for (const {says, road, corners, uvs, triangles} of cases) {
  test(`a road: ${says}`, () => {
    const strip = roadStrip(road);
    near(strip.corners, corners.flat());
    near(strip.uvs, uvs.flat());
    assert.deepEqual(strip.triangles, triangles.flat());
  });
}
