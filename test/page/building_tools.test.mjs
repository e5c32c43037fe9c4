// Drawing with the mouse, without a page: tools, inspectors, and the speed of edits.
import assert from 'node:assert/strict';
import test from 'node:test';

import {FloorTool, MeasureTool, OpeningTool, StairsTool, WallTool, rescaled, segmentWords,
} from '../../web/js/building/draw_tools.js';
import {applied, fieldFault, fieldsOf, levelApplied, levelValues, roofApplied, roofValues, valuesOf,
} from '../../web/js/building/inspector_fields.js';
import {followLevel} from '../../web/js/building/level_follower.js';
import {add, addLevel, itemOf, placeOf, removeLevel, update, withLevel,
} from '../../web/js/building/plan.js';
import {moveItems} from '../../web/js/building/plan_moves.js';
import {placingOps} from '../../web/js/building/building_preview.js';
import {PaintTool, SelectTool} from '../../web/js/building/select_tool.js';
import {Session} from '../../web/js/building/drawing_session.js';
import {openingPaths, stairsPaths, wallPath} from '../../web/js/building/plan_svg.js';

const mouse = (x, y, keys = {}) =>
  ({point: [x, y], shift: false, alt: false, ctrl: false, tolerance: 0.06, ...keys});

function opened() {
  const session = new Session();
  session.endTool = () => { session.tool = new SelectTool(session); };
  session.endTool();
  return session;
}

/** Clicks a tool through points, as a hand does. */
function click(session, ...points) {
  for (const [x, y, keys] of points) {
    session.tool.move(mouse(x, y, keys));
    session.tool.press(mouse(x, y, keys));
    session.tool.release(mouse(x, y, keys));
  }
}

function drag(session, from, to, keys) {
  session.tool.move(mouse(...from));
  session.tool.press(mouse(...from));
  session.tool.move(mouse((from[0] + to[0]) / 2, (from[1] + to[1]) / 2, keys));
  session.tool.move(mouse(...to, keys));
  session.tool.release(mouse(...to, keys));
}

/** A closed room of outer sides 4 x 3 m. */
function withRoom() {
  const session = opened();
  session.tool = new WallTool(session);
  click(session, [0, 0], [3.9, 0.05], [3.9, 2.9], [0.05, 2.9], [0.02, 0.1]);
  session.endTool();
  return session;
}

test('a chain of clicks draws walls that close onto the first end', () => {
  const {level} = withRoom();
  assert.equal(level.walls.length, 4);
  assert.deepEqual(level.walls[3].end, [0, 0]);
  for (const [at, wall] of level.walls.entries()) {
    assert.deepEqual(wall.end, level.walls[(at + 1) % 4].start);
  }
});

test('a typed length makes the wall as long, thickness and all', () => {
  const session = opened();
  session.tool = new WallTool(session);
  click(session, [0, 0]);
  session.tool.move(mouse(0.1, 2));
  session.tool.typed(3.3);
  assert.deepEqual(session.level.walls[0].end, [0, 3.15]);
});

test('the label of the wall being drawn tells length and angle', () => {
  assert.equal(segmentWords({start: [0, 0], end: [0, 3.15], thickness: 0.15}), '3.30 m  90°');
});

test('a click on the spot adds no wall and says why', () => {
  const session = opened();
  session.tool = new WallTool(session);
  click(session, [1, 1], [1, 1]);
  assert.equal(session.level.walls.length, 0);
  assert.match(session.hint, /at least 0.01 m/);
});

test('Esc drops the segment and keeps the walls', () => {
  const session = opened();
  session.tool = new WallTool(session);
  click(session, [0, 0], [2, 0], [2, 2]);
  session.tool.move(mouse(5, 5));
  assert.equal(session.tool.cancel(), true);
  assert.equal(session.level.walls.length, 2);
  assert.equal(session.tool.cancel(), false);
});

