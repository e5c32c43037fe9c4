/** What is in the menus: titles, hotkeys and actions, out of one place for all of them. */
import {HOTKEYS, run} from '../hotkeys.js';
import type {Actions} from '../actions.js';
import type {OverlayFlag, Store} from '../store.js';
import type {Page} from './panels.js';
import type {ThemeName} from '../ui/theme.js';
import type {Model} from '../protocol.js';
import type {Menu} from '../ui/menubar.js';
import type {MenuItem} from '../ui/popup.js';

/** The hotkey of an action, '' where it has none. */
export function keysOf(action: keyof Actions) {
  return HOTKEYS.find((row) => row.action === action)?.keys ?? '';
}

const OVERLAYS: ([OverlayFlag, string]|null)[] = [
  ['grid', 'Grid'],
  ['origin', 'Origin'],
  null,
  ['transparent', 'Transparent'],
  ['wireframe', 'Wireframe'],
  ['collisions', 'Collisions'],
  ['joints', 'Joints'],
  ['com', 'Center of Mass'],
  ['inertia', 'Inertias'],
  ['contacts', 'Contacts'],
  ['frames', 'Link Frames'],
  ['skeleton', 'Skeletons'],
  null,
  ['cameraColors', 'Colors as in Cameras'],
  ['simplifiedMeshes', 'Simplified Meshes (cameras see the full ones)'],
];

/** Those of one model: no grid, no origin, no contacts. */
const OF_A_MODEL = OVERLAYS.flatMap((row) =>
  row && !['grid', 'origin', 'contacts', 'cameraColors', 'simplifiedMeshes'].includes(row[0]) ? [row] : [],
);

/** What can be shown of the selected models alone. */
const OF_THE_SELECTION: [OverlayFlag, string][] = [
  ['joints', 'Joints of Selection'],
  ['frames', 'Link Frames of Selection'],
  ['contacts', 'Contacts of Selection'],
];

const THEMES: readonly ThemeName[] = ['auto', 'dark', 'light'];

const AXES = ['X', 'Y', 'Z'] as const;

const LINE = {separator: true};

/** The menu bar's menus. */
export function menus(page: Page): Menu[] {
  const {store, actions, theme} = page;
  const item = (title: string, action: keyof Actions, more = {}) => ({
    title,
    keys: keysOf(action),
    run: () => run(actions, action),
    ...more,
  });
  const camera = (title: string, action: keyof Actions, key: keyof Store['camera'], value: string) =>
    item(title, action, {
      checked: () => store.camera[key] === value,
    });
  const wholes = () => store.selection.some((name) => store.entity(name)?.kind !== 'link');
  return [
    {
      title: 'File',
      edits: true,
      items: () => [
        item('New World', 'newWorld'),
        item('Open World…', 'open'),
        LINE,
        item('Save World', 'save'),
        item('Save World As…', 'saveAs'),
        LINE,
        item('Recover…', 'recover'),
        LINE,
        item('Save Configuration', 'saveConfiguration'),
        item('Reset Configuration', 'resetConfiguration'),
        item('Clone World…', 'cloneWorld'),
      ],
    },
    {
      title: 'Edit',
      edits: true,
      items: () => [
        item(labelOf('Undo', store, 'undo'), 'undo', {
          enabled: () => store.history.undo.length > 0,
        }),
        item(labelOf('Redo', store, 'redo'), 'redo', {
          enabled: () => store.history.redo.length > 0,
        }),
        LINE,
        item('Copy', 'copy', {enabled: wholes}),
        item('Paste', 'paste', {enabled: () => Boolean(store.clipboard)}),
        item('Duplicate', 'duplicate', {enabled: wholes}),
        item('Array…', 'arrayOfSelection', {enabled: wholes}),
        item('Delete', 'remove', {enabled: () => store.selection.length > 0}),
        item('Select All', 'selectAll'),
        LINE,
        ...AXES.map((axis) => item(`Distribute Along ${axis}`, `distribute${axis}`, {enabled: () => store.selection.length > 2})),
        LINE,
        item('Group', 'groupSelection', {enabled: () => store.selection.length > 1}),
        item('Ungroup', 'ungroupSelection', {enabled: () => grouped(store, store.selection)}),
        LINE,
        item('Hide Selection', 'hide', {enabled: () => store.selection.length > 0}),
        item('Show Hidden', 'showHidden'),
        item('Lock or Unlock Selection', 'lock', {enabled: () => store.selection.length > 0}),
        item('Unlock All', 'unlockAll'),
        LINE,
        item('Reset Model Poses', 'resetPoses'),
        item('Reset World', 'resetWorld'),
        item('Reset Time', 'resetTime'),
        LINE,
        item('Building Editor', 'building'),
        item('Model Editor', 'modelEditor', {checked: () => Boolean(store.modelEditing)}),
      ],
    },
    {
      title: 'Camera',
      items: () => [
        camera('Orthographic', 'orthographic', 'projection', 'orthographic'),
        camera('Perspective', 'perspective', 'projection', 'perspective'),
        LINE,
        camera('FPS View Control', 'fpsControl', 'controller', 'fps'),
        camera('Orbit View Control', 'orbitControl', 'controller', 'orbit'),
        LINE,
        item('Reset View Angle', 'resetView'),
        item('Frame Selection', 'frameSelection'),
        item('Frame All Models', 'frameAll'),
        item('Copy Link to This View', 'copyLink'),
        item('Add Bookmark', 'addBookmark'),
        ...actions.bookmarks().map(({name}, at) => ({title: name, run: () => actions.goToBookmark(at)})),
        ...(actions.bookmarks().length ? [item('Clear Bookmarks', 'clearBookmarks')] : []),
        LINE,
        item('Move To Selection', 'moveTo', {enabled: () => store.selection.length > 0}),
        item('Follow Selection', 'follow', {enabled: () => store.selection.length > 0}),
      ],
    },
    {
      title: 'View',
      items: () => [
        ...OVERLAYS.map((row) => (row ? overlayItem(page, row[0], row[1]) : LINE)),
        LINE,
        {
          title: 'Sensor Data of Selection',
          checked: () => page.topics.sensing,
          run: () => page.topics.sense(!page.topics.sensing),
        },
        ...OF_THE_SELECTION.map(([flag, title]) => ({
          title,
          checked: () => store.overlays.selection[flag] === true,
          run: () => store.setOverlayOfSelection(flag, !store.overlays.selection[flag]),
        })),
      ],
    },
    {
      title: 'Window',
      items: () => [
        item('Plot', 'plot'),
        ...(store.readOnly ? [] : [item('Log Data', 'logs'), item('Joints Panel', 'joints')]),
        item('Topics', 'topics'),
        {title: 'Messages', run: () => page.notices.button.click()},
        LINE,
        item('Screenshot', 'screenshot'),
        LINE,
        {
          title: 'Show GUI Overlays',
          checked: () => !document.body.classList.contains('no-overlays'),
          run: () => document.body.classList.toggle('no-overlays'),
        },
        item('Show Toolbars', 'togglePanels', {
          checked: () => !document.body.classList.contains('bare'),
        }),
        item('Full Screen', 'fullScreen'),
        LINE,
        ...THEMES.map((name) => ({
          title: {auto: 'Theme: browser default', dark: 'Theme: dark', light: 'Theme: light'}[
            name
          ],
          checked: () => theme.get() === name,
          run: () => theme.set(name),
        })),
      ],
    },
    {title: 'Help', items: () => [item('Command Search…', 'commands'), item('Hotkey Chart', 'hotkeys'), item('About', 'about')]},
  ];
}

