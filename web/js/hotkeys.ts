/** Hotkeys: one table for the keyboard and for the chart that explains them. */
import type {Actions} from './actions.js';
import type {Store} from './store.js';

export interface Hotkey {
  keys: string;
  title: string;
  group: string;
  /**
   * the function of actions.js that it calls; a row without one
   * describes a key that is held, or the mouse
   */
  action?: keyof Actions;
  /** works only while something is being placed */
  placing?: boolean;
}

/** Ctrl+N and Ctrl+T belong to the browser: New is Alt+N here, Topics Alt+T. */
export const HOTKEYS: readonly Hotkey[] = Object.freeze([
  {keys: 'Alt+N', title: 'New world', group: 'File', action: 'newWorld'},
  {keys: 'Ctrl+O', title: 'Open world', group: 'File', action: 'open'},
  {keys: 'Ctrl+S', title: 'Save world', group: 'File', action: 'save'},
  {keys: 'Ctrl+Shift+S', title: 'Save world as', group: 'File', action: 'saveAs'},
  {keys: 'Ctrl+Z', title: 'Undo', group: 'Edit', action: 'undo'},
  {keys: 'Ctrl+Shift+Z', title: 'Redo', group: 'Edit', action: 'redo'},
  {keys: 'Ctrl+Y', title: 'Redo', group: 'Edit', action: 'redo'},
  {keys: 'Ctrl+C', title: 'Copy', group: 'Edit', action: 'copy'},
  {keys: 'Ctrl+V', title: 'Paste', group: 'Edit', action: 'paste'},
  {keys: 'Ctrl+D', title: 'Duplicate', group: 'Edit', action: 'duplicate'},
  {keys: 'Ctrl+G', title: 'Group selected models', group: 'Edit', action: 'groupSelection'},
  {keys: 'Ctrl+Shift+G', title: 'Ungroup selected models', group: 'Edit', action: 'ungroupSelection'},
  {keys: 'H', title: 'Hide selected models', group: 'Edit', action: 'hide'},
  {keys: 'Alt+H', title: 'Show what is hidden', group: 'Edit', action: 'showHidden'},
  {keys: 'L', title: 'Lock or unlock selected models', group: 'Edit', action: 'lock'},
  {keys: 'Ctrl+A', title: 'Select all models', group: 'Edit', action: 'selectAll'},
  {keys: 'Ctrl+F', title: 'Find a model or light', group: 'Edit', action: 'find'},
  {keys: 'F2', title: 'Rename', group: 'Edit', action: 'renameSelected'},
  {keys: 'Delete', title: 'Delete selection', group: 'Edit', action: 'remove'},
  {keys: 'Ctrl+Shift+R', title: 'Reset model poses', group: 'Edit', action: 'resetPoses'},
  {keys: 'Ctrl+R', title: 'Reset world', group: 'Edit', action: 'resetWorld'},
  {keys: 'Ctrl+B', title: 'Building editor', group: 'Edit', action: 'building'},
  {keys: 'Ctrl+M', title: 'Model editor', group: 'Edit', action: 'modelEditor'},
  {keys: 'Ctrl+E', title: 'Schematic view of the model editor', group: 'Edit', action: 'schematic'},
  {keys: 'Escape', title: 'Select mode; cancel; clear selection', group: 'Tools', action: 'escape'},
  {keys: 'T', title: 'Translate', group: 'Tools', action: 'translateMode'},
  {keys: 'R', title: 'Rotate', group: 'Tools', action: 'rotateMode'},
  {keys: 'S', title: 'Scale', group: 'Tools', action: 'scaleMode'},
  {keys: 'N', title: 'Snap a face to another face', group: 'Tools', action: 'snapMode'},
  {keys: 'M', title: 'Measure distances and angles', group: 'Tools', action: 'measureMode'},
  {keys: 'Ctrl+drag', title: 'Select what is in a rectangle', group: 'Tools'},
  {keys: 'X, Y, Z held', title: 'Constrain to the X, Y or Z axis', group: 'Tools'},
  {keys: 'Ctrl held', title: 'Snap to 1 m or 45 degrees', group: 'Tools'},
  {keys: 'Shift held', title: 'World frame; uniform scale', group: 'Tools'},
  {keys: 'Ctrl+click', title: 'Add to or remove from selection', group: 'Tools'},
  {keys: 'Enter', title: 'Inserting: place at the mouse, or in the middle of the view', group: 'Tools', action: 'placeHere', placing: true},
  {keys: 'Q', title: 'Inserting: turn left by 15°', group: 'Tools', action: 'turnLeft', placing: true},
  {keys: 'E', title: 'Inserting: turn right by 15°', group: 'Tools', action: 'turnRight', placing: true},
  {keys: 'Shift+Q', title: 'Inserting: turn left by 90°', group: 'Tools', action: 'quarterLeft', placing: true},
  {keys: 'Shift+E', title: 'Inserting: turn right by 90°', group: 'Tools', action: 'quarterRight', placing: true},
  {keys: 'Space', title: 'Play or pause', group: 'Time', action: 'togglePlay'},
  {keys: 'Drag', title: 'Pan (FPS control: look around)', group: 'Camera'},
  {keys: 'Shift+drag, middle drag', title: 'Orbit around the point under the cursor',
    group: 'Camera'},
  {keys: 'Wheel, right drag', title: 'Zoom to the point under the cursor', group: 'Camera'},
  {keys: 'Double click', title: 'Move to the object under the cursor', group: 'Camera'},
  {keys: 'W A S D', title: 'Move, with FPS view control', group: 'Camera'},
  {keys: 'Alt+B', title: 'Keep this camera as a bookmark', group: 'Camera', action: 'addBookmark'},
  {keys: 'Alt+L', title: 'Copy a link to this view', group: 'Camera', action: 'copyLink'},
  {keys: 'Touch', title: 'One finger orbits, two pan and zoom; a long press opens the menu',
    group: 'Camera'},
  {keys: 'F', title: 'Frame selection', group: 'Camera', action: 'frameSelection'},
  {keys: 'Shift+F', title: 'Frame all models', group: 'Camera', action: 'frameAll'},
  {keys: 'Home', title: 'Reset view', group: 'Camera', action: 'resetView'},
  {keys: 'Arrow keys, Space', title: 'Move the cursor of the plan, click there', group: 'Building editor'},
  {keys: 'Shift held', title: 'Disable snapping while drawing', group: 'Building editor'},
  {keys: '0-9, Enter', title: 'Enter the length of the wall', group: 'Building editor'},
  {keys: 'Alt held', title: 'Detach the end of a wall from linked walls', group: 'Building editor'},
  {keys: 'F, G', title: 'Show or hide floor plan (F), features (G)', group: 'Building editor'},
  {keys: 'Ctrl+X', title: 'Exit building editor', group: 'Building editor'},
  {keys: 'Arrow keys', title: 'Drive the selected robot; with Shift twice as fast', group: 'Robots'},
  {keys: 'Alt+T', title: 'Topics', group: 'Window', action: 'topics'},
  {keys: 'Alt+R', title: 'Log data', group: 'Window', action: 'logs'},
  {keys: 'Ctrl+P', title: 'Plot', group: 'Window', action: 'plot'},
  {keys: 'Ctrl+H', title: 'Show or hide panels', group: 'Window', action: 'togglePanels'},
  {keys: 'F6', title: 'Focus next panel', group: 'Window', action: 'nextRegion'},
  {keys: 'Shift+F6', title: 'Focus previous panel', group: 'Window',
    action: 'previousRegion'},
  {keys: 'F11', title: 'Full screen', group: 'Window', action: 'fullScreen'},
  {keys: 'Ctrl+K', title: 'Search all commands', group: 'Help', action: 'commands'},
  {keys: 'F1', title: 'Hotkey chart', group: 'Help', action: 'hotkeys'},
]);

