/**
 * Arrow keys drive the selected robot while they are held: velocities on the topic that it hears,
 * and a stop when the keys are released, the window loses the focus, or another model is selected.
 */
import {modelOfSelection} from './selected_model.js';
import type {Actions} from './actions.js';
import type {Store} from './store.js';

/** m/s, rad/s */
export type DriveSpeeds = {speed: number, turn: number};

const KEYS = new Map([
  ['ArrowUp', [1, 0]], ['ArrowDown', [-1, 0]], ['ArrowLeft', [0, 1]], ['ArrowRight', [0, -1]],
]);
/** Twice as fast as the server's patience asks for, and more. */
const PERIOD = 100;
/** A slow walk indoors; small robots reach it, large ones do not run away. */
const SPEED = 0.3;
const TURN = 0.8;
const FASTER = 2;

/** Focused elements that need the arrows for themselves. */
const OWNERS = 'input, textarea, select, [contenteditable="true"], [role="tree"], [role="menu"], ' +
  '[role="menubar"], [role="menuitem"], [role="tablist"], [role="toolbar"], [role="listbox"], ' +
  '[role="separator"], [role="grid"], dialog, [role="dialog"]';

/** Forward speed and yaw rate for keys that are held. */
export function commandOf(held: Iterable<string>, fast: boolean, {speed, turn}: DriveSpeeds) {
  let [forward, yaw] = [0, 0];
  for (const key of held) {
    const [x, z] = KEYS.get(key) ?? [0, 0];
    forward += x;
    yaw += z;
  }
  const factor = fast ? FASTER : 1;
  return {linear: [forward * speed * factor, 0, 0], angular: [0, 0, yaw * turn * factor]};
}

/** Listens to the arrow keys. */
export function mountDriving(target: Window, {store, actions}: {store: Store, actions: Actions}):
    {speeds: DriveSpeeds, stop: () => void} {
  const speeds = {speed: SPEED, turn: TURN};
  const held: Set<string> = new Set();
  let fast = false;
  let driven: string|null = null;
  let timer: ReturnType<typeof setInterval>|undefined;

  const tell = async () => {
    const model = driven;
    if (!model) return;
    // One word about a model that cannot be driven is enough.
    const {ok} = await actions.drive(model, commandOf(held, fast, speeds));
    if (!ok && driven === model) end();
  };
  const end = () => {
    clearInterval(timer);
    timer = undefined;
    held.clear();
    driven = null;
  };
  const stop = () => {
    if (!driven) return;
    held.clear();
    tell();
    end();
  };
  const pressed = (event: KeyboardEvent) => {
    if (!KEYS.has(event.key) || event.defaultPrevented || event.ctrlKey || event.altKey ||
        event.metaKey || ownsArrows(event.target)) return;
    const model = modelOfSelection(store);
    if (!model || model.static) return;
    event.preventDefault();
    const changed = !held.has(event.key) || fast !== event.shiftKey;
    if (event.repeat && !driven) return;
    driven = model.name;
    fast = event.shiftKey;
    held.add(event.key);
    if (changed) tell();
    timer ??= setInterval(tell, PERIOD);
  };
  const released = (event: KeyboardEvent) => {
    if (event.key === 'Shift') fast = false;
    if (!held.delete(event.key)) return;
    if (held.size) tell();
    else stop();
  };
  const selected = () => {
    if (driven && modelOfSelection(store)?.name !== driven) stop();
  };
  target.addEventListener('keydown', pressed);
  target.addEventListener('keyup', released);
  target.addEventListener('blur', stop);
  store.listen('selection', selected);
  store.listen('connection', () => {
    // The server has stopped the robot when the line broke.
    if (!store.connected) end();
  });
  return {speeds, stop};
}

function ownsArrows(element: EventTarget|null) {
  return typeof Element !== 'undefined' && element instanceof Element &&
    element.closest(OWNERS) !== null;
}
