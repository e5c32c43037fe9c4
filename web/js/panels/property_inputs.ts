/**
 * The input of a property: shows the document's value for editing, commits on Enter or when the
 * focus leaves. Updates from the server never overwrite text that the user is typing.
 */
import {sevenOf, sixOf} from './pose_rpy.js';
import {h, textButton} from '../ui/dom.js';
import {colorOf, colorText, numberText, parseNumber} from '../ui/text_format.js';
import type {Field} from './property_fields.js';

export interface Input {
  element: HTMLElement;
  /** What an input needs of a field; those outside of the property panel have no path. */
  show: (value: unknown) => void;
}
export type InputField = Omit<Field, 'path'> & {path?: string};

/** Called with a new value, checked against the field; resolves to false for one that is refused. */
type Commit = (value: unknown) => unknown;

/**
 * @param refuse  called with what is wrong with an input
 */
export function makeInput(field: InputField, commit: Commit,
    refuse: (text: string) => void): Input {
  return MAKERS[field.type](field, commit, refuse);
}

const MAKERS: Record<Field['type'], (field: InputField, commit: Commit,
    refuse: (text: string) => void) => Input> = {
  number: numberInput,
  integer: numberInput,
  text: textInput,
  flag: flagInput,
  color: colorInput,
  vector: vectorInput,
  pose: poseInput,
  choice: choiceInput,
  optional: optionalInput,
  xml: xmlInput,
  button: buttonInput,
};

/** The numbers of a value that is a list of them, else the fallback. */
const numbersOf = (value: unknown, fallback: number[]): number[] =>
    (Array.isArray(value) ? value : fallback);

/** What is wrong with a number in this field; '' when nothing is. */
export function numberFault(field: InputField, value: number) {
  if (Number.isNaN(value)) return 'not a number';
  if (field.type === 'integer' && !Number.isInteger(value)) return 'must be an integer';
  if (field.above !== undefined && value <= field.above) return `must be greater than ${field.above}`;
  if (field.min !== undefined && value < field.min) return `must be at least ${field.min}`;
  if (field.max !== undefined && value > field.max) {
    return `must be at most ${numberText(field.max)}`;
  }
  return '';
}

/**
 * Creates a field of one line. Enter and loss of focus commit the text; Escape discards it.
 * @param take  gets what was typed; false: the field goes
 * back to the value before
 */
function lineInput(field: InputField, attributes: Record<string, unknown>,
    textOf: (value: unknown) => string, take: (text: string, shown: unknown) => boolean):
    Input & {element: HTMLInputElement, type: (text: string) => void} {
  let shown: unknown = null;
  const element = h('input', {
    'aria-label': field.label,
    readOnly: Boolean(field.fixed),
    title: field.hint,
    ...attributes,
  });
  // The mark is on the element, so that a panel that is built again can find the text.
  const isEdited = () => element.dataset.edited !== undefined;
  const markEdited = () => {
    element.dataset.edited = '';
  };
  const restore = () => {
    delete element.dataset.edited;
    const text = textOf(shown);
    if (element.value !== text) element.value = text;
  };
  const finish = () => {
    if (!isEdited()) return;
    delete element.dataset.edited;
    if (!take(element.value, shown)) restore();
  };
  element.addEventListener('input', markEdited);
  element.addEventListener('blur', finish);
  element.addEventListener('focus', () => element.select());
  element.addEventListener('keydown', (event) => {
    if (event.key === 'Enter') finish();
    else if (event.key === 'Escape' && isEdited()) {
      event.stopPropagation();
      restore();
    }
  });
  return {
    element,
    show(value) {
      shown = value ?? null;
      if (!isEdited()) restore();
    },
    type(text) {
      element.value = text;
      markEdited();
    },
  };
}

function numberInput(field: InputField, commit: (value: unknown) => void, refuse: (text: string) =>
    void) {
  const take = (text: string, shown: unknown) => {
    const value = parseNumber(text);
    const fault = numberFault(field, value);
    if (fault) refuse(`${field.label}: ${fault}`);
    if (fault || value === shown) return false;
    commit(value);
    return true;
  };
  const textOf = (value: unknown) => (typeof value === 'number' ? numberText(value) : '');
  const line = lineInput(field, {inputmode: 'decimal', class: 'number'}, textOf, take);
  const {element} = line;
  element.addEventListener('keydown', (event) => {
    if (event.key === 'Enter') {
      event.preventDefault();
      element.select();
    } else if ((event.key === 'ArrowUp' || event.key === 'ArrowDown') && !field.fixed) {
      event.preventDefault();
      const size = event.ctrlKey ? 0.01 : event.shiftKey ? 1 : 0.1;
      const step = field.type === 'integer' ? 1 : size;
      const value = (parseNumber(element.value) || 0) + (event.key === 'ArrowUp' ? step : -step);
      const limited = Math.min(Math.max(value, field.min ?? -Infinity), field.max ?? Infinity);
      line.type(numberText(Math.round(limited * 1e6) / 1e6));
    }
  });
  return line;
}

function textInput(field: InputField, commit: (value: unknown) => void) {
  const textOf = (value: unknown) => String(value ?? '');
  const take = (text: string, shown: unknown) => {
    if (text === textOf(shown)) return false;
    commit(text);
    return true;
  };
  const {element, show} = lineInput(field, {class: 'text'}, textOf, take);
  return {
    element,
    show(value: unknown) {
      show(value);
      if (field.fixed) element.title = textOf(value);
    },
  };
}

function flagInput(field: InputField, commit: (value: unknown) => void) {
  const element = h('input', {
    type: 'checkbox',
    'aria-label': field.label,
    disabled: Boolean(field.fixed),
    onchange: () => { commit(element.checked); },
  });
  return {
    element,
    show(value: unknown) {
      element.checked = Boolean(value);
      element.indeterminate = value === null || value === undefined;
    },
  };
}