test('a door is put into the wall under the mouse, once', () => {
  const session = withRoom();
  session.tool = new OpeningTool(session, 'doors');
  session.tool.move(mouse(2, 0.2));
  assert.equal(session.draft.opening.item.wall, 0);
  click(session, [2, 0.2]);
  assert.equal(session.tool.name, 'select');
  const [door] = session.level.doors;
  assert.equal(door.wall, 0);
  assert.deepEqual(placeOf(door, session.level).point, [2, 0]);
});

test('a door that overlaps another, or is wider than its wall, is not put and the reason told', () => {
  const session = withRoom();
  session.tool = new OpeningTool(session, 'doors');
  click(session, [2, 0]);
  session.tool = new OpeningTool(session, 'windows');
  click(session, [2.2, 0]);
  assert.equal(session.level.windows.length, 0);
  assert.match(session.hint, /overlaps another/);
  session.tool = new WallTool(session);
  click(session, [8, 0], [8.5, 0]);
  session.tool = new OpeningTool(session, 'doors');
  click(session, [8.2, 0]);
  assert.match(session.hint, /0.9 m wide/);
  assert.equal(session.level.doors.length, 1);
});

test('an opening far from walls stands free', () => {
  const session = withRoom();
  session.tool = new OpeningTool(session, 'windows');
  click(session, [2, 1.5]);
  assert.equal(session.level.windows[0].wall, null);
  assert.deepEqual(session.level.windows[0].position, [2, 1.5]);
});

test('an attached door slides along its wall and comes off beyond 0.3 m', () => {
  const session = withRoom();
  session.tool = new OpeningTool(session, 'doors');
  click(session, [2, 0]);
  drag(session, [2, 0], [2.6, 0.2]);
  assert.equal(session.level.doors[0].along, 2.6);
  drag(session, [2.6, 0], [2.6, 1.4]);
  assert.equal(session.level.doors[0].wall, null);
  session.undo();
  assert.equal(session.level.doors[0].along, 2.6);
});

test('an end that is dragged snaps about the other one and takes linked walls along', () => {
  const session = withRoom();
  session.select([{kind: 'walls', id: 0}]);
  drag(session, [3.85, 0], [4.62, 0.1]);
  assert.deepEqual(session.level.walls[0].end, [4.6, 0]);
  assert.deepEqual(session.level.walls[1].start, [4.6, 0]);
  assert.equal(session.history.undoLabel, 'resize wall');
});

test('a drag is one step of history, and Esc takes it back', () => {
  const session = withRoom();
  const before = session.plan;
  session.tool.press(mouse(2, 0));
  session.tool.move(mouse(2, -1));
  assert.notEqual(session.plan, before);
  session.tool.cancel();
  assert.equal(session.plan, before);
  drag(session, [2, 0], [2, -1]);
  assert.deepEqual(session.level.walls[0].start, [0, -1]);
  session.undo();
  assert.equal(session.plan, before);
});

test('stairs turn in quarters and are resized about the opposite corner', () => {
  const session = opened();
  session.tool = new StairsTool(session);
  click(session, [2, 2]);
  drag(session, [2, 2 + 1.75 + 0.4], [0.2, 2.3]);
  const [stairs] = session.level.stairs;
  assert.ok(Math.abs(stairs.yaw - Math.PI / 2) < 1e-9);
  drag(session, [0.25, 2.5], [-0.75, 3]);
  const [grown] = session.level.stairs;
  assert.deepEqual([grown.width, grown.depth], [1.5, 4.5]);
  assert.deepEqual(grown.position, [1.5, 2.25]);
});

test('a click in a room lays its floor, corner clicks draw any other', () => {
  const session = withRoom();
  session.tool = new FloorTool(session);
  click(session, [2, 1]);
  assert.equal(session.level.floors[0].outline.length, 4);
  assert.equal(session.level.floors[0].thickness, 0.01);
  session.tool = new FloorTool(session);
  click(session, [10, 0, {shift: true}], [13, 0, {shift: true}], [11, 2, {shift: true}]);
  session.tool.double();
  assert.deepEqual(session.level.floors[1].outline, [[10, 0], [13, 0], [11, 2]]);
});

