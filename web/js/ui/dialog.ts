/**
 * Windows over the page: a title, a content, buttons. Escape and the cross answer as Cancel does.
 */
import {closestTo, elementsOf, followPointer, h} from './dom.js';
import {closeButton} from './icons.js';

/** Text that appears if a button's work exceeds `GLANCE`, or if the user tries to close the window. */
const AT_WORK = 'Working ...';
/** Milliseconds after which the text appears. */
const GLANCE = 400;

let numbers = 0;

/** What is open, the last one on top. */
const opened: Dialog[] = [];

/** Whether a window is open that takes all keys. */
export const isModalOpen = () => opened.some(({modal}) => modal);

/** Closes all windows, as Cancel does: what they belong to has ended. */
export function closeDialogs() {
  for (const dialog of [...opened].reverse()) dialog.close(undefined);
}

interface DialogButton {
  title: string;
  /** the dialog closes with it */
  value?: unknown;
  /** called first, may return a promise; the dialog stays open on false */
  run?: () => unknown;
  /** Enter in a field presses it */
  primary?: boolean;
  danger?: boolean;
}
/** A window over the page; `closed` resolves to the `value` of the button that closed it. */
export class Dialog {
  modal;
  element;
  closed: Promise<unknown>;

  /**
   * @param options.modal  false leaves the page usable beside it
   * @param options.name  a class of its own
   */
  constructor({title, content, buttons, modal = true, name = ''}: {title: string, content: Node[],
      buttons: DialogButton[], modal?: boolean, name?: string}) {
    const id = `dialog-title-${(numbers += 1)}`;
    this.modal = modal;
    this.#buttons = buttons.map((button) =>
      h('button', {
        type: button.primary ? 'submit' : 'button',
        text: button.title,
        class: button.primary ? 'primary' : button.danger ? 'danger' : '',
        onclick: button.primary ? null : () => this.#press(button),
      }),
    );
    const primary = buttons.find((button) => button.primary);
    // A key pressed by chance must lose nothing.
    const safe = primary && !primary.danger ? primary : buttons.find((button) => !button.danger);
    this.#safe = safe && this.#buttons[buttons.indexOf(safe)];
    const form = h(
      'form',
      {
        novalidate: true,
        onsubmit: (event: Event) => {
          event.preventDefault();
          if (primary) this.#press(primary);
        },
      },
      h('div', {class: 'dialog-body'}, ...content),
      this.#note,
      h('div', {class: 'dialog-buttons'}, ...this.#buttons),
    );
    const head = h(
      'div',
      {class: 'dialog-head'},
      h('h2', {id, text: title}),
      closeButton('Close', () => this.#leave(), 16),
    );
    this.element = h('dialog', {class: `dialog ${name}`, 'aria-labelledby': id}, head, form);
    this.element.addEventListener('cancel', (event) => {
      event.preventDefault();
      this.#leave();
    });
    this.element.addEventListener('keydown', (event) => {
      if (event.key === 'Escape' && !event.defaultPrevented) {
        event.preventDefault();
        this.#leave();
      }
      // The page's hotkeys are not for what is typed here.
      event.stopPropagation();
    });
    this.closed = new Promise((resolve) => {
      this.#resolve = resolve;
    });
    // The click that opened it, or one beside its fields, must not take the keys from it.
    this.element.addEventListener('focusout', (event) => {
      if (this.modal && event.relatedTarget === null) setTimeout(() => this.#keepFocus());
    });
    movable(this.element, head);
  }

  #note = h('div', {class: 'dialog-note', role: 'alert', hidden: true});
  #buttons;
  #atWork = false;
  /** What has the focus first. */
  #first: HTMLElement|undefined;
  /** The button that has the focus first. */
  #safe: HTMLButtonElement|undefined;
  #resolve: (value: unknown) => void = () => {};
  /** What had the focus before. */
  #before: Element|null = null;

  /**
   * Opens it.
   * @returns the value of the button that closed it, or undefined
   */
  open(): Promise<unknown> {
    this.#before = document.activeElement;
    document.body.append(this.element);
    opened.push(this);
    if (this.modal) this.element.showModal();
    else this.element.show();
    this.#first =
      elementsOf(this.element, '[autofocus]')[0] ??
      elementsOf(this.element, '.dialog-body input, .dialog-body select')[0] ??
      this.#safe;
    this.#first?.focus();
    // Typing replaces a suggested name or number.
    if (this.#first instanceof HTMLInputElement && ['text', 'number'].includes(this.#first.type)) this.#first.select();
    return this.closed;
  }

  #keepFocus() {
    const lost = document.activeElement === document.body || document.activeElement === null;
    if (lost && opened.at(-1) === this) this.#first?.focus();
  }

  /** As Cancel does; what a button has begun is seen to its end. */
  #leave() {
    if (this.#atWork) this.say(AT_WORK);
    else this.close(undefined);
  }

  close(value: unknown) {
    if (!this.element.isConnected) return;
    opened.splice(opened.indexOf(this), 1);
    this.element.close();
    this.element.remove();
    if (this.#before instanceof HTMLElement) this.#before.focus();
    // Nothing had it, or what had it is gone: the keys go to the view.
    if (document.activeElement === document.body) document.querySelector('main')?.focus();
    this.#resolve(value);
  }

  /** Says in the dialog what is wrong; '' takes it back. */
  say(text: string) {
    this.#note.hidden = !text;
    this.#note.textContent = text;
  }

  /** Presses the primary button, as a double click on a list does. */
  submit() {
    this.element.querySelector('form')?.requestSubmit();
  }

  async #press(button: DialogButton) {
    if (!button.run) {
      this.close(button.value);
      return;
    }
    const focused = document.activeElement;
    this.#setAtWork(true);
    const told = setTimeout(() => this.say(AT_WORK), GLANCE);
    try {
      const answer = await button.run();
      if (answer !== false) this.close(answer ?? button.value);
      else if (this.#note.textContent === AT_WORK) this.say('');
    } catch (fault) {
      this.say(faultText(fault));
    } finally {
      clearTimeout(told);
      this.#setAtWork(false);
      // A button that was disabled for the work has lost the focus.
      const lost = document.activeElement === document.body;
      if (lost && this.element.isConnected && focused instanceof HTMLElement) focused.focus();
    }
  }

  #setAtWork(atWork: boolean) {
    this.#atWork = atWork;
    for (const element of this.#buttons) element.disabled = atWork;
  }
}

/** What is said of something that was thrown. */
export const faultText = (fault: unknown) => (fault instanceof Error ? fault.message : String(fault));

/**
 * A question with a few answers.
 * @returns the value of the button, undefined for Escape
 */
export function ask(title: string, text: string, buttons: DialogButton[]): Promise<unknown> {
  const content = [h('p', {text})];
  return new Dialog({title, content, buttons, name: 'question'}).open();
}

/**
 * A dialog with one field for a text.
 * @param field  its label, and more attributes
 * @param run  receives the text; rejects with what is wrong
 * @returns what `run` returns; undefined if the user cancels
 */
export function askText<T>(title: string, {label, note = '', ...attributes}: {label: string, note?: string, value?: string,
    placeholder?: string, maxlength?: number}, button: string, run: (text: string) => T|Promise<T>): Promise<T|undefined> {
  const input = h('input', {...attributes, autofocus: true});
  return new Dialog({title, content: [labelled(label, input), ...(note ? [h('p', {class: 'soft', text: note})] : [])],
    buttons: [{title: 'Cancel'}, {title: button, primary: true, run: () => run(input.value.trim())}]}).open() as Promise<T|undefined>;
}

/**
 * Asks what becomes of unsaved changes.
 * @returns whether the user discards them, or has saved them
 */
export async function mayDiscard(title: string, text: string, save: () => Promise<boolean>) {
  const answer = await ask(title, text, [{title: 'Cancel'}, {title: "Don't Save", value: 'discard', danger: true},
    {title: 'Save', value: 'save', primary: true}]);
  return answer === 'discard' || (answer === 'save' && save());
}

/** A labelled field of a dialog. */
export function labelled(label: string, input: Node, more?: Node) {
  return h('label', {class: 'dialog-field'}, h('span', {text: label}), input, more);
}

/** Lets the mouse move an element by a part of it. */
function movable(element: HTMLElement, handle: HTMLElement) {
  handle.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || closestTo(event, 'button')) return;
    const box = element.getBoundingClientRect();
    const parent = element.offsetParent?.getBoundingClientRect() ?? {left: 0, top: 0};
    const offset = [event.clientX - box.left, event.clientY - box.top];
    followPointer(handle, event, (moved) => {
      const left = Math.min(Math.max(moved.clientX - offset[0], 0), window.innerWidth - 80);
      const top = Math.min(Math.max(moved.clientY - offset[1], 0), window.innerHeight - 40);
      Object.assign(element.style, {left: `${left - parent.left}px`, top: `${top - parent.top}px`, margin: '0'});
    });
  });
}

/** Puts a movable panel over the view, which does not receive the mouse events of the panel. @param handle  moves it */
export function addPanel(view: HTMLElement, panel: HTMLElement, handle: HTMLElement) {
  movable(panel, handle);
  for (const type of ['pointerdown', 'wheel', 'dblclick']) panel.addEventListener(type, (event) => event.stopPropagation());
  view.append(panel);
}
