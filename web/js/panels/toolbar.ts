/** The tool bar: Gazebo's buttons from left to right, with its drop-downs. */
import {closestTo, elementsOf, fill, h, roving} from '../ui/dom.js';
import {run} from '../hotkeys.js';
import {iconButton} from '../ui/icons.js';
import {closePopup, openPopup} from '../ui/popup.js';
import {Video} from './video_recorder.js';
import type {Actions} from '../actions.js';
import type {LightType, ShapeName} from '../new_entities.js';
import type {Mode} from '../store.js';
import type {Page} from './panels.js';
import type {AlignChoice} from '../align.js';

const MODES: [Mode, keyof Actions, string, string][] = [
  ['select', 'selectMode', 'select', 'Select (Esc)'],
  ['translate', 'translateMode', 'translate', 'Translate (T)'],
  ['rotate', 'rotateMode', 'rotate', 'Rotate (R)'],
  ['scale', 'scaleMode', 'scale', 'Scale (S)'],
];
const SHAPES: [ShapeName, string][] = [
  ['box', 'Box'],
  ['sphere', 'Sphere'],
  ['cylinder', 'Cylinder'],
];
const LIGHTS: [LightType, string][] = [
  ['point', 'Point light'],
  ['spot', 'Spot light'],
  ['directional', 'Directional light'],
];
const AXES = ['x', 'y', 'z'] as const;
const EDGES = ['min', 'center', 'max'] as const;
const VIEWS = ['top', 'bottom', 'front', 'back', 'left', 'right', 'home'] as const;

export function mountToolBar(element: HTMLElement, page: Page) {
  const {store, actions} = page;
  const line = (more = '') => h('span', {class: `tool-line ${more}`, role: 'separator'});

  const modes = MODES.map(([mode, action, glyph, title]) =>
    iconButton(glyph, title, () => run(actions, action), 18, {role: 'radio', dataset: {mode}}),
  );
  const undo = iconButton('undo', 'Undo (Ctrl+Z)', () => actions.undo());
  const redo = iconButton('redo', 'Redo (Shift+Ctrl+Z)', () => actions.redo());
  const undoList = arrow('Undo history', (anchor) => historyList(page, 'undo', anchor));
  const redoList = arrow('Redo history', (anchor) => historyList(page, 'redo', anchor));
  const shapes = SHAPES.map(([shape, title]) =>
    iconButton(shape, title, () => actions.insertShape(shape)),
  );
  const lights = LIGHTS.map(([type, title]) =>
    iconButton(type, title, () => actions.insertLight(type)),
  );
  const copy = iconButton('copy', 'Copy (Ctrl+C)', () => actions.copy());
  const paste = iconButton('paste', 'Paste (Ctrl+V)', () => actions.paste());
  const align = iconButton('align', 'Align', () => {
    openPopup(alignPanel(page), {anchor: align, onClose: () => actions.alignPreview(null)});
    focusFirst('.popup input');
  });
  const snap = iconButton('snap', 'Snap (N)', () => actions.snapMode());
  const measure = iconButton('measure', 'Measure (M)', () => actions.measureMode());
  const views = iconButton('views', 'View angle', () => {
    openPopup(viewPanel(page, closePopup), {anchor: views});
    focusFirst('.popup button');
  });
  const camera = iconButton('camera', 'Screenshot', () => actions.screenshot());
  const record = iconButton('video', 'Record video', () => video.toggle());
  const video = new Video(page, () => {
    record.setAttribute('aria-pressed', String(video.recording));
    record.title = video.recording ? 'Stop recording and save video' : 'Record video';
  });
  const log = iconButton('log', 'Log data (Alt+R)', () => actions.logs());
  const plot = iconButton('plot', 'Plot (Ctrl+P)', () => actions.plot());
  const joints = iconButton('joints', 'Joints panel', () => actions.joints());
  const topics = iconButton('topics', 'Topics (Alt+T)', () => actions.topics());

  fill(
    element,
    h('span', {role: 'radiogroup', 'aria-label': 'Mode', class: 'tool-group edits'}, ...modes),
    line('edits'),
    undo,
    undoList,
    redo,
    redoList,
    line('edits'),
    ...shapes,
    line('edits'),
    ...lights,
    line('edits'),
    copy,
    paste,
    line('edits'),
    align,
    snap,
    measure,
    line(),
    views,
    h('span', {class: 'spring'}),
    camera,
    record,
    log,
    plot,
    joints,
    topics,
  );
  for (const button of [undo, undoList, redo, redoList, ...shapes, ...lights, copy, paste, align, snap, log, joints]) {
    button.classList.add('edits');
  }
  const rove = roving(element, 'button');

  const update = () => {
    for (const mode of modes) {
      mode.setAttribute('aria-checked', String(store.mode === mode.dataset.mode));
    }
    snap.setAttribute('aria-pressed', String(store.mode === 'snap'));
    measure.setAttribute('aria-pressed', String(store.mode === 'measure'));
    for (const {list, one, many} of [
      {list: store.history.undo, one: undo, many: undoList},
      {list: store.history.redo, one: redo, many: redoList},
    ]) {
      one.disabled = many.disabled = !list.length;
    }
    const title = (which: 'undo'|'redo', verb: string, keys: string) => {
      const [label] = store.history[which];
      return label ? `${verb} ${label}${authorSuffix(store, which, 0)} (${keys})` : `${verb} (${keys})`;
    };
    undo.title = title('undo', 'Undo', 'Ctrl+Z');
    redo.title = title('redo', 'Redo', 'Shift+Ctrl+Z');
    copy.disabled = !store.selection.some((name) => store.entity(name)?.kind !== 'link');
    paste.disabled = !store.clipboard;
    align.disabled = store.selection.length < 2;
    const placing = store.placing;
    SHAPES.forEach(([shape], at) =>
      shapes[at].setAttribute('aria-pressed', String(placing?.shape === shape)),
    );
    LIGHTS.forEach(([type], at) =>
      lights[at].setAttribute(
        'aria-pressed',
        String(placing?.kind === 'light' && !placing.items && placing.document.type === type),
      ),
    );
    if (!element.querySelector('button[tabindex="0"]:not(:disabled)')) rove.settle();
  };
  for (const event of [
    'mode',
    'history',
    'selection',
    'clipboard',
    'placing',
    'document',
    'entity',
    'people',
  ] as const) {
    store.listen(event, update);
  }
  update();
}

