import {test} from 'node:test';
import {readFileSync} from 'node:fs';
import assert from 'node:assert/strict';
import {ActorPath} from '../../web/js/actor_path.js';
import {SimClock} from '../../web/js/sim_clock.js';
import {near, sameTurn} from './near.mjs';

/** Closed forms that cameras keep, too (test_actor_paths.py reads the same). */
const {cases} = JSON.parse(readFileSync(new URL('../data/actor_paths.json', import.meta.url)));
const PLACE = [9, 0, 0, 0, 0, 0, 1];
const actor = (fields = {}) => ({name: 'man', pose: PLACE, skin: '', geometry: {type: 'empty'},
  animations: [], loop: true, delay_start: 0, auto_start: true, trajectories: [], ...fields});
const NONE = new Map();
const walk = {id: 0, type: 'walk', tension: 0, waypoints: [{time: 0, pose: PLACE},
  {time: 2, pose: PLACE}]};

for (const {says, actor: fields, durations = {}, at: moments} of cases) {
  test(`an actor: ${says}`, () => {
    const path = new ActorPath(actor(fields), new Map(Object.entries(durations)));
    for (const {time, pose, stride} of moments) {
      const found = path.poseAt(time);
      near(found.slice(0, 3), pose.slice(0, 3));
      sameTurn(found.slice(3), pose.slice(3));
      const {type, time: since, distance, onPath} = path.strideAt(time) ?? {};
      const does = type === undefined ? null : [type, since, distance, onPath];
      if (stride !== undefined) assert.deepEqual(does, stride);
    }
  });
}

test('what time makes no difference to does not move', () => {
  assert.equal(new ActorPath(actor(), NONE).moves, false);
  assert.equal(new ActorPath(actor({trajectories: [walk]}), NONE).moves, true);
  assert.equal(new ActorPath(actor({trajectories: [walk], auto_start: false}), NONE).moves, false);
});

test('sim time goes on at the told rate, and stands when paused or in silence', () => {
  const clock = new SimClock();
  clock.tell(10, 0.5, 1000);
  near([clock.at(1200)], [10.1]);
  assert.equal(clock.runs(1200), true);
  near([clock.at(60000)], [10.5]);
  assert.equal(clock.runs(60000), false);
  clock.tell(11, 0, 61000);
  near([clock.at(61500)], [11]);
  assert.equal(clock.runs(61500), false);
});

test('a guess that was ahead waits for sim time; a reset goes back at once', () => {
  const clock = new SimClock();
  clock.tell(10, 1, 0);
  near([clock.at(200)], [10.2]);
  clock.tell(10.15, 1, 200);
  near([clock.at(200)], [10.2]);
  near([clock.at(300)], [10.25]);
  clock.tell(0, 1, 300);
  near([clock.at(300)], [0]);
});
