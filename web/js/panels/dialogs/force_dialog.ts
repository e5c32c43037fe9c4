/**
 * Apply Force/Torque: stays beside the view, so that its arrows can be seen and turned there.
 */
import {Dialog} from '../../ui/dialog.js';
import {h, textButton} from '../../ui/dom.js';
import {makeInput} from '../property_inputs.js';
import {modelOf} from '../world_rows.js';
import type {Model} from '../../protocol.js';
import type {Page} from '../panels.js';
import type {Store} from '../../store.js';
import type {Turned} from '../../view/force_arrows.js';

/** Length of a vector. */
function magnitude(vector: number[]) {
  return Math.hypot(...vector);
}

/** The vector of that direction, or along x where it has none, with another length. */
function withMagnitude(vector: number[], length: number) {
  const old = magnitude(vector);
  if (!old) return [length, 0, 0];
  return vector.map((part) => (part / old) * length);
}

/** A vector with a magnitude and Clear. */
class VectorGroup {
  value = [0, 0, 0];
  element;

  constructor(title: string, unit: string, changed: () => void) {
    this.#changed = changed;
    const refuse = (text: string) => {
      this.#note.textContent = text;
    };
    this.#vector = makeInput(
      {type: 'vector', label: title, parts: ['x', 'y', 'z'], unit},
      (value) => this.set(value as number[]),
      refuse,
    );
    this.#size = makeInput(
      {type: 'number', label: `${title} magnitude`, min: 0},
      (value) => this.set(withMagnitude(this.value, Number(value))),
      refuse,
    );
    this.element = h(
      'fieldset',
      {},
      h('legend', {text: `${title} (${unit})`}),
      this.#vector.element,
      h(
        'div',
        {class: 'row'},
        h('span', {text: 'Magnitude'}),
        this.#size.element,
        textButton('Clear', () => this.set([0, 0, 0]), {'aria-label': `Clear ${title.toLowerCase()}`}),
      ),
      this.#note,
    );
    this.#show();
  }

  #changed;
  #note = h('span', {class: 'field-note', role: 'alert'});
  #vector;
  #size;

  set(value: number[]) {
    this.value = value;
    this.#note.textContent = '';
    this.#show();
    this.#changed();
  }

  #show() {
    this.#vector.show(this.value);
    this.#size.show(magnitude(this.value));
  }
}

class ForceDialog {
  dialog;

  constructor({actions, request}: Page, model: Model, name: string) {
    this.#actions = actions;
    this.#request = request;
    const links = model.links.map((link) => `${model.name}::${link.name}`);
    this.#link = h(
      'select',
      {'aria-label': 'Link', onchange: () => this.preview()},
      ...links.map((one) => h('option', {value: one, text: one})),
    );
    this.#link.value = links.includes(name) ? name : links[0];
    this.dialog = new Dialog({
      title: 'Apply Force/Torque',
      name: 'force',
      modal: false,
      content: [
        h('div', {class: 'row'}, h('span', {text: 'Link'}), this.#link),
        this.#force.element,
        this.#pointFields(),
        this.#torque.element,
        this.#stepsField(),
      ],
      buttons: [
        {title: 'Cancel'},
        {title: 'Apply Force', run: () => this.#apply(true, false)},
        {title: 'Apply Torque', run: () => this.#apply(false, true)},
        {title: 'Apply All', primary: true, run: () => this.#apply(true, true)},
      ],
    });
  }

  #actions;
  #request;
  #link;
  #force = new VectorGroup('Force', 'N', () => this.preview());
  #torque = new VectorGroup('Torque', 'N m', () => this.preview());
  #point = [0, 0, 0];
  #atPoint: HTMLInputElement|undefined;
  #steps = 1;

  #pointFields() {
    const radio = (checked: boolean) =>
      h('input', {
        type: 'radio',
        name: 'force-point',
        checked,
        onchange: () => this.preview(),
      });
    const atCentre = radio(true);
    this.#atPoint = radio(false);
    const input = makeInput(
      {type: 'vector', label: 'Application point', parts: ['x', 'y', 'z']},
      (value) => {
        this.#point = value as number[];
        if (this.#atPoint) this.#atPoint.checked = true;
        input.show(value);
        this.preview();
      },
      (text) => this.dialog.say(text),
    );
    input.show(this.#point);
    return h(
      'fieldset',
      {},
      h('legend', {text: 'Applied at'}),
      h('label', {}, atCentre, 'Center of mass'),
      h('label', {}, this.#atPoint, 'Point in the link frame (m)'),
      input.element,
    );
  }

  #stepsField() {
    const input = makeInput(
      {type: 'integer', label: 'Steps', min: 1},
      (value) => {
        this.#steps = Number(value);
        input.show(value);
      },
      (text) => this.dialog.say(text),
    );
    input.show(this.#steps);
    return h('div', {class: 'row'}, h('span', {text: 'Duration (steps)'}), input.element);
  }

  /** Closes the window if there is no such link any more. */
  closeIfGone(store: Store) {
    if (!store.entity(this.#link.value)) this.dialog.close(undefined);
  }

  /** Draws the arrows in the view, where it can. */
  preview() {
    this.#actions.showForce(
      {
        link: this.#link.value,
        force: this.#force.value,
        torque: this.#torque.value,
        point: this.#atPoint?.checked ? this.#point : null,
      },
      ({force, torque}: Turned) => {
        if (force) this.#force.set(force);
        if (torque) this.#torque.set(torque);
      },
      () => this.dialog.close(undefined),
    );
  }

  async #apply(withForce: boolean, withTorque: boolean) {
    const none = [0, 0, 0];
    this.dialog.say('');
    await this.#request('edit', {op: {
      kind: 'wrench',
      link: this.#link.value,
      force: withForce ? this.#force.value : none,
      torque: withTorque ? this.#torque.value : none,
      steps: this.#steps,
      ...(withForce && this.#atPoint?.checked ? {point: this.#point} : {}),
    }});
    return false;
  }
}

/**
 * @param name  a model or `model::link`
 * @returns settles when the dialog is closed
 */
export async function forceDialog(page: Page, name: string): Promise<void> {
  const model = modelOf(page.store.document, name);
  if (!model?.links.length) return;
  const force = new ForceDialog(page, model, name);
  const closed = force.dialog.open();
  force.preview();
  const check = () => force.closeIfGone(page.store);
  const stop = [page.store.listen('entity', check), page.store.listen('document', check)];
  await closed;
  for (const end of stop) end();
  page.actions.showForce(null);
}
