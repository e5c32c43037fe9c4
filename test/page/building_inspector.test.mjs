// Inspectors as windows that stay open while the plan is edited.
import assert from 'node:assert/strict';
import test from 'node:test';

import {elementsWhere, installPlainDom} from './plain_dom.mjs';

const opened = [];
installPlainDom();
Object.assign(globalThis.HTMLElement.prototype, {
  show() { opened.push(this); this.isConnected = true; },
  close() { this.isConnected = false; },
  remove() {},
  querySelectorAll: () => [],
});
const {inspectItem, inspectLevel} = await import('../../web/js/building/inspector.js');
const {Session} = await import('../../web/js/building/drawing_session.js');
const {add, addLevel, emptyPlan, removeLevel} = await import('../../web/js/building/plan.js');

function drawn() {
  const {plan} = add(emptyPlan(), 0, 'walls', {start: [0, 0], end: [4, 0]});
  return new Session(addLevel(addLevel(plan)));
}

/** The window that was opened last: its fields in their order, and its buttons. */
function lastWindow() {
  const element = opened.at(-1);
  const found = (holds) => elementsWhere(element, holds);
  return {
    fields: found(({tag}) => tag === 'input' || tag === 'select'),
    async press(text) {
      found((one) => one.tag === 'button' && one.textContent === text)[0].dispatchEvent(new Event('click'));
      await Promise.resolve();
    },
    said: () => found(({tag}) => tag === 'div').map((one) => one.textContent).join(''),
  };
}

test('the level inspector edits its own level after a lower one was deleted', async () => {
  const session = drawn();
  session.showLevel(1);
  inspectLevel(session);
  const {fields: [name], press} = lastWindow();
  session.commit(removeLevel(session.plan, 0), 'delete level');
  name.value = 'Middle';
  await press('Apply');
  assert.deepEqual(session.plan.levels.map((level) => level.name), ['Middle', 'Level 3']);
});

test('an inspector says that its level is deleted or its building closed', async () => {
  const session = drawn();
  session.showLevel(2);
  inspectLevel(session);
  const {press, said} = lastWindow();
  session.commit(removeLevel(session.plan, 2), 'delete level');
  await press('Apply');
  assert.match(said(), /the level no longer exists/);

  session.showLevel(0);
  inspectItem(session, {kind: 'walls', id: 0});
  const wall = lastWindow();
  session.open(drawn().plan);
  wall.fields[6].value = '0.3';
  await wall.press('Apply');
  assert.match(wall.said(), /the item no longer exists/);
  assert.equal(session.plan.levels[0].walls[0].thickness, 0.15);
});

test('an item is edited where its level is now', async () => {
  const session = drawn();
  session.showLevel(1);
  const ref = {kind: 'walls', id: session.level.walls[0].id};
  inspectItem(session, ref);
  const {fields, press} = lastWindow();
  session.commit(removeLevel(session.plan, 0), 'delete level');
  fields[6].value = '0.3';
  await press('Apply');
  assert.equal(session.plan.levels[0].walls[0].thickness, 0.3);
});