/** A key that is held goes on with them. */
const REPEATED: (keyof Actions)[] = ['undo', 'redo', 'turnLeft', 'turnRight'];
const READ_ONLY_GROUPS = ['Camera', 'Window', 'Help'];
const READ_ONLY_ACTIONS: (keyof Actions)[] = ['hide', 'showHidden', 'selectAll', 'find', 'escape', 'measureMode'];

/** Whether a row works in a page that cannot edit the world. */
export const isReading = ({group, action}: Hotkey) => action !== 'logs' && (
  READ_ONLY_GROUPS.includes(group) || Boolean(action && READ_ONLY_ACTIONS.includes(action)));

const NAMES: Record<string, string> = {' ': 'Space', Esc: 'Escape', Del: 'Delete'};

/** The spelling of a key press in the table. */
export function spelled(event: {key: string, ctrlKey?: boolean, metaKey?: boolean, shiftKey?: boolean,
    altKey?: boolean}) {
  const key = NAMES[event.key] ?? (event.key.length === 1 ? event.key.toUpperCase() : event.key);
  return [
    event.ctrlKey || event.metaKey ? 'Ctrl' : '', event.altKey ? 'Alt' : '',
    event.shiftKey ? 'Shift' : '', key,
  ].filter(Boolean).join('+');
}

const BY_KEYS = new Map(HOTKEYS.filter((row) => row.action).map((row) => [row.keys, row]));

/** Calls an action without arguments, as keys, menus and buttons do. */
export function run(actions: Actions, name: keyof Actions|undefined) {
  if (name) (actions[name] as () => unknown)();
}

/** The row of the table that a key press means, or undefined. */
export const hotkey = (event: KeyboardEvent) => BY_KEYS.get(spelled(event));

/** Keys that a focused control needs for itself. */
export function belongsToControl(event: KeyboardEvent) {
  const {target} = event;
  if (!(target instanceof Element)) return false;
  if (target.closest('dialog, [role="dialog"]') || document.querySelector('dialog:modal')) return true;
  // No field types anything with F6, which leaves it.
  if (/^F\d+$/.test(event.key)) return false;
  // A check box needs the space bar alone.
  if (target.closest('input[type="checkbox"]')) return event.key === ' ';
  if (target.closest('input, textarea, select, [contenteditable="true"]')) {
    return !(event.ctrlKey || event.metaKey) || 'acvxyz'.includes(event.key.toLowerCase());
  }
  return event.key === ' ' &&
    target.closest('button, [role="button"], [role="menuitem"], summary') !== null;
}

/**
 * Listens to the keyboard.
 * @returns stops listening
 */
export function mountKeys(target: Window, {store, actions}: {store: Store, actions: Actions}): () =>
    void {
  const pressed = (event: KeyboardEvent) => {
    const row = hotkey(event);
    // Walking has the keys W, A, S and D.
    if (row?.keys === 'S' && store.camera.controller === 'fps') return;
    if (row?.placing && !store.placing) return;
    if (!row || event.defaultPrevented || belongsToControl(event)) return;
    if (store.readOnly && !isReading(row)) return event.preventDefault();
    event.preventDefault();
    if (!event.repeat || row.action && REPEATED.includes(row.action)) run(actions, row.action);
  };
  target.addEventListener('keydown', pressed);
  return () => target.removeEventListener('keydown', pressed);
}
