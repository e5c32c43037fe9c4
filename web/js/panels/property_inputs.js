/**
 * The input of a property: shows the value of the document, lets it be edited, commits on Enter or
 * when the focus leaves. What is being typed is never overwritten by news from the server.
 *
 * @typedef {Object} Input
 * @property {HTMLElement} element
 * @property {(value: any) => void} show
 */
import {sevenOf, sixOf} from './pose_rpy.js';
import {h} from './dom.js';
import {colorOf, colorText, numberText, parseNumber} from './text_format.js';

/**
 * @param {import('./property_fields.js').Field} field
 * @param {(value: any) => void} commit called with a new value, checked against the field
 * @param {(text: string) => void} refuse called with what is wrong with an input
 * @returns {Input}
 */
export function makeInput(field, commit, refuse) {
  return MAKERS[field.type](field, commit, refuse);
}

const MAKERS = {
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
};

/** What is wrong with a number in this field; '' when nothing is. */
export function numberFault(field, value) {
  if (Number.isNaN(value)) return 'not a number';
  if (field.type === 'integer' && !Number.isInteger(value)) return 'not a whole number';
  if (field.above !== undefined && value <= field.above) return `must be above ${field.above}`;
  if (field.min !== undefined && value < field.min) return `must not be below ${field.min}`;
  if (field.max !== undefined && value > field.max) {
    return `must not be above ${numberText(field.max)}`;
  }
  return '';
}

/**
 * A field of one line. What is typed counts on Enter or when the focus leaves; Escape drops it.
 *
 * @param {import('./property_fields.js').Field} field
 * @param {Object<string, any>} attributes
 * @param {(value: any) => string} textOf
 * @param {(text: string, shown: any) => boolean} take  gets what was typed; false: the field goes
 *   back to the value before
 * @returns {Input & {type: (text: string) => void}}
 */
function lineInput(field, attributes, textOf, take) {
  let shown = null;
  let edited = false;
  const element = h('input', {
    type: 'text',
    autocomplete: 'off',
    spellcheck: 'false',
    'aria-label': field.label,
    readOnly: Boolean(field.fixed),
    title: field.hint,
    ...attributes,
  });
  const restore = () => {
    edited = false;
    const text = textOf(shown);
    if (element.value !== text) element.value = text;
  };
  const finish = () => {
    if (!edited) return;
    edited = false;
    if (!take(element.value, shown)) restore();
  };
  element.addEventListener('input', () => {
    edited = true;
  });
  element.addEventListener('blur', finish);
  element.addEventListener('focus', () => element.select());
  element.addEventListener('keydown', (event) => {
    if (event.key === 'Enter') finish();
    else if (event.key === 'Escape' && edited) {
      event.stopPropagation();
      restore();
    }
  });
  return {
    element,
    show(value) {
      shown = value ?? null;
      if (!edited) restore();
    },
    type(text) {
      element.value = text;
      edited = true;
    },
  };
}