test('a floor whose edges cross is refused in words', () => {
  const session = opened();
  session.tool = new FloorTool(session);
  for (const [x, y] of [[0, 0], [2, 2], [2, 0], [0, 2]]) click(session, [x, y, {shift: true}]);
  session.tool.double();
  assert.equal(session.level.floors.length, 0);
  assert.match(session.hint, /intersects itself/);
});

test('painting shows on hovering and paints one thing', () => {
  const session = withRoom();
  session.tool = new PaintTool(session, {color: '#fe7905', texture: ''});
  session.tool.move(mouse(2, 0));
  assert.equal(session.plan.levels[0].walls[0].color, '#fe7905');
  assert.equal(session.history.plan.levels[0].walls[0].color, '#ffffff');
  session.tool.move(mouse(9, 9));
  assert.equal(session.plan.levels[0].walls[0].color, '#ffffff');
  click(session, [2, 0]);
  assert.equal(session.history.plan.levels[0].walls[0].color, '#fe7905');
  assert.equal(session.tool.name, 'select');
});

test('painting goes on while Shift is held', () => {
  const session = withRoom();
  session.tool = new PaintTool(session, {texture: 'Gazebo/Bricks'});
  for (const at of [[2, 0], [3.85, 1.5]]) {
    session.tool.press({...mouse(...at), shift: true});
    assert.equal(session.tool.name, 'paint');
  }
  const textures = session.history.plan.levels[0].walls.map(({texture}) => texture);
  assert.equal(textures.filter((one) => one === 'Gazebo/Bricks').length, 2);
});

test('a line over a known length scales the floor plan', () => {
  const session = opened();
  let drawn = null;
  session.tool = new MeasureTool(session, (length) => { drawn = length; });
  drag(session, [0, 0], [2, 0]);
  assert.equal(drawn, 2);
  assert.equal(rescaled({resolution: 100}, 2, 4).resolution, 50);
});

test('deleting, copying and selecting go through history', () => {
  const session = withRoom();
  session.selectAll();
  session.copy();
  session.removeSelected();
  assert.equal(session.level.walls.length, 0);
  session.paste([0, 0]);
  assert.equal(session.level.walls.length, 4);
  assert.equal(session.selection.length, 4);
  session.undo();
  session.undo();
  assert.deepEqual(session.level.walls.map(({id}) => id), [0, 1, 2, 3]);
});

test('an edit by key during a drag ends the drag and stays', () => {
  for (const {edit, walls, label} of [
    {edit: (session) => session.removeSelected(), walls: 3, label: 'delete wall'},
    {edit: (session) => session.paste(), walls: 5, label: 'paste'},
  ]) {
    const session = withRoom();
    session.select([{kind: 'walls', id: 0}]);
    session.copy();
    session.tool.press(mouse(2, 0));
    session.tool.move(mouse(2, -1));
    edit(session);
    const {plan} = session.history;
    session.tool.move(mouse(2, -1.5));
    assert.equal(session.plan, plan);
    session.tool.release(mouse(2, -2));
    assert.equal(session.history.plan, plan);
    assert.equal(session.level.walls.length, walls);
    assert.equal(session.history.undoLabel, label);
  }
});

test('the inspector of an attached door speaks of distances to the wall ends', () => {
  const session = withRoom();
  session.tool = new OpeningTool(session, 'doors');
  click(session, [2, 0]);
  const ref = {kind: 'doors', id: 0};
  const values = valuesOf(session.level.doors[0], session.level);
  assert.equal(values.fromStart, 1.55);
  assert.ok(Math.abs(values.fromEnd - (3.85 - 2.45)) < 1e-9);
  const names = fieldsOf('doors', session.level.doors[0]).map(({name}) => name);
  assert.ok(!names.includes('x') && names.includes('fromStart'));
  const {plan, fault} = applied(session.plan, 0, ref, {...values, fromEnd: 0.5}, values);
  assert.equal(fault, '');
  assert.ok(Math.abs(plan.levels[0].doors[0].along - (3.85 - 0.5 - 0.45)) < 1e-9);
  assert.match(applied(session.plan, 0, ref, {...values, width: 5}, values).fault, /wide/);
  assert.match(applied(session.plan, 0, ref, {...values, fromStart: 3.5}, values).fault, /beyond/);
});

