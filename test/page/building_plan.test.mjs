// The plan of a building and what is done to it.
import assert from 'node:assert/strict';
import test from 'node:test';

import * as plans from '../../web/js/building/plan.js';
import {moveEnd, moveItems} from '../../web/js/building/plan_moves.js';
import * as clipboard from '../../web/js/building/plan_clipboard.js';
import {faultsOf, meeting, openingFault} from '../../web/js/building/plan_check.js';
import {History} from '../../web/js/building/plan_history.js';

const {add, addLevel, emptyPlan, itemOf, remove, update} = plans;

/** A 4 x 3 m room of four linked walls. */
export function room(plan = emptyPlan()) {
  const corners = [[0, 0], [4, 0], [4, 3], [0, 3]];
  return corners.reduce((made, start, at) =>
    add(made, 0, 'walls', {start, end: corners[(at + 1) % 4]}).plan, plan);
}

const wall = (id) => ({kind: 'walls', id});

test('a new wall has the sizes of Gazebo and a number that is not given again', () => {
  let {plan, ref} = add(emptyPlan(), 0, 'walls', {start: [0, 0], end: [2, 0]});
  assert.deepEqual(itemOf(plan, 0, ref),
    {id: 0, thickness: 0.15, height: 2.5, color: '#ffffff', texture: '', start: [0, 0], end: [2, 0]});
  plan = remove(plan, 0, [ref]);
  ({plan, ref} = add(plan, 0, 'walls', {start: [0, 0], end: [2, 0]}));
  assert.equal(ref.id, 1);
});

test('plans are never changed', () => {
  const before = room();
  const text = JSON.stringify(before);
  moveEnd(before, 0, 0, 'end', [5, 0]);
  remove(before, 0, [wall(1)]);
  addLevel(before);
  assert.equal(JSON.stringify(before), text);
});

test('what an edit does not touch stays the same object', () => {
  const before = room();
  const after = update(before, 0, wall(0), {height: 3});
  assert.equal(after.levels[0].walls[2], before.levels[0].walls[2]);
  assert.notEqual(after.levels[0].walls[0], before.levels[0].walls[0]);
});

test('linked ends move together', () => {
  const after = moveEnd(room(), 0, 0, 'end', [5, 1]);
  assert.deepEqual(after.levels[0].walls[0].end, [5, 1]);
  assert.deepEqual(after.levels[0].walls[1].start, [5, 1]);
  assert.deepEqual(after.levels[0].walls[1].end, [4, 3]);
});

test('an end that is pulled away alone leaves its link', () => {
  const after = moveEnd(room(), 0, 0, 'end', [5, 1], {alone: true});
  assert.deepEqual(after.levels[0].walls[1].start, [4, 0]);
});

test('moving a wall stretches its neighbours', () => {
  const after = moveItems(room(), 0, [wall(0)], [0, -1]);
  assert.deepEqual(after.levels[0].walls.map(({start, end}) => [start, end]),
    [[[0, -1], [4, -1]], [[4, -1], [4, 3]], [[4, 3], [0, 3]], [[0, 3], [0, -1]]]);
});

test('an opening keeps its distance from the end that stays', () => {
  const {plan} = add(room(), 0, 'doors', {wall: 0, along: 3});
  assert.equal(moveEnd(plan, 0, 0, 'end', [5, 0]).levels[0].doors[0].along, 3);
  assert.equal(moveEnd(plan, 0, 0, 'start', [-1, 0]).levels[0].doors[0].along, 4);
  assert.equal(moveItems(plan, 0, [wall(0)], [2, 1]).levels[0].doors[0].along, 3);
});

test('windows and doors go with their wall', () => {
  let {plan} = add(room(), 0, 'doors', {wall: 0, along: 3});
  plan = add(plan, 0, 'windows', {wall: 1, along: 1}).plan;
  const after = remove(plan, 0, [wall(0)]).levels[0];
  assert.equal(after.doors.length, 0);
  assert.equal(after.windows.length, 1);
});

test('a new level copies the walls alone, begins at the highest wall top and has a floor', () => {
  let plan = add(room(), 0, 'doors', {wall: 0, along: 2}).plan;
  plan = add(plan, 0, 'stairs', {position: [2, 1]}).plan;
  plan = update(plan, 0, wall(2), {height: 3.2});
  const made = addLevel(plan);
  const [, upper] = made.levels;
  assert.equal(upper.walls.length, 4);
  assert.deepEqual(upper.walls.map(({id}) => id), [4, 5, 6, 7]);
  assert.equal(upper.doors.length + upper.stairs.length + upper.windows.length, 0);
  assert.deepEqual(plans.bases(made), [0, 3.2]);
  assert.equal(upper.floors.length, 1);
  assert.equal(upper.floors[0].thickness, 0.1);
  assert.equal(upper.floors[0].outline.length, 4);
});

test('a new level has a name of its own, also after a lower one was deleted', () => {
  const names = (plan) => plan.levels.map(({name}) => name);
  const two = addLevel(room());
  assert.deepEqual(names(addLevel(two)), ['Level 1', 'Level 2', 'Level 3']);
  assert.deepEqual(names(addLevel(plans.removeLevel(two, 0))), ['Level 2', 'Level 3']);
});

