/** Inspectors as windows: Cancel, Apply and OK over the fields of `inspector_fields.js`. */
import {Dialog, labelled} from '../ui/dialog.js';
import {h} from '../ui/dom.js';
import {
  ROOF_FIELDS, applied, fieldFault, fieldsOf, levelApplied, levelFields, levelValues, roofApplied,
  roofValues, valuesOf,
} from './inspector_fields.js';
import {itemOf, linkName} from './plan.js';
import {followLevel} from './level_follower.js';
import {NAMES} from './drawing_session.js';
import type {InspectorField, Values} from './inspector_fields.js';
import type {Ref} from './plan.js';
import type {Session} from './drawing_session.js';

export const SWATCHES = ['#ffffff', '#c2a9a0', '#ebce9d', '#fe7905', '#ffc34e', '#6fcbac'];
export const TEXTURES = [['Wood', 'Gazebo/Wood'], ['Tiles', 'Gazebo/CeilingTiled'], ['Bricks', 'Gazebo/Bricks']];

const shown = (value: unknown) => typeof value === 'number' ? String(Math.round(value * 1000) / 1000) : String(value ?? '');

/** The inspector of an item. */
export async function inspectItem(session: Session, ref: Ref) {
  const level = followLevel(session);
  const item = itemOf(session.plan, level.at(), ref);
  if (!item) {
    level.end();
    return;
  }
  const titles = {walls: 'Wall', windows: 'Window', doors: 'Door', stairs: 'Stairs', floors: 'Floor'};
  await inspect({
    title: `${titles[ref.kind]} Inspector: ${linkName(ref)}`, fields: fieldsOf(ref.kind, item),
    values: () => valuesOf(itemOf(session.plan, level.at(), ref) ?? item, session.plan.levels[level.at()]),
    apply(values, before) {
      const {plan, fault} = applied(session.history.plan, level.at(), ref, values, before);
      if (fault) return fault;
      session.commit(plan, `edit ${NAMES[ref.kind]}`);
      return '';
    },
  });
  level.end();
}

/** Opens the dialog with the properties of the current level; resolves when it closes. */
export async function inspectLevel(session: Session) {
  const level = followLevel(session);
  await inspect({
    title: 'Level Inspector', fields: levelFields(session.plan, level.at()),
    values: () => levelValues(session.plan, level.at()),
    apply(values, before) {
      const at = level.at();
      if (at < 0) return 'the level no longer exists';
      session.commit(levelApplied(session.history.plan, at, values, before), 'edit level');
      return '';
    },
  });
  level.end();
}

export function inspectRoof(session: Session) {
  return inspect({
    title: 'Roof', fields: ROOF_FIELDS, values: () => roofValues(session.plan),
    apply(values, before) {
      session.commit(roofApplied(session.history.plan, values, before), 'edit roof');
      return '';
    },
  });
}

/** What a field shows. */
const read = (values: Values, field: InspectorField): unknown => values[field.name as keyof Values];

/** @param form  `apply` says what is wrong, or '' */
function inspect({title, fields, values, apply}: {title: string, fields: InspectorField[],
    values: () => Partial<Values>,
    apply: (values: Values, before: Values) => string}) {
  let before = values() as Values;
  const inputs = fields.map((field) => ({field, ...INPUTS[field.type](field)}));
  const show = () => inputs.forEach(({field, put}) => put(read(before, field)));
  show();
  const take = () => {
    const now = {...before};
    for (const {field, get} of inputs) {
      const old = read(before, field);
      const value = get(old);
      const fault = value === old ? '' : fieldFault(field, value);
      if (fault) {
        dialog.say(fault);
        return false;
      }
      Object.assign(now, {[field.name]: value});
    }
    const fault = apply(now, before);
    dialog.say(fault);
    if (fault) return false;
    before = values() as Values;
    show();
    return true;
  };
  const dialog = new Dialog({
    title, name: 'inspector', modal: false,
    content: inputs.map(({field, element}) => {
      element.title ||= field.hint ?? '';
      return labelled(field.label, element);
    }),
    buttons: [{title: 'Cancel'}, {title: 'Apply', run: () => { take(); return false; }},
      {title: 'OK', primary: true, run: () => take() && 'ok'}],
  });
  return dialog.open();
}

/** A field's element, and how a value is put in and taken out. */
type FieldInput = {element: HTMLElement, put: (value: unknown) => void,
    get: (before: unknown) => unknown};

/** By type of a field. */
const INPUTS: Record<InspectorField['type'], (field: InspectorField) => FieldInput> = {
  number: (field: InspectorField) => numeric(field),
  integer: (field: InspectorField) => numeric(field),
  text(field: InspectorField) {
    const element = h('input', {'aria-label': field.label, maxlength: 100});
    return {element, put: (value) => { element.value = String(value ?? ''); }, get: () => element.value};
  },
  choice(field: InspectorField) {
    const element = h('select', {'aria-label': field.label},
      ...(field.choices ?? []).map(([value, text]) => h('option', {value, text})));
    return {element, put: (value) => { element.value = String(value ?? ''); }, get: () => element.value};
  },
  color(field: InspectorField) {
    const picker = h('input', {type: 'color', 'aria-label': field.label});
    const swatches = SWATCHES.map((color) => h('button', {class: 'swatch', title: color,
      style: `background: ${color}`, onclick: () => { picker.value = color; }}));
    return {element: h('span', {class: 'row'}, picker, ...swatches),
      put: (value) => { picker.value = String(value ?? ''); }, get: () => picker.value};
  },
  texture(field: InspectorField) {
    const element = h('select', {'aria-label': field.label}, h('option', {value: '', text: 'None'}),
      ...TEXTURES.map(([text, value]) => h('option', {value, text})));
    return {
      element, get: () => element.value,
      put(value) {
        const text = String(value ?? '');
        if (text && ![...element.options].some((option) => option.value === text)) {
          element.append(h('option', {value: text, text}));
        }
        element.value = text;
      },
    };
  },
};

/** What was not touched keeps the digits that the field does not show. */
function numeric(field: InspectorField): FieldInput {
  const element = h('input', {type: 'number', class: 'number', 'aria-label': field.label,
    step: field.type === 'integer' ? 1 : 'any', min: field.min, max: field.max});
  return {
    element,
    put: (value) => { element.value = shown(value); },
    get: (before) => element.value === shown(before) ? before : element.value.trim() === ''
      ? NaN : Number(element.value),
  };
}

