import assert from 'node:assert/strict';
import test from 'node:test';
import {csvOf, extent, KEPT, Series, take, ticks} from '../../web/js/ui/plot_data.js';
import {variablesOf} from '../../web/js/panels/plot_variables.js';
import {box, world} from './fake_simulator.mjs';

function series(variable, ...samples) {
  const made = new Series(variable);
  for (const [time, value] of samples) made.add(time, value);
  return made;
}

test('time that runs back begins a curve anew', () => {
  const curve = series('a.x', [1, 1], [2, 2], [0.5, 3]);
  assert.deepEqual([curve.times, curve.values], [[0.5], [3]]);
});

test('time that runs back begins all curves anew, also those of what has gone', () => {
  const [moving, gone] = ['car.x', 'wall.x'].map((variable) => new Series(variable));
  const all = [moving, gone];
  take(all, gone, {time: 100, value: 5});
  for (const one of all) take(all, one, {time: 101, value: 6});
  take(all, gone, {time: 102, problem: 'no model wall'});
  assert.deepEqual([gone.ended, gone.times], [true, [100, 101]]);
  for (const time of [0, 1, 2, 3]) {
    take(all, moving, {time, value: time});
    take(all, gone, {time, problem: 'no model wall'});
  }
  assert.deepEqual([moving.times, gone.times], [[0, 1, 2, 3], []]);
  assert.equal(extent(all, 10, 3).to, 3);
  take(all, gone, {time: 4, value: 1});
  assert.equal(gone.ended, false);
});

test('a second sample of the same time replaces the first', () => {
  const curve = series('a.x', [1, 1], [1, 5]);
  assert.deepEqual([curve.times, curve.values], [[1], [5]]);
});

test('long curves lose their oldest half, never the newest', () => {
  const curve = new Series('a.x');
  for (let n = 0; n <= KEPT; n += 1) curve.add(n, -n);
  assert.ok(curve.times.length <= KEPT);
  assert.equal(curve.times[curve.times.length - 1], KEPT);
  assert.equal(curve.values.length, curve.times.length);
});

test('a curve is read off at the last sample before a time', () => {
  const curve = series('a.x', [1, 10], [2, 20]);
  assert.deepEqual(
    [0.5, 1, 1.7, 9].map((time) => curve.at(time)),
    [undefined, 10, 10, 20],
  );
});

test('axes show the span that is asked for and all values in it', () => {
  const curve = series('a.x', [0, 100], [5, 1], [10, 3]);
  const range = extent([curve], 6);
  assert.deepEqual([range.from, range.to], [4, 10]);
  assert.ok(range.low < 1 && range.high > 3);
  assert.equal(extent([curve], null).from, 0);
  assert.equal(extent([series('b.x')], 6), null);
});

test('a constant has room above and below', () => {
  const range = extent([series('a.x', [0, 2], [1, 2])], null);
  assert.ok(range.low < 2 && range.high > 2);
});

test('ticks are round and lie between the ends', () => {
  assert.deepEqual(ticks(0, 1, 5), [0, 0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(ticks(-1.1, 1.1, 3), [-1, 0, 1]);
  for (const tick of ticks(1e-9, 3e-9, 4)) assert.ok(tick >= 0.99e-9 && tick <= 3.01e-9);
});

test('CSV has a column for each curve and a row for each time', () => {
  const text = csvOf([series('a.x', [0, 1], [1, 2]), series('b,"y"', [1, 5], [2, 6])]);
  assert.equal(text, 'time,a.x,"b,""y"""\n0,1,\n1,2,5\n2,,6\n');
});

test('models, their links when they are several, and joints can be plotted', () => {
  const arm = box('arm');
  arm.links.push({...arm.links[0], name: 'tip'});
  arm.joints = [
    {name: 'elbow', type: 'revolute', axis: {}, axis2: null},
    {name: 'weld', type: 'fixed', axis: null},
  ];
  const [simulation, crate, robot] = variablesOf(world([box('crate'), arm]));
  assert.ok(simulation.variables.includes('real_time_factor'));
  assert.ok(crate.variables.includes('crate.vz') && !crate.variables.includes('crate::link.x'));
  assert.ok(robot.variables.includes('arm::tip.yaw'));
  assert.ok(robot.variables.includes('arm::elbow.position'));
  assert.ok(!robot.variables.some((variable) => variable.includes('weld')));
});

test('the axis goes on to the present while nothing changes', () => {
  assert.equal(extent([series('a.x', [0, 2], [1, 2])], 10, 8).to, 8);
  assert.equal(extent([series('a.x', [0, 2], [9, 2])], 10, 8).to, 9);
});