function numberInput(field, commit, refuse) {
  const take = (text, shown) => {
    const value = parseNumber(text);
    const fault = numberFault(field, value);
    if (fault) refuse(`${field.label}: ${fault}`);
    if (fault || value === shown) return false;
    commit(value);
    return true;
  };
  const line = lineInput(field, {inputmode: 'decimal', class: 'number'}, numberText, take);
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

function textInput(field, commit) {
  const textOf = (value) => String(value ?? '');
  const take = (text, shown) => {
    if (text === textOf(shown)) return false;
    commit(text);
    return true;
  };
  const {element, show} = lineInput(field, {class: 'text'}, textOf, take);
  return {
    element,
    show(value) {
      show(value);
      if (field.fixed) element.title = textOf(value);
    },
  };
}

function flagInput(field, commit) {
  const element = h('input', {
    type: 'checkbox',
    'aria-label': field.label,
    disabled: Boolean(field.fixed),
    onchange: () => commit(element.checked),
  });
  return {
    element,
    show(value) {
      element.checked = Boolean(value);
      element.indeterminate = value === null || value === undefined;
    },
  };
}

function optionalInput(field, commit) {
  const flag = flagInput(field, (on) => commit(on ? field.initial : null));
  return {element: flag.element, show: (value) => flag.show(Boolean(value))};
}

function choiceInput(field, commit) {
  const element = h(
    'select',
    {
      'aria-label': field.label,
      disabled: Boolean(field.fixed),
      onchange: () => commit(element.value),
    },
    ...field.choices.map((choice) => h('option', {value: choice, text: choice})),
  );
  return {
    element,
    show(value) {
      if (value && !field.choices.includes(value)) {
        element.append(h('option', {value, text: value}));
      }
      element.value = value ?? '';
    },
  };
}

function colorInput(field, commit, refuse) {
  let shown = [0, 0, 0, 1];
  const swatch = h('input', {
    type: 'color',
    'aria-label': field.label,
    disabled: Boolean(field.fixed),
    onchange: () => commit(colorOf(swatch.value, shown[3] ?? 1)),
  });
  const parts = ['red', 'green', 'blue', 'alpha'].map((name, at) =>
    numberInput(
      {type: 'number', label: `${field.label} ${name}`, min: 0, max: 1, fixed: field.fixed},
      (value) => commit(shown.map((old, index) => (index === at ? value : old))),
      refuse,
    ),
  );
  return {
    element: h('div', {class: 'color-input'}, swatch, ...parts.map((part) => part.element)),
    show(value) {
      swatch.classList.toggle('unset', !value);
      shown = [...(value ?? [0, 0, 0, 1])];
      if (shown.length < 4) shown.push(1);
      swatch.value = colorText(shown);
      parts.forEach((part, at) => part.show(value ? shown[at] : null));
    },
  };
}

function vectorInput(field, commit, refuse) {
  let shown = field.parts.map(() => 0);
  const take = (at, value) => {
    // The next part may be typed before this one is confirmed.
    shown = shown.map((old, index) => (index === at ? value : old));
    commit(shown);
  };
  const parts = field.parts.map((name, at) =>
    numberInput(
      {...field, type: 'number', label: `${field.label} ${name}`},
      (value) => take(at, value),
      refuse,
    ),
  );
  return {
    element: h(
      'div',
      {class: 'vector-input'},
      ...parts.map((part, at) =>
        h(
          'span',
          {class: `part axis-${field.parts[at]}`},
          h('i', {text: field.parts[at], 'aria-hidden': 'true'}),
          part.element,
        ),
      ),
    ),
    show(value) {
      shown = value ?? field.parts.map(() => 0);
      parts.forEach((part, at) => part.show(shown[at]));
    },
  };
}

const POSE_PARTS = ['x', 'y', 'z', 'roll', 'pitch', 'yaw'];

function poseInput(field, commit, refuse) {
  let shown = [0, 0, 0, 0, 0, 0];
  const take = (at, value) => {
    shown = shown.map((old, index) => (index === at ? value : old));
    commit(sevenOf(shown));
  };
  const parts = POSE_PARTS.map((name, at) =>
    numberInput(
      {type: 'number', label: `${field.label} ${name}`, fixed: field.fixed},
      (value) => take(at, value),
      refuse,
    ),
  );
  const cell = (at) =>
    h(
      'span',
      {class: `part axis-${'xyz'[at % 3]}`},
      h('i', {text: POSE_PARTS[at], 'aria-hidden': 'true'}),
      parts[at].element,
    );
  return {
    element: h('div', {class: 'pose-input'}, ...POSE_PARTS.map((_, at) => cell(at))),
    show(value) {
      shown = value ? sixOf(value) : [0, 0, 0, 0, 0, 0];
      parts.forEach((part, at) => part.show(tidy(shown[at], at < 3 ? 1e5 : 1e4)));
    },
  };
}

/** What fits the field; a physics engine's 0.49999998 is what the user put at 0.5. */
function tidy(value, parts) {
  const rounded = Math.round(value * parts) / parts;
  return rounded === 0 ? 0 : rounded;
}

function xmlInput(field) {
  const element = h('pre', {class: 'xml', tabindex: 0, 'aria-label': field.label});
  return {
    element,
    show: (value) => {
      element.textContent = value ?? '';
    },
  };
}
