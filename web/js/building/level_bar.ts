/** The bar above the sheet: levels, what is shown, zoom. */
import {fill, h, textButton} from '../ui/dom.js';
import {inspectLevel} from './inspector.js';
import {addLevel, bases, removeLevel} from './plan.js';
import type {Session} from './drawing_session.js';
import type {Canvas} from './plan_canvas.js';

/** Adds a level on top and goes there. */
export function newLevel(session: Session) {
  const plan = addLevel(session.history.plan);
  if (!plan) {
    session.say('Draw a wall first; a new level copies the walls of the level below.');
    return;
  }
  session.commit(plan, 'add level');
  session.showLevel(plan.levels.length - 1);
}

/** Deletes the level being drawn with all in it. */
export function dropLevel(session: Session) {
  const plan = removeLevel(session.history.plan, session.at);
  if (!plan) {
    session.say('The only level cannot be deleted.');
    return;
  }
  session.commit(plan, 'delete level');
  session.showLevel(session.at);
}

export function mountLevels(element: HTMLElement, {session,
    canvas}: {session: Session,
    canvas: Canvas}) {
  const choice = h('select', {'aria-label': 'Level', onchange: () => { session.showLevel(Number(choice.value)); }});
  const button = (text: string, title: string, run: () => void) => textButton(text, run, {title, 'aria-label': title});
  const check = (what: keyof Session['shown'], text: string) => {
    const box = h('input', {type: 'checkbox', checked: true, onchange: () => { session.show(what, box.checked); }});
    return {what, box, label: h('label', {title: text}, box, text)};
  };
  const shown = [check('image', 'Floor plan (F)'), check('features', 'Features (G)')];
  const less = button('−', 'Delete level', () => dropLevel(session));
  fill(element, h('span', {text: 'Level'}), choice, button('+', 'Add level', () => newLevel(session)), less,
    button('…', 'Level inspector', () => inspectLevel(session)),
    ...shown.map(({label}) => label), h('span', {class: 'spring'}),
    button('−', 'Zoom out', () => zoom(1 / 1.15)), button('+', 'Zoom in', () => zoom(1.15)),
    button('Fit', 'Show all', () => canvas.fit()));
  const zoom = (factor: number) => {
    const box = canvas.element.getBoundingClientRect();
    canvas.zoomAt(box.left + box.width / 2, box.top + box.height / 2, factor);
  };
  let listed = '';
  const update = () => {
    const heights = bases(session.plan);
    const words = session.plan.levels.map(({name}, at) => `${name} (${heights[at].toFixed(2)} m)`);
    if (words.join('\n') !== listed) {
      listed = words.join('\n');
      fill(choice, ...words.map((text, value) => h('option', {value, text})));
    }
    choice.value = String(session.at);
    less.disabled = session.plan.levels.length < 2;
    for (const {what, box} of shown) box.checked = session.shown[what];
  };
  session.listen('change', update);
  update();
}
