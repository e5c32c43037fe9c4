/** Mouse and keyboard on the sheet, handed to the tool in metres of the plan. */
import {belongsToControl, hotkey} from '../hotkeys.js';
import {isDown} from '../mouse_buttons.js';
import {isModalOpen} from '../ui/dialog.js';
import {closestTo} from '../ui/dom.js';
import {menuList, openPopup} from '../ui/popup.js';
import {hitOf} from './hit_test.js';
import {inspectItem, inspectLevel} from './inspector.js';
import {dropLevel, newLevel} from './level_bar.js';
import {itemOfLink} from './plan.js';
import {paintable, PaintTool} from './select_tool.js';
import {NAMES} from './drawing_session.js';
import type {Actions} from '../actions.js';
import type {Ref} from './plan.js';
import type {Session} from './drawing_session.js';
import type {FileCommands} from './building_editor.js';
import type {Canvas} from './plan_canvas.js';

export function listenToMouse({session, canvas,
    draw}: {session: Session, canvas: Canvas,
    draw: () => void}) {
  const sheet = canvas.element;
  const mouseOf = (event: MouseEvent) => ({
    point: canvas.toPlan(event.clientX, event.clientY), shift: event.shiftKey, alt: event.altKey,
    ctrl: event.ctrlKey || event.metaKey, tolerance: canvas.tolerance,
  });
  let panning: [number, number]|null = null;
  let drawing = false;
  const released = (event: PointerEvent) => {
    if (!isDown(event, 1)) panning = null;
    if (!drawing || isDown(event, 0)) return;
    drawing = false;
    session.tool.release(mouseOf(event));
    draw();
  };
  sheet.addEventListener('pointerdown', (event) => {
    sheet.focus({preventScroll: true});
    sheet.setPointerCapture(event.pointerId);
    if (event.button === 1) {
      event.preventDefault();
      panning = [event.clientX, event.clientY];
    } else if (event.button === 0) {
      drawing = true;
      session.tool.press(mouseOf(event));
    }
    draw();
  });
  sheet.addEventListener('pointermove', (event) => {
    released(event);
    if (panning) {
      canvas.pan(event.clientX - panning[0], event.clientY - panning[1]);
      panning = [event.clientX, event.clientY];
      return;
    }
    session.tool.move(mouseOf(event));
  });
  sheet.addEventListener('pointerup', (event) => {
    released(event);
    draw();
  });
  sheet.addEventListener('pointercancel', () => {
    panning = null;
    drawing = false;
    session.tool.cancel();
  });
  sheet.addEventListener('dblclick', (event) => {
    if (session.tool.name !== 'select') {
      session.tool.double(mouseOf(event));
      return;
    }
    const hit = hitAt(event);
    if (hit) inspectItem(session, hit.ref);
    else inspectLevel(session);
  });
  sheet.addEventListener('wheel', (event) => {
    event.preventDefault();
    canvas.zoomAt(event.clientX, event.clientY, event.deltaY < 0 ? 1.15 : 1 / 1.15);
  }, {passive: false});
  sheet.addEventListener('contextmenu', (event) => {
    event.preventDefault();
    // A tool at work: the right button drops what it does and ends it.
    if (session.tool.name !== 'select') {
      if (!session.tool.cancel()) session.endTool();
      draw();
      return;
    }
    openMenu(event);
  });

  function hitAt(event: MouseEvent) {
    return hitOf(session.plan, session.at, canvas.toPlan(event.clientX, event.clientY),
      {tolerance: canvas.tolerance});
  }

  function openMenu(event: MouseEvent) {
    const hit = hitAt(event);
    if (hit && !session.isSelected(hit.ref)) session.select([hit.ref]);
    const items = hit ? [
      {title: `Open ${title(NAMES[hit.ref.kind])} Inspector`, run: () => inspectItem(session, hit.ref)},
      {title: 'Copy', keys: 'Ctrl+C', run: () => session.copy()},
      {title: 'Delete', keys: 'Delete', run: () => session.removeSelected()},
    ] : [
      {title: 'Add Level', run: () => newLevel(session)},
      {title: 'Delete Level', run: () => dropLevel(session), enabled: () => session.plan.levels.length > 1},
      {title: 'Open Level Inspector', run: () => inspectLevel(session)},
      {title: 'Paste', keys: 'Ctrl+V', run: () => session.paste(), enabled: () => session.clipboard.length > 0},
    ];
    const close = openPopup(menuList(items, () => close(), 'Plan'), {x: event.clientX, y: event.clientY});
  }
}

const title = (word: string) => word[0].toUpperCase() + word.slice(1);

/** Keys of the page that mean the same while a building is drawn. */
const OF_THE_PAGE = new Set(['building', 'fullScreen', 'hotkeys', 'togglePanels']);

/**
 * Keys of the building editor. All of the page's keys are its own while it is open, wherever the focus
 * is: the world's keys would change models that are not shown.
 */
