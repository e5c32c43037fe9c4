/** The form of a robot template: its parameters as the server declares them. */
import {freeName} from '../../scoped_names.js';
import {Dialog, labelled} from '../../ui/dialog.js';
import {h} from '../../ui/dom.js';
import type {Model, Requests, Template, TemplateParameter} from '../../protocol.js';
import type {Page} from '../panels.js';

type Field = {parameter: TemplateParameter, input: HTMLInputElement};

function fieldOf(parameter: TemplateParameter): Field {
  const {kind, title, unit, minimum, maximum} = parameter;
  const label = {'aria-label': title};
  if (kind === 'flag') return {parameter, input: h('input', {type: 'checkbox', checked: Boolean(parameter.default), ...label})};
  const value = String(parameter.default);
  if (kind === 'text') return {parameter, input: h('input', {value, ...label})};
  return {parameter, input: h('input', {type: 'number', step: 'any', value, min: minimum, max: maximum,
    title: `${minimum} to ${maximum} ${unit}`.trim(), ...label})};
}

function valueOf({parameter, input}: Field) {
  if (parameter.kind === 'flag') return input.checked;
  return parameter.kind === 'text' ? input.value : input.valueAsNumber;
}

/** The fields in groups: what follows a check box belongs to it, and is shown while it is checked. */
function groupsOf(fields: Field[]): HTMLElement[] {
  const groups: HTMLElement[] = [h('div', {class: 'template-group'})];
  for (const {parameter, input} of fields) {
    const {title, unit, kind} = parameter;
    if (kind !== 'flag') {
      groups[groups.length - 1].append(labelled(unit ? `${title} (${unit})` : title, input));
      continue;
    }
    const group = h('div', {class: 'template-group', hidden: !input.checked});
    input.addEventListener('change', () => { group.hidden = !input.checked; });
    groups.push(h('label', {class: 'template-flag'}, input, title), group);
  }
  return groups;
}

/** The models with plugins, whose topics a robot without a namespace may share. */
const robotNames = (models: Pick<Model, 'name'|'plugins'|'links'>[]): string[] => models.filter(({plugins, links}) =>
  plugins.length > 0 || links.some(({sensors}) => sensors?.length)).map(({name}) => name);

/** The name that the robot of a template gets in the world. */
function freeNamespace({parameters}: Template, {document}: Page['store']) {
  const wanted = String(parameters.find(({name}) => name === 'name')?.default ?? 'robot');
  const taken = new Set([...document?.models ?? [], ...document?.lights ?? []].map(({name}) => name));
  return freeName(wanted, (name) => taken.has(name));
}

const sharedNote = (fields: Field[], robots: string[]) =>
  (robots.length && fields.some(({parameter}) => parameter.name === 'namespace')
    ? [h('p', {class: 'soft', text: `${robots.join(', ')} may use the same topics: the ROS namespace keeps them apart.`})] : []);

/** Asks for the parameters of a template; the robot then follows the mouse. */
export async function templateDialog({actions, store}: Pick<Page, 'actions'|'store'>, template: Template) {
  const robots = robotNames(store.document?.models ?? []);
  const fields = template.parameters.map((parameter) => fieldOf(
    parameter.name === 'namespace' && robots.length ? {...parameter, default: freeNamespace(template, store)} : parameter));
  const dialog = new Dialog({
    title: template.title,
    name: 'template',
    content: [h('p', {class: 'soft', text: `${template.description}.`}), ...sharedNote(fields, robots), ...groupsOf(fields)],
    buttons: [{title: 'Cancel'}, {title: 'Insert', primary: true, run: async () => {
      const values = fields.map((field) => [field.parameter.name, valueOf(field)]);
      const wrong = fields.find((field) => Number.isNaN(valueOf(field)));
      if (wrong) throw new Error(`${wrong.parameter.title} must be a number.`);
      const outcome = await actions.fromTemplate(template.name, Object.fromEntries(values));
      if (!outcome.ok) throw new Error(outcome.issues[0]?.message);
      return outcome.value;
    }}],
  });
  const made = await dialog.open() as Requests['template']['reply']|undefined;
  // A window that closes returns the focus: only then may the view take it.
  if (made) actions.insertMade(made);
}
