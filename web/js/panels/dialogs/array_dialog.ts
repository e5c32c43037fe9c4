/** How many copies of the selection, and how far apart. */
import {copiesIn, MOST_COPIES} from '../../arrange.js';
import {Dialog} from '../../ui/dialog.js';
import {h} from '../../ui/dom.js';
import type {Page} from '../panels.js';

const AXES = ['X', 'Y', 'Z'];

export function arrayDialog({actions}: Pick<Page, 'actions'>) {
  const apart = actions.spacing();
  const counts = AXES.map((axis, at) => h('input', {type: 'number', min: 1, step: 1, value: at ? 1 : 3,
    autofocus: !at, 'aria-label': `Count ${axis}`}));
  const spacing = AXES.map((axis, at) => h('input', {type: 'number', step: 'any', value: apart[at],
    'aria-label': `Spacing ${axis}`}));
  const total = h('p', {class: 'soft', role: 'status'});
  const numbers = () => ({
    counts: counts.map(({valueAsNumber}) => valueAsNumber),
    spacing: spacing.map(({valueAsNumber}) => valueAsNumber),
  });
  const fault = () => {
    const {counts: cells, spacing: gaps} = numbers();
    if (!cells.every((count) => Number.isInteger(count) && count >= 1)) return 'Each count must be a whole number, 1 or more.';
    if (!gaps.every(Number.isFinite)) return 'Each spacing must be a number of metres.';
    const copies = copiesIn(cells);
    if (copies < 1) return 'Enter a count of 2 or more for one axis.';
    return copies > MOST_COPIES ? `An array has at most ${MOST_COPIES} copies.` : '';
  };
  const update = () => {
    total.textContent = fault() || `${copiesIn(numbers().counts)} copies are added.`;
  };
  for (const input of [...counts, ...spacing]) input.addEventListener('input', update);
  update();
  return new Dialog({
    title: 'Array',
    name: 'array',
    content: [h('div', {class: 'array-grid'}, h('span', {}), h('span', {text: 'Count'}), h('span', {text: 'Spacing (m)'}),
      ...AXES.flatMap((axis, at) => [h('b', {class: `axis-${axis.toLowerCase()}`, text: axis}), counts[at], spacing[at]])),
    total],
    buttons: [{title: 'Cancel'}, {title: 'Create', primary: true, run: async () => {
      if (fault()) throw new Error(fault());
      const {counts: cells, spacing: gaps} = numbers();
      const outcome = await actions.array(cells, gaps);
      if (!outcome.ok) throw new Error(outcome.issues[0]?.message);
    }}],
  }).open();
}