export function listenToKeys(element: HTMLElement, {session, files, exit, draw, cursor, signal}: {session: Session,
    files: FileCommands, exit: () => void, draw: () => void,
    cursor: (event: KeyboardEvent) => boolean, signal: AbortSignal}) {
  let typed = '';
  const run: Record<string, () => unknown> = {
    'Ctrl+S': () => files.save(), 'Ctrl+Shift+S': () => files.saveAs(), 'Ctrl+O': () => files.open(),
    'Alt+N': () => files.fresh(), 'Ctrl+X': exit,
    'Ctrl+Z': () => session.undo(), 'Ctrl+Shift+Z': () => session.redo(), 'Ctrl+Y': () => session.redo(),
    'Ctrl+C': () => session.copy(), 'Ctrl+V': () => session.paste(), 'Ctrl+A': () => session.selectAll(),
    Delete: () => session.removeSelected(), Backspace: () => session.removeSelected(),
    F: () => session.show('image'), G: () => session.show('features'),
    F6: () => goToPart(element, 1), 'Shift+F6': () => goToPart(element, -1),
    Escape() {
      if (session.tool.cancel()) return;
      if (session.tool.name !== 'select') session.endTool();
      else session.select([]);
    },
  };
  const onKeyDown = (event: KeyboardEvent) => {
    if (isModalOpen() || event.defaultPrevented || belongsToControl(event)) return;
    if (event.key === 'Enter' && closestTo(event, 'button, [role="menuitem"], summary')) return;
    if (type(event) || cursor(event)) {
      event.preventDefault();
      return;
    }
    const action = run[spelling(event)];
    if (action) {
      event.preventDefault();
      action();
      draw();
    } else if (hotkey(event) && !OF_THE_PAGE.has(hotkey(event)?.action ?? '')) {
      event.preventDefault();
    }
  };

  /** Digits become a length for the tool that draws; true when the key was taken. */
  function type(event: KeyboardEvent) {
    if (session.tool.name === 'select' || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (/^[0-9.,]$/.test(event.key)) typed += event.key.replace(',', '.');
    else if (event.key === 'Backspace' && typed) typed = typed.slice(0, -1);
    else if (event.key === 'Enter') {
      session.tool.typed(typed ? Number(typed) : null);
      typed = '';
    } else {
      if (event.key === 'Escape') typed = '';
      return false;
    }
    session.say(typed ? `Length: ${typed} m, then Enter` : '');
    return true;
  }

  const forget = () => { typed = ''; };   // a click has ended the wall that it was typed for
  window.addEventListener('keydown', onKeyDown, {capture: true, signal});
  element.addEventListener('pointerdown', forget, {capture: true, signal});
}

/** The parts of the editor that F6 visits, by what takes the focus there. */
const PARTS = ['.building-menu [tabindex="0"]', '.building-palette button', '.plan-sheet'];

function goToPart(element: HTMLElement, step: number) {
  const parts = PARTS.flatMap((selector) => element.querySelector<HTMLElement>(selector) ?? []);
  const at = parts.findIndex((part) => part.contains(document.activeElement) ||
    part.closest('.building-menu, .building-palette')?.contains(document.activeElement));
  parts[(Math.max(at, 0) + step + parts.length) % parts.length]?.focus();
}

function spelling(event: KeyboardEvent) {
  const key = event.key.length === 1 ? event.key.toUpperCase() : event.key;
  return [event.ctrlKey || event.metaKey ? 'Ctrl' : '', event.altKey ? 'Alt' : '',
    event.shiftKey && (event.ctrlKey || event.metaKey || key === 'F6') ? 'Shift' : '', key].filter(Boolean).join('+');
}

/** Painting in the 3D view: hovering shows, a click paints. */
export function listenToView(view: HTMLElement|null, {session, actions, signal}: {session: Session,
    actions: Actions, signal: AbortSignal}) {
  const target = (event: MouseEvent) => {
    const link = actions.previewPick(event.clientX, event.clientY)?.link;
    const found = link ? itemOfLink(session.history.plan, link) : null;
    return found && paintable(found.ref) ? found : null;
  };
  let down: [number, number]|null = null;
  /** What is shown painted: between two pictures of the preview nothing can be picked. */
  let shown: {level: number, ref: Ref}|null = null;
  const move = (event: MouseEvent) => {
    if (!(session.tool instanceof PaintTool) || event.buttons) return;
    shown = target(event);
    session.tool.hover(shown?.level ?? 0, shown?.ref ?? null);
  };
  const press = (event: MouseEvent) => { down = [event.clientX, event.clientY]; };
  const release = (event: MouseEvent) => {
    if (!(session.tool instanceof PaintTool) || event.button !== 0 || !down) return;
    if (Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
    const found = shown ?? target(event);
    if (found) session.tool.paint(found.level, found.ref, event.shiftKey);
  };
  const away = (event: MouseEvent) => {
    if (session.tool.name !== 'paint') return;
    event.preventDefault();
    session.endTool();
  };
  const listeners: ['pointermove'|'pointerdown'|'pointerup'|'contextmenu', (event: MouseEvent) =>
      void][] = [['pointermove', move], ['pointerdown', press], ['pointerup', release],
    ['contextmenu', away]];
  for (const [name, listener] of listeners) view?.addEventListener(name, listener, {capture: true, signal});
}