function arrow(title: string, open: (anchor: HTMLElement) => void) {
  const button = iconButton('down', title, () => open(button), 12, {class: 'narrow', 'aria-haspopup': 'menu'});
  return button;
}

/** ` by NAME` if another user made this step of the history, else ''. */
function authorSuffix(store: Page['store'], which: 'undo'|'redo', at: number) {
  const author = store.authorOf(which, at);
  return author ? ` by ${author}` : '';
}

/** The history in words: choosing an entry undoes or redoes all steps up to it. */
function historyList({store, actions}: Page, which: 'undo'|'redo', anchor: HTMLElement) {
  const labels = store.history[which];
  const items = labels.map((label, at) =>
    h(
      'button',
      {
        class: 'menu-item',
        role: 'menuitem',
        onclick: () => {
          closePopup();
          actions[which](at);
        },
      },
      h('span', {class: 'menu-title', text: label}),
      h('span', {class: 'soft', text: authorSuffix(store, which, at)}),
    ),
  );
  const list = h(
    'div',
    {class: 'menu history', role: 'menu', 'aria-label': `${which} history`},
    ...items,
  );
  const mark = (item: Element|null) =>
    items.forEach((one, at) => one.classList.toggle('included', at <= items.findIndex((other) => other === item)));
  list.addEventListener('focusin', (event) => mark(closestTo(event, 'button')));
  list.addEventListener('pointermove', (event) => closestTo(event, 'button')?.focus());
  roving(list, 'button', {vertical: true});
  openPopup(list, {anchor});
  items[0]?.focus();
}

/** Align: Min, Center, Max for each axis; hovering shows what would be, a click does it. */
function alignPanel({store, actions}: Page) {
  const reverse = h('input', {type: 'checkbox'});
  const relative = h(
    'select',
    {'aria-label': 'Relative to'},
    h('option', {value: 'first', text: 'First selected'}),
    h('option', {value: 'last', text: 'Last selected'}),
  );
  const choice = (axis: 'x'|'y'|'z', at: 'min'|'center'|'max'): AlignChoice => ({
    axis, at, reverse: reverse.checked, relative: relative.value === 'last' ? 'last' : 'first',
  });
  const cell = (axis: 'x'|'y'|'z', at: 'min'|'center'|'max') => {
    const preview = () => actions.alignPreview(choice(axis, at));
    const end = () => actions.alignPreview(null);
    return h('button', {
      text: {min: 'Min', center: 'Center', max: 'Max'}[at],
      'aria-label': `Align ${axis.toUpperCase()} ${at}`,
      onpointerenter: preview,
      onpointerleave: end,
      onfocus: preview,
      onblur: end,
      onclick: () => actions.align(choice(axis, at)),
    });
  };
  return h(
    'div',
    {class: 'align-panel', role: 'dialog', 'aria-label': 'Align'},
    h(
      'div',
      {class: 'align-grid'},
      ...AXES.flatMap((axis) => [
        h('b', {class: `axis-${axis}`, text: axis.toUpperCase()}),
        ...EDGES.map((at) => cell(axis, at)),
      ]),
    ),
    h('label', {}, reverse, 'Reverse'),
    h('label', {}, 'Relative to ', relative),
    !store.stats.paused &&
      h('p', {class: 'soft', text: 'Pause the simulation before aligning.'}),
  );
}

function viewPanel({store, actions}: Page, close: () => void) {
  const run = (action: () => void) => () => {
    close();
    action();
  };
  const title = (side: string) => side[0].toUpperCase() + side.slice(1);
  const projection = (name: 'perspective'|'orthographic') =>
    h('button', {
      text: title(name),
      'aria-pressed': String(store.camera.projection === name),
      onclick: run(() => actions.setProjection(name)),
    });
  const panel = h(
    'div',
    {class: 'view-panel', role: 'dialog', 'aria-label': 'View angle'},
    h(
      'div',
      {class: 'view-grid'},
      ...VIEWS.map((side) =>
        h('button', {
          text: title(side),
          onclick: run(() => actions.viewFrom(side)),
        }),
      ),
    ),
    h('div', {class: 'view-grid two'}, projection('perspective'), projection('orthographic')),
  );
  roving(panel, 'button');
  return panel;
}

/** Puts the focus on the first element that matches. */
function focusFirst(selector: string) {
  elementsOf(document, selector)[0]?.focus();
}
