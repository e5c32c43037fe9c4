/** The dialog of a joint: ends, type, axes, limits, pose. */
import {Dialog, labelled} from '../ui/dialog.js';
import {h} from '../ui/dom.js';
import {makeInput} from '../panels/property_inputs.js';
import {axisFields} from '../panels/property_fields.js';
import {JOINT_TYPES, axesOf, axisOr} from '../model_edits.js';
import type {Axis, Joint, Model} from '../protocol.js';

function choice(label: string, choices: readonly string[], chosen: string) {
  const all = choices.includes(chosen) ? choices : [chosen, ...choices];
  return h('select', {'aria-label': label},
    ...all.map((value) => h('option', {value, text: value, selected: value === chosen})));
}

/** What is shown of an axis; springs and friction are in the property panel. */
const SHOWN = ['xyz', 'lower', 'upper', 'effort', 'velocity', 'damping'];

/** Fields of an axis that change `axis` as they are edited. */
function axisRows(title: string, joint: Joint, axis: Axis, refuse: (text: string) => void) {
  const rows = axisFields(joint).filter(({path}) => SHOWN.includes(path)).map((field) => {
    const key = field.path as keyof Axis;
    const input = makeInput(field, (value) => {
      Object.assign(axis, {[key]: value});
      input.show(value);
      refuse('');
    }, refuse);
    input.show(axis[key]);
    return h('div', {class: `field ${field.type === 'vector' ? 'wide' : ''}`},
      h('span', {class: 'field-label', text: field.label}),
      h('span', {class: 'field-input'}, input.element, field.unit && h('span', {class: 'unit', text: field.unit})));
  });
  return h('fieldset', {}, h('legend', {text: title}), ...rows);
}

/**
 * Edits a joint of a model.
 * @param does  reject
 * with what is wrong
 */
export async function jointDialog(model: Model, joint: Joint, {apply,
    remove}: {apply: (values: Partial<Joint>) => Promise<unknown>, remove: () => Promise<unknown>}) {
  const links = model.links.map((link) => link.name);
  const name = h('input', {value: joint.name, 'aria-label': 'Name'});
  const type = choice('Type', JOINT_TYPES, joint.type);
  const parent = choice('Parent', ['world', ...links], joint.parent);
  const child = choice('Child', links, joint.child);
  let {pose} = joint;
  const axes = [axisOr(joint.axis), axisOr(joint.axis2)];
  const place = makeInput({label: 'pose', type: 'pose'}, (value) => {
    pose = value as number[];
    place.show(value);
    dialog.say('');
  }, (text) => dialog.say(text));
  place.show(pose);
  const rows = h('div', {class: 'joint-axes'});
  const showAxes = () => {
    const shown = {...joint, type: type.value};
    rows.replaceChildren(...axes.slice(0, axesOf(type.value)).map((axis, at) =>
      axisRows(at ? 'Second axis' : 'Axis', shown, axis, (text) => dialog.say(text))));
  };
  type.addEventListener('change', showAxes);
  const dialog = new Dialog({
    title: `Joint ${joint.name}`, name: 'joint-dialog', modal: true,
    content: [labelled('Name', name), labelled('Type', type), labelled('Parent', parent), labelled('Child', child),
      h('fieldset', {}, h('legend', {text: 'Pose in the child link'}), place.element), rows],
    buttons: [
      {title: 'Remove', danger: true, run: remove}, {title: 'Cancel'},
      {title: 'OK', primary: true, run: () => {
        const count = axesOf(type.value);
        return apply({name: name.value.trim(), type: type.value, parent: parent.value, child: child.value, pose,
          ...(count > 0 ? {axis: axes[0]} : {}), ...(count > 1 ? {axis2: axes[1]} : {})});
      }},
    ],
  });
  showAxes();
  await dialog.open();
}