test('without a wall there is no new level, and the last level stays', () => {
  assert.equal(addLevel(emptyPlan()), null);
  assert.equal(plans.removeLevel(room(), 0), null);
  assert.equal(plans.removeLevel(addLevel(room()), 0).levels.length, 1);
});

test('the floor of a level follows its walls until it is drawn otherwise', () => {
  const two = addLevel(room());
  const corner = (plan) => plan.levels[1].floors[0].outline.map(([x]) => x).sort((a, b) => a - b);
  const wider = moveItems(two, 1, [wall(5)], [1, 0]);
  assert.deepEqual(corner(wider), [0, 0, 5, 5]);
  const moved = moveItems(two, 1, [{kind: 'floors', id: 0}], [0, 1]);
  assert.deepEqual(corner(moveItems(moved, 1, [wall(5)], [1, 0])), [0, 0, 4, 4]);
});

test('the height of a level takes the walls along that were as high as it', () => {
  const plan = update(room(), 0, wall(1), {height: 1});
  const made = plans.setLevelHeight(plan, 0, 3);
  assert.deepEqual(made.levels[0].walls.map(({height}) => height), [3, 1, 3, 3]);
});

test('copies of walls bring copies of their openings', () => {
  const {plan} = add(room(), 0, 'doors', {wall: 0, along: 2});
  const clips = clipboard.clipboardOf(plan, 0, [wall(0)]);
  const {plan: made, refs} = clipboard.pasted(plan, 0, clips, [1, 1]);
  assert.deepEqual(refs, [wall(4), {kind: 'doors', id: 1}]);
  assert.deepEqual(made.levels[0].walls[4].start, [1, 1]);
  assert.equal(made.levels[0].doors[1].wall, 4);
});

test('a copied opening whose wall stays behind stands free where it was', () => {
  const {plan, ref} = add(room(), 0, 'windows', {wall: 1, along: 2});
  const {plan: made} = clipboard.pasted(plan, 0, clipboard.clipboardOf(plan, 0, [ref]), [1, 0]);
  const [, free] = made.levels[0].windows;
  assert.equal(free.wall, null);
  assert.deepEqual(free.position, [5, 2]);
});

test('an opening sticks to a wall as far as it fits', () => {
  const [first] = room().levels[0].walls;
  const door = {...plans.DEFAULTS.doors, id: 0};
  assert.equal(plans.attached(door, first, 0.1).along, 0.45);
  assert.equal(plans.attached(door, first, 3.9).along, 3.55);
  assert.equal(plans.attached(door, first, 2).along, 2);
  assert.match(openingFault(plans.attached({...door, width: 9}, first, 2), first), /9 m wide/);
});

test('links of the model are found again in the plan', () => {
  const plan = addLevel(room());
  assert.deepEqual(plans.itemOfLink(plan, 'Wall_6'), {level: 1, ref: wall(6)});
  assert.equal(plans.itemOfLink(plan, 'Wall_99'), null);
  assert.equal(plans.itemOfLink(plan, 'Roof_0'), null);
});

test('crossing and overlapping walls are told, walls that end at each other not', () => {
  const line = (start, end) => ({start, end, thickness: 0.15});
  const base = line([0, 0], [4, 0]);
  assert.equal(meeting(base, line([2, -1], [2, 1])), 'cross');
  assert.equal(meeting(base, line([2, 0], [2, 1])), '');
  assert.equal(meeting(base, line([3, 0], [6, 0])), 'overlap');
  assert.equal(meeting(base, line([4, 0], [6, 0])), '');
  assert.equal(meeting(base, line([0, 1], [4, 1])), '');
});

test('faults name the items', () => {
  let plan = add(room(), 0, 'doors', {wall: 0, along: 2}).plan;
  plan = add(plan, 0, 'windows', {wall: 0, along: 2.4}).plan;
  plan = add(plan, 0, 'windows', {wall: 1, along: 1, width: 4}).plan;
  plan = add(plan, 0, 'walls', {start: [1, 1], end: [1, 1]}).plan;
  plan = add(plan, 0, 'floors', {outline: [[0, 0], [1, 1], [1, 0], [0, 1]]}).plan;
  const words = faultsOf(plan.levels[0]).map(({message}) => message);
  assert.equal(words.length, 4);
  assert.match(words[0], /Wall_4 has zero length/);
  assert.match(words[1], /Window_0 and Door_0|Door_0 and Window_0|Window_1 is 4 m/);
  assert.ok(words.some((word) => /Window_1 is 4 m wide, but the wall is only 3 m long/.test(word)));
  assert.ok(words.some((word) => /Floor_0 intersects itself/.test(word)));
});

test('undo and redo go through all steps, and know what is saved', () => {
  const history = new History(emptyPlan());
  const first = room();
  history.commit(first, 'room');
  history.markSaved();
  history.commit(addLevel(first), 'add level');
  assert.equal(history.dirty, true);
  assert.equal(history.undo(), 'add level');
  assert.equal(history.plan, first);
  assert.equal(history.dirty, false);
  assert.equal(history.redoLabel, 'add level');
  assert.equal(history.undo(), 'room');
  assert.equal(history.undo(), null);
  assert.equal(history.redo(), 'room');
  history.commit(emptyPlan(), 'other');
  assert.equal(history.redo(), null);
});