test("a wall's typed outer length moves its end, typed ends move linked walls", () => {
  const session = withRoom();
  const ref = {kind: 'walls', id: 0};
  const values = valuesOf(session.level.walls[0], session.level);
  assert.equal(values.length, 4);
  const longer = applied(session.plan, 0, ref, {...values, length: 5}, values).plan;
  assert.deepEqual(longer.levels[0].walls[0].end, [4.85, 0]);
  assert.deepEqual(longer.levels[0].walls[1].start, [4.85, 0]);
  assert.match(applied(session.plan, 0, ref, {...values, endX: 0, endY: 0}, values).fault, /must differ/);
});

test('fields refuse what is outside of their range', () => {
  const [, , , , length] = fieldsOf('walls', {});
  assert.match(fieldFault(length, 0), /must be at least/);
  assert.match(fieldFault(length, NaN), /not a number/);
  assert.match(fieldFault(length, 2000), /must be at most 1000/);
  assert.equal(fieldFault(length, 4), '');
});

test('level and roof are edited by their inspectors', () => {
  const session = withRoom();
  const level = levelValues(session.plan, 0);
  const plan = levelApplied(session.plan, 0, {...level, name: 'Ground', height: 3}, level);
  assert.equal(plan.levels[0].name, 'Ground');
  assert.equal(plan.levels[0].walls[0].height, 3);
  const roof = roofValues(plan);
  const roofed = roofApplied(plan, {...roof, kind: 'gable', pitch: 45}, roof);
  assert.ok(Math.abs(roofed.roof.pitch - Math.PI / 4) < 1e-9);
  assert.equal(roofApplied(roofed, {...roofValues(roofed), kind: 'none'}, roofValues(roofed)).roof, null);
});

test('an inspector applies what was typed and keeps what was edited beside it', () => {
  const {plan, ref} = add(withRoom().plan, 0, 'stairs', {position: [0, 0]});
  const wall = {kind: 'walls', id: 0};
  const shown = (one) => valuesOf(itemOf(plan, 0, one), plan.levels[0]);
  const dragged = moveItems(plan, 0, [ref], [5, 0]);
  const stairs = itemOf(applied(dragged, 0, ref, {...shown(ref), steps: 20}, shown(ref)).plan, 0, ref);
  assert.deepEqual([stairs.steps, stairs.position], [20, [5, 0]]);

  const painted = update(moveItems(plan, 0, [wall], [0, -5]), 0, wall, {color: '#ff0000', height: 3});
  const edited = itemOf(applied(painted, 0, wall, {...shown(wall), startX: -1}, shown(wall)).plan, 0, wall);
  assert.deepEqual([edited.start, edited.end], [[-1, -5], [3.85, -5]]);
  assert.deepEqual([edited.color, edited.height], ['#ff0000', 3]);

  const level = levelValues(plan, 0);
  const higher = update(levelApplied(plan, 0, {...level, height: 3}, level), 0, wall, {height: 2});
  const named = levelApplied(higher, 0, {...level, name: 'Ground'}, level).levels[0];
  assert.deepEqual([named.name, named.height, named.walls[0].height], ['Ground', 3, 2]);

  const roof = roofValues(plan);
  const gable = roofApplied(plan, {...roof, kind: 'gable'}, roof);
  assert.equal(roofApplied(gable, {...roof, thickness: 0.2}, roof).roof.kind, 'gable');
});

test('a level is followed while others come and go, and lost with its building', () => {
  const session = withRoom();
  const commit = (plan) => session.commit(plan, 'edit');
  commit(addLevel(session.plan));
  commit(addLevel(session.plan));
  session.showLevel(1);
  const level = followLevel(session);
  commit(withLevel(session.plan, 1, {name: 'Middle'}));
  commit(removeLevel(session.plan, 0));
  assert.equal(session.plan.levels[level.at()].name, 'Middle');
  commit(removeLevel(session.plan, 1));
  commit(addLevel(session.plan));
  assert.equal(session.plan.levels[level.at()].name, 'Middle');
  session.undo();
  assert.equal(level.at(), 0);
  session.undo();
  commit(removeLevel(session.plan, 0));
  assert.equal(level.at(), -1);
  commit(withLevel(session.plan, 0, {name: 'Top'}));
  assert.equal(level.at(), -1);
  session.undo();
  session.undo();
  assert.equal(session.plan.levels[level.at()].name, 'Middle');
  session.open(session.plan);
  assert.equal(level.at(), -1);
  level.end();
});