/** The menu text of the next step to undo or redo, with its author if that is another user. */
function labelOf(verb: string, store: Page['store'], which: 'undo'|'redo') {
  const [label] = store.history[which];
  if (!label) return verb;
  const author = store.authorOf(which);
  return `${verb}: ${label}${author && ` by ${author}`}`;
}

function overlayItem({store, actions}: Page, flag: OverlayFlag, title: string, model?: string) {
  return {
    title,
    checked: () => store.overlay(flag, model),
    run: () => actions.toggleOverlay(flag, model),
  };
}

/**
 * The right-click menu of a model, a light or a link.
 * @returns empty where nothing has the name
 */
export function contextMenu(page: Page, name: string):
    MenuItem[] {
  const {store, actions} = page;
  const entity = store.entity(name);
  if (!entity) return [];
  const light = entity.kind === 'light';
  const model = entity.model?.name;
  const whole = model ?? name;
  const chosen =
    store.selection.includes(name) && store.selection.length > 1 ? store.selection : [whole];
  const wholes = [...new Set(chosen.flatMap((one) => store.wholeOf(one) ?? []))];
  const view = light
    ? []
    : [
        {
          title: 'View',
          items: OF_A_MODEL.map(([flag, title]) => overlayItem(page, flag, title, model)),
        },
      ];
  const force = light
    ? []
    : [
        {
          title: 'Apply Force/Torque',
          run: () => actions.applyForce(name),
          enabled: () => !entity.model?.static,
        },
      ];
  const follow = [
    {title: 'Move To', run: () => actions.moveTo(name)},
    store.camera.following === whole
      ? {title: 'Stop Following', run: () => actions.follow(null)}
      : {title: 'Follow', run: () => actions.follow(whole)},
  ];
  const hide = (named: string) => (store.overlay('hidden', named) ? {title: 'Show', run: () => actions.showHidden(wholes)}
    : {title: 'Hide', keys: keysOf('hide'), run: () => actions.hide(wholes)});
  if (store.readOnly) return [...follow, ...view, hide(whole)];
  return [
    ...follow,
    ...force,
    ...(model && !isPlane(entity.model)
      ? [{title: 'Edit Model', run: () => actions.modelEditor(model), enabled: () => !store.modelEditing}] : []),
    LINE,
    ...view,
    ...(light ? [] : [LINE]),
      hide(whole),
      {title: 'Locked', keys: keysOf('lock'), checked: () => store.overlay('locked', whole), run: () => actions.lock(wholes)},
      ...(wholes.length > 1 ? [{title: 'Group', keys: keysOf('groupSelection'), run: () => actions.groupSelection()}] : []),
      ...(grouped(store, wholes)
        ? [{title: 'Ungroup', keys: keysOf('ungroupSelection'), run: () => actions.ungroupSelection()}] : []),
    LINE,
    {title: 'Copy', keys: keysOf('copy'), run: () => actions.copy(chosen)},
    {
      title: 'Paste',
      keys: keysOf('paste'),
      run: () => actions.paste(),
      enabled: () => Boolean(store.clipboard),
    },
    {
      title: chosen.length > 1 ? `Delete Selection (${chosen.length})` : 'Delete',
      keys: keysOf('remove'),
      run: () => actions.remove(chosen),
    },
  ];
}

/** Whether a member of a group is among them. */
const grouped = (store: Store, names: string[]) => names.some((name) =>
    Boolean((store.split(name)[0] ?? store.light(name))?.group));

/** A ground: nothing of it can be edited by hand. */
const isPlane = (model: Model|undefined) =>
    Boolean(model?.links.every((link) =>
  link.visuals.length && link.visuals.every(({geometry}) => geometry.type === 'plane')));
