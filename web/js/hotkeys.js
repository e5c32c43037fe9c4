/** Hotkeys: one table for the keyboard and for the chart that explains them. */

/**
 * `action` names a function of actions.js; a row without one tells of a key that is held or of the
 * mouse. Ctrl+N and Ctrl+T belong to the browser: New is Alt+N here.
 * @type {readonly {keys: string, title: string, group: string, action?: string}[]}
 */
export const HOTKEYS = Object.freeze([
  {keys: 'Alt+N', title: 'New world', group: 'File', action: 'newWorld'},
  {keys: 'Ctrl+O', title: 'Open world', group: 'File', action: 'open'},
  {keys: 'Ctrl+S', title: 'Save world', group: 'File', action: 'save'},
  {keys: 'Ctrl+Shift+S', title: 'Save world as', group: 'File', action: 'saveAs'},
  {keys: 'Ctrl+Z', title: 'Undo', group: 'Edit', action: 'undo'},
  {keys: 'Ctrl+Shift+Z', title: 'Redo', group: 'Edit', action: 'redo'},
  {keys: 'Ctrl+Y', title: 'Redo', group: 'Edit', action: 'redo'},
  {keys: 'Ctrl+C', title: 'Copy', group: 'Edit', action: 'copy'},
  {keys: 'Ctrl+V', title: 'Paste', group: 'Edit', action: 'paste'},
  {keys: 'Ctrl+A', title: 'Select all models', group: 'Edit', action: 'selectAll'},
  {keys: 'Ctrl+F', title: 'Find a model or light', group: 'Edit', action: 'find'},
  {keys: 'F2', title: 'Rename', group: 'Edit', action: 'renameSelected'},
  {keys: 'Delete', title: 'Delete what is selected', group: 'Edit', action: 'remove'},
  {keys: 'Ctrl+Shift+R', title: 'Reset model poses', group: 'Edit', action: 'resetPoses'},
  {keys: 'Ctrl+R', title: 'Reset world', group: 'Edit', action: 'resetWorld'},
  {keys: 'Ctrl+B', title: 'Building editor', group: 'Edit', action: 'building'},
  {keys: 'Escape', title: 'Select; cancel; drop the selection', group: 'Tools', action: 'escape'},
  {keys: 'T', title: 'Translate', group: 'Tools', action: 'translateMode'},
  {keys: 'R', title: 'Rotate', group: 'Tools', action: 'rotateMode'},
  {keys: 'S', title: 'Scale', group: 'Tools', action: 'scaleMode'},
  {keys: 'N', title: 'Snap a face to another', group: 'Tools', action: 'snapMode'},
  {keys: 'X, Y, Z held', title: 'Drag along, or turn about, that axis only', group: 'Tools'},
  {keys: 'Ctrl held', title: 'Snap to 1 m, 45 degrees, 1 m of size', group: 'Tools'},
  {keys: 'Shift held', title: 'World axes; all sizes alike when scaling', group: 'Tools'},
  {keys: 'Ctrl+click', title: 'Select one more, or one less', group: 'Tools'},
  {keys: 'Space', title: 'Play or pause', group: 'Time', action: 'togglePlay'},
  {keys: 'Drag', title: 'Move the view (walking: look round)', group: 'Camera'},
  {keys: 'Shift+drag, middle drag', title: 'Turn about the point under the mouse',
    group: 'Camera'},
  {keys: 'Wheel, right drag', title: 'Zoom to the point under the mouse', group: 'Camera'},
  {keys: 'Double click', title: 'Fly to what is under the mouse', group: 'Camera'},
  {keys: 'W A S D', title: 'Walk, with first-person control', group: 'Camera'},
  {keys: 'Home', title: 'First view', group: 'Camera', action: 'resetView'},
  {keys: 'Shift held', title: 'No snapping while drawing', group: 'Building editor'},
  {keys: '0-9, Enter', title: 'Length of the wall being drawn', group: 'Building editor'},
  {keys: 'Alt held', title: 'Pull one end off its link', group: 'Building editor'},
  {keys: 'F, G', title: 'Show or hide floor plan, features', group: 'Building editor'},
  {keys: 'Ctrl+X', title: 'Leave the building editor', group: 'Building editor'},
  {keys: 'Ctrl+D', title: 'Log data', group: 'Window', action: 'logs'},
  {keys: 'Ctrl+P', title: 'Plot', group: 'Window', action: 'plot'},
  {keys: 'Ctrl+H', title: 'Show or hide the panels', group: 'Window', action: 'togglePanels'},
  {keys: 'F6', title: 'Next part of the window', group: 'Window', action: 'nextRegion'},
  {keys: 'Shift+F6', title: 'Part of the window before', group: 'Window',
    action: 'previousRegion'},
  {keys: 'F11', title: 'Full screen', group: 'Window', action: 'fullScreen'},
  {keys: 'F1', title: 'This chart', group: 'Help', action: 'hotkeys'},
]);

const NAMES = {' ': 'Space', Esc: 'Escape', Del: 'Delete'};

/**
 * The spelling of a key press in the table.
 * @param {{key: string, ctrlKey?: boolean, metaKey?: boolean, shiftKey?: boolean,
 *          altKey?: boolean}} event
 */
export function spelled(event) {
  const key = NAMES[event.key] ?? (event.key.length === 1 ? event.key.toUpperCase() : event.key);
  return [
    event.ctrlKey || event.metaKey ? 'Ctrl' : '', event.altKey ? 'Alt' : '',
    event.shiftKey ? 'Shift' : '', key,
  ].filter(Boolean).join('+');
}

const BY_KEYS = new Map(HOTKEYS.filter((row) => row.action).map((row) => [row.keys, row]));

/** The row of the table that a key press means, or undefined. */
export const hotkey = (event) => BY_KEYS.get(spelled(event));

/** Keys that a focused control needs for itself. */
function belongsToControl(event) {
  const {target} = event;
  if (!target?.closest) return false;
  if (target.closest('dialog, [role="dialog"]')) return true;
  if (target.closest('input, textarea, select, [contenteditable="true"]')) {
    return !(event.ctrlKey || event.metaKey) || 'acvxyz'.includes(event.key.toLowerCase());
  }
  return event.key === ' ' && target.closest('button, [role="button"], [role="menuitem"], summary');
}

/**
 * Listens to the keyboard.
 * @param {Window} target
 * @param {{store: any, actions: any}} parts
 * @returns {() => void} stops listening
 */
export function mountKeys(target, {store, actions}) {
  const pressed = (event) => {
    const row = hotkey(event);
    // Walking has the keys W, A, S and D.
    if (row?.keys === 'S' && store.camera.controller === 'fps') return;
    if (!row || event.defaultPrevented || belongsToControl(event)) return;
    event.preventDefault();
    if (!event.repeat || row.action === 'undo' || row.action === 'redo') actions[row.action]();
  };
  target.addEventListener('keydown', pressed);
  return () => target.removeEventListener('keydown', pressed);
}
