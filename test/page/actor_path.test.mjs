import {test} from 'node:test';
import assert from 'node:assert/strict';
import {ActorPath} from '../../web/js/actor_path.js';
import {axisAngle} from '../../web/js/pose.js';
import {SimClock} from '../../web/js/sim_clock.js';
import {near, sameTurn} from './near.mjs';

const at = (x, y = 0, yaw = 0) => [x, y, 0, ...axisAngle([0, 0, 1], yaw)];
const waypoint = (time, ...place) => ({time, pose: at(...place)});
const trajectory = (...waypoints) => ({id: 0, type: 'walk', tension: 0, waypoints});
const actor = (fields = {}) => ({name: 'man', pose: at(9), skin: '', geometry: {type: 'empty'},
  animations: [], loop: true, delay_start: 0, auto_start: true, trajectories: [], ...fields});
const walk = trajectory(waypoint(0, 0), waypoint(2, 4), waypoint(4, 4, 2));
const place = (path, time) => path.poseAt(time).slice(0, 2);

test('an actor without a trajectory stands at its pose', () => {
  const path = new ActorPath(actor());
  near(place(path, 5), [9, 0]);
  assert.equal(path.moves, false);
});

test('positions between waypoints lie on the line between them', () => {
  const path = new ActorPath(actor({trajectories: [walk]}));
  assert.equal(path.moves, true);
  near(place(path, 0), [0, 0]);
  near(place(path, 0.5), [1, 0]);
  near(place(path, 2), [4, 0]);
  near(place(path, 3.5), [4, 1.5]);
});

test('an actor turns evenly and the shorter way', () => {
  const path = new ActorPath(actor({trajectories: [
    trajectory(waypoint(0, 0, 0, 3), waypoint(1, 0, 0, -3))]}));
  sameTurn(path.poseAt(0.5).slice(3), axisAngle([0, 0, 1], Math.PI));
  const quarter = (2 * Math.PI - 6) / 4;
  sameTurn(path.poseAt(0.25).slice(3), axisAngle([0, 0, 1], 3 + quarter));
});

test('a loop begins again, without one the actor stays at the end', () => {
  near(place(new ActorPath(actor({trajectories: [walk]})), 4.5), [1, 0]);
  near(place(new ActorPath(actor({trajectories: [walk], loop: false})), 4.5), [4, 2]);
});

test('the delay is waited for before each cycle: at the pose first, then at the end', () => {
  const path = new ActorPath(actor({trajectories: [walk], delay_start: 1}));
  near(place(path, 0.9), [9, 0]);
  near(place(path, 1.5), [1, 0]);
  near(place(path, 5.5), [4, 2]);
  near(place(path, 6.5), [1, 0]);
});

test('an actor that does not start by itself stands at its pose', () => {
  const path = new ActorPath(actor({trajectories: [walk], auto_start: false}));
  near(place(path, 1), [9, 0]);
  assert.equal(path.moves, false);
});

test('trajectories follow each other, each with times of its own', () => {
  const path = new ActorPath(actor({trajectories: [walk,
    trajectory(waypoint(0.5, 10), waypoint(2, 14))]}));
  near(place(path, 3.999), [4, 1.999]);
  near(place(path, 4), [10, 0]);
  near(place(path, 5), [12, 0]);
  near(place(path, 6.5), [1, 0]);
});

test('waypoints may come in any order', () => {
  const path = new ActorPath(actor({trajectories: [trajectory(waypoint(2, 4), waypoint(0, 0))]}));
  near(place(path, 1), [2, 0]);
});

test('one waypoint is where the actor stands', () => {
  near(place(new ActorPath(actor({trajectories: [trajectory(waypoint(0, 3))]})), 7), [3, 0]);
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