function optionalInput(field: InputField, commit: (value: unknown) => void) {
  const flag = flagInput(field, (on) => commit(on ? field.initial : null));
  return {
    element: flag.element,
    show: (value: unknown) => flag.show(Boolean(value)),
  };
}

function choiceInput(field: InputField, commit: (value: unknown) => void) {
  const choices = field.choices ?? [];
  const element = h(
    'select',
    {
      'aria-label': field.label,
      disabled: Boolean(field.fixed),
      onchange: () => { commit(element.value); },
    },
    ...choices.map((choice) => h('option', {value: choice, text: choice})),
  );
  return {
    element,
    show(value: unknown) {
      const text = String(value ?? '');
      if (text && !choices.includes(text)) element.append(h('option', {value: text, text}));
      element.value = text;
    },
  };
}

function colorInput(field: InputField, commit: (value: unknown) => void, refuse: (text: string) =>
    void) {
  let shown = [0, 0, 0, 1];
  const swatch = h('input', {
    type: 'color',
    'aria-label': field.label,
    disabled: Boolean(field.fixed),
    onchange: () => { commit(colorOf(swatch.value, shown[3] ?? 1)); },
  });
  const parts = ['red', 'green', 'blue', 'alpha'].map((name, at) =>
    numberInput(
      {type: 'number', label: `${field.label} ${name}`, min: 0, max: 1, fixed: field.fixed},
      (value) => commit(shown.map((old, index) => (index === at ? Number(value) : old))),
      refuse,
    ),
  );
  return {
    element: h('div', {class: 'color-input'}, swatch, ...parts.map((part) => part.element)),
    show(value: unknown) {
      swatch.classList.toggle('unset', !value);
      shown = [...numbersOf(value, [0, 0, 0, 1])];
      if (shown.length < 4) shown.push(1);
      swatch.value = colorText(shown);
      parts.forEach((part, at) => part.show(value ? shown[at] : null));
    },
  };
}

/** @param shape  what a part shows of its number; the others stay as exact as they are */
function vectorInput(field: InputField, commit: (value: unknown) => void, refuse: (text: string) =>
    void, shape: (value: number, at: number) => number = (value) => value) {
  const names = field.parts ?? [];
  let shown = names.map(() => 0);
  const take = (at: number, value: number) => {
    // The next part may be typed before this one is confirmed.
    shown = shown.map((old, index) => (index === at ? value : old));
    commit(shown);
  };
  const parts = names.map((name, at) =>
    numberInput(
      {...field, type: 'number', label: `${field.label} ${name}`},
      (value) => take(at, Number(value)),
      refuse,
    ),
  );
  return {
    element: h(
      'div',
      {class: names.length > 3 ? 'pose-input' : 'vector-input'},
      ...parts.map((part, at) =>
        h(
          'span',
          {class: `part axis-${'xyz'[at % 3]}`},
          h('i', {text: names[at], 'aria-hidden': 'true'}),
          part.element,
        ),
      ),
    ),
    show(value: unknown) {
      shown = numbersOf(value, names.map(() => 0));
      parts.forEach((part, at) => part.show(shape(shown[at], at)));
    },
  };
}

const POSE_PARTS = ['x', 'y', 'z', 'roll', 'pitch', 'yaw'];

function poseInput({label, fixed}: InputField, commit: (value: unknown) => void,
    refuse: (text: string) => void) {
  const {element, show} = vectorInput({type: 'vector', label, fixed, parts: POSE_PARTS},
    (six) => commit(sevenOf(numbersOf(six, []))), refuse,
    (value, at) => tidy(value, at < 3 ? 1e5 : 1e4));
  return {element, show: (value: unknown) => show(value && sixOf(numbersOf(value, [])))};
}

/** What fits the field; a physics engine's 0.49999998 is what the user put at 0.5. */
function tidy(value: number, parts: number) {
  const rounded = Math.round(value * parts) / parts;
  return rounded === 0 ? 0 : rounded;
}

function buttonInput(field: InputField, commit: (value: unknown) => void) {
  return {element: textButton(field.label, () => commit(null), {title: field.hint}), show: () => {}};
}

function xmlInput(field: InputField, commit: Commit): Input {
  if (!field.fixed) return xmlArea(field, commit);
  const element = h('pre', {class: 'xml', tabindex: 0, 'aria-label': field.label});
  return {
    element,
    show: (value: unknown) => {
      element.textContent = String(value ?? '');
    },
  };
}

/** XML of several lines. Ctrl+Enter and loss of focus commit it; Escape discards it. */
function xmlArea(field: InputField, commit: Commit): Input {
  let shown = '';
  const element = h('textarea', {class: 'xml', rows: 8, 'aria-label': field.label,
    title: field.hint});
  const restore = () => {
    delete element.dataset.edited;
    element.value = shown;
  };
  const finish = () => {
    if (element.dataset.edited === undefined) return;
    delete element.dataset.edited;
    if (element.value !== shown) void send(element.value);
  };
  /** XML that is refused stays, to be corrected. */
  const send = async (text: string) => {
    if (await commit(text) !== false) return;
    element.value = text;
    element.dataset.edited = '';
  };
  element.addEventListener('input', () => {
    element.dataset.edited = '';
  });
  element.addEventListener('blur', finish);
  element.addEventListener('keydown', (event) => {
    if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) finish();
    else if (event.key === 'Escape' && element.dataset.edited !== undefined) {
      event.stopPropagation();
      restore();
    }
  });
  return {
    element,
    show(value: unknown) {
      shown = String(value ?? '');
      if (element.dataset.edited === undefined && element.value !== shown) restore();
    },
  };
}