test('a place typed for a free door is refused once the door is in a wall', () => {
  const {plan, ref} = add(withRoom().plan, 0, 'doors', {position: [9, 9]});
  const before = valuesOf(itemOf(plan, 0, ref), plan.levels[0]);
  const put = update(plan, 0, ref, {wall: 0, along: 2});
  assert.match(applied(put, 0, ref, {...before, x: 8}, before).fault, /open its inspector again/);
  const lower = applied(put, 0, ref, {...before, height: 1.8}, before).plan.levels[0].doors[0];
  assert.deepEqual([lower.height, lower.wall, lower.along], [1.8, 0, 2]);
});

test('what is drawn of an item are paths in pixels of the sheet', () => {
  const session = withRoom();
  assert.equal(wallPath(session.level.walls[0]), 'M-7.5 7.5L392.5 7.5L392.5 -7.5L-7.5 -7.5Z');
  const door = {wall: null, position: [0, 0], yaw: 0, width: 1, depth: 0.2};
  assert.ok(openingPaths('doors', door, session.level).lines.includes('A100 100'));
  assert.equal(stairsPaths({position: [0, 0], yaw: 0, width: 1, depth: 2, steps: 4}).lines.split('M').length - 1, 3);
});

test('an opened building takes the place of its model, where that was moved to', () => {
  const pose = (x, y) => [x, y, 0, 0, 0, 0, 1];
  const building = {model: {name: 'House', pose: pose(1, 1)}, sdf: '<sdf/>'};
  const store = {model: (name) => name === 'House' ? {} : null, worldPose: () => pose(12, 2)};
  assert.deepEqual(placingOps(store, building, null), [{kind: 'insert', name: 'House', sdf: '<sdf/>', pose: pose(1, 1)}]);
  const [gone, there] = placingOps(store, building, {name: 'House', pose: pose(2, 2)});
  assert.deepEqual(gone, {kind: 'delete', names: ['House']});
  assert.deepEqual(there.pose, pose(11, 1));
});

test('after an edit of 500 walls and 200 openings little is computed again', () => {
  const session = opened();
  let plan = session.plan;
  const walls = [];
  for (let row = 0; row < 16; row++) {
    for (let column = 0; column < 16; column++) {
      const [x, y] = [column * 4, row * 4];
      walls.push({id: walls.length, start: [x, y], end: [x + 4, y], thickness: 0.15, height: 2.5, color: '#ffffff', texture: ''});
      walls.push({id: walls.length, start: [x, y], end: [x, y + 4], thickness: 0.15, height: 2.5, color: '#ffffff', texture: ''});
    }
  }
  const doors = Array.from({length: 200}, (_, id) => ({id, wall: id, along: 2, width: 0.9, height: 2, elevation: 0, depth: 0.17, position: [0, 0], yaw: 0}));
  plan = {...plan, levels: [{...plan.levels[0], walls, doors}], next: {...plan.next, wall: 512, door: 200}};
  session.open(plan);
  session.select([{kind: 'walls', id: 40}]);
  const before = session.level;
  const [x, y] = before.walls[40].start;
  drag(session, [x + 1, y + 0.02], [x + 1, y + 0.52]);
  const kept = session.level.walls.filter((wall, at) => wall === before.walls[at]).length;
  assert.ok(kept >= 500 && kept < 512, `${kept} walls kept`);
  const doorsKept = session.level.doors.filter((door, at) => door === before.doors[at]).length;
  assert.ok(doorsKept >= 195, `${doorsKept} doors kept`);
});
