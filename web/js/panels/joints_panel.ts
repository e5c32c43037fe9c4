/**
 * The Joints panel: for the selected model a row per joint, on three tabs: Force, Position,
 * Velocity. What a joint does now stands beside what it is asked to do.
 */
import {fill, h, roving} from '../ui/dom.js';
import {numberText} from '../ui/text_format.js';
import {icon} from '../ui/icons.js';
import {makeInput} from './property_inputs.js';
import {modelOf} from './world_rows.js';
import type {Drive, Gains, Joint, Model, Pushes} from '../protocol.js';
import type {Input, InputField} from './property_inputs.js';
import type {Page} from './panels.js';

type DriveMode = Drive['mode'];
/** A joint that can be driven, with its unit in each mode. */
type DrivenJoint = {joint: Joint, units: Record<DriveMode, string>};

/** A row of the panel. */
interface JointRow {
  /** shows the joint's state */
  present: HTMLElement;
  /** rad or m of the shown unit */
  factor: number;
  unit: string;
  /** what the simulator drives the joint with */
  drive?: Drive|null|undefined;
  /** the drive before the last edit: a push of before it may arrive after the reply */
  outdated?: Drive|null|undefined;
  show: (drive: Drive|null|undefined) => void;
  /** gains that suit the joint */
  suggest: (gains: Gains|undefined) => void;
}

const MODES: [DriveMode, string][] = [
  ['force', 'Force'],
  ['position', 'Position'],
  ['velocity', 'Velocity'],
];
/** Until the simulator has told what suits the joint. */
const GAINS = {p: 0, i: 0, d: 0};
const ALL_ZERO = 'All gains are 0: no effort drives this joint.';
const GAIN_NAMES = ['p', 'i', 'd'] as const;

/** Joints that can be driven, with their units in each mode. Pure. */
export function drivenJoints(model: Model|null): DrivenJoint[] {
  return (model?.joints ?? [])
    .filter((joint) => joint.axis && joint.type !== 'fixed')
    .map((joint) => {
      const [length, force] = joint.type === 'prismatic' ? ['m', 'N'] : ['rad', 'N m'];
      return {joint, units: {force, position: length, velocity: `${length}/s`}};
    });
}

const equal = (one: unknown, other: unknown) => JSON.stringify(one) === JSON.stringify(other);

export class JointsPanel {
  page;

  constructor(element: HTMLElement, page: Page) {
    this.page = page;
    const tabs = h(
      'div',
      {class: 'tabs', role: 'tablist', 'aria-label': 'Joint control'},
      ...this.#tabs,
    );
    fill(element, this.#head, tabs, this.#body);
    roving(tabs, '[role=tab]');
    const {store} = page;
    for (const event of ['selection', 'document', 'entity'] as const) {
      store.listen(event, () => this.#update());
    }
    store.listen('watch', (event) => this.#showStates(event.detail));
    store.listen('log', () => this.#hideLive());
  }

  #head = h('h2', {class: 'properties-title'});
  #body = h('div', {class: 'joints-body'});
  #tabs = MODES.map(([mode, title]) =>
    h('button', {
      role: 'tab',
      text: title,
      dataset: {mode},
      onclick: () => {
        this.#mode = mode;
        this.#build();
      },
    }),
  );
  #mode: DriveMode = 'force';
  #shown = false;
  #model: Model|null = null;
  #off: (() => void)|null = null;
  #signature = '';
  #rows: Map<string, JointRow> = new Map();
  #degrees = false;

  /** Opens or closes the panel: a closed one asks for nothing. */
  show(shown: boolean) {
    this.#shown = shown;
    this.#signature = '';
    this.#update();
  }

  #update() {
    const {store, watches} = this.page;
    const name = store.selection[store.selection.length - 1];
    this.#model = this.#shown && name ? modelOf(store.document, name) : null;
    const topic =
      this.#model && drivenJoints(this.#model).length ? `joints:${this.#model.name}` : '';
    const signature = JSON.stringify([
      topic,
      this.#model?.name,
      this.#model?.joints.map((joint) => [joint.name, joint.type]),
    ]);
    if (signature === this.#signature) return;
    this.#signature = signature;
    this.#off?.();
    this.#off = topic ? watches.add(topic) : null;
    this.#build();
    this.#hideLive();
  }

  #build() {
    this.#rows.clear();
    for (const tab of this.#tabs) {
      tab.setAttribute('aria-selected', String(tab.dataset.mode === this.#mode));
    }
    const joints = drivenJoints(this.#model);
    this.#head.textContent = this.#model ? `Joints of ${this.#model.name}` : 'Joints';
    if (!joints.length) {
      fill(
        this.#body,
        h('p', {
          class: 'empty',
          text: this.#model
            ? 'This model has no movable joints.'
            : 'Select a model with joints.',
        }),
      );
      return;
    }
    const angular = joints.some(({units}) => units.position === 'rad') && this.#mode !== 'force';
    fill(
      this.#body,
      angular &&
        h(
          'label',
          {class: 'check-row'},
          h('input', {
            type: 'checkbox',
            checked: this.#degrees,
            onchange: () => {
              this.#degrees = !this.#degrees;
              this.#build();
            },
          }),
          'Degrees',
        ),
      ...joints.map((one) => this.#row(one)),
      h(
        'div',
        {class: 'row'},
        h(
          'button',
          {onclick: () => this.#reset(joints)},
          icon('reset', 14),
          'Reset',
        ),
      ),
    );
  }

  #row({joint, units}: DrivenJoint) {
    const scoped = `${this.#model?.name}::${joint.name}`;
    const mode = this.#mode;
    const degrees = this.#degrees && units.position === 'rad' && mode !== 'force';
    const factor = degrees ? Math.PI / 180 : 1;
    const unit = degrees ? units[mode].replace('rad', '°') : units[mode];
    const note = h('span', {class: 'field-note', role: 'alert'});
    const say = (text: string) => {
      note.textContent = text;
    };
    const gains: Gains = mode === 'force' ? {} : {...GAINS};
    // The simulator's, the user's, or those of the loop at work.
    let known = false;
    const idle = h('span', {class: 'field-note warning', role: 'status'});
    const showGains = () => {
      for (const {name, gain} of gainInputs) gain.show(gains[name]);
      const none = known && GAIN_NAMES.every((name) => !gains[name]);
      idle.textContent = none && mode !== 'force' ? ALL_ZERO : '';
    };
    // What the simulator told before it has taken an edit must not undo what is typed meanwhile.
    let underWay = 0;
    const send = async (value: number) => {
      say('');
      const sent = known ? {gains: {...gains}} : {};
      underWay += 1;
      try {
        const outcome = await this.page.actions.edit(
          {kind: 'joint', joint: scoped, mode, value, ...sent}, {quiet: true});
        if (outcome.ok) {
          row.outdated = row.drive ?? null;
          row.drive = {...row.drive, mode, value, ...sent};
        } else say(outcome.issues[0].message);
      } finally {
        underWay -= 1;
      }
      row.show(row.drive);
    };
    const label = (name: string): InputField =>
        ({type: 'number', label: `${joint.name} ${name}`});
    const input = makeInput(label(mode), (value) => send(Number(value) * factor), say);
    const gainInputs = GAIN_NAMES.filter((name) => name in gains).map((name) => {
      const gain = makeInput(
        label(`${name.toUpperCase()} gain`),
        (value) => {
          gains[name] = Number(value);
          known = true;
          showGains();
          if (row.drive?.mode === mode) send(row.drive.value);
        },
        say,
      );
      return {name, gain};
    });
    const present = h('output', {class: 'soft', 'aria-label': `${joint.name} state`});
    const row: JointRow = {
      present,
      factor,
      unit: degrees ? '°' : units.position,
      drive: undefined,
      suggest: () => {},
      /** Shows what the simulator says it drives the joint with. */
      show(drive) {
        this.drive = drive;
        if (underWay) return;
        const mine = drive?.mode === mode ? drive : null;
        if (mine?.gains) known = true;
        Object.assign(gains, mine?.gains);
        input.show((mine?.value ?? 0) / factor);
        showGains();
      },
    };
    row.suggest = (suited) => {
      if (known || !suited || mode === 'force') return;
      known = true;
      Object.assign(gains, suited);
      showGains();
    };
    row.show(undefined);
    this.#rows.set(joint.name, row);
    return h(
      'div',
      {class: 'joint-row'},
      h(
        'div',
        {class: 'joint-name'},
        h('span', {class: 'label', text: joint.name, title: scoped}),
        present,
      ),
      h('div', {class: 'row'}, input.element, h('span', {class: 'unit', text: unit})),
      gainInputs.length && h('div', {class: 'vector-input'}, ...gainInputs.map(gainPart)),
      idle,
      note,
    );
  }

  /** States are those of the running world, not of a log. */
  #hideLive() {
    for (const {present} of this.#rows.values()) present.hidden = this.page.store.showsLog;
  }

  #showStates({topic, joints}: Pushes['watch']) {
    if (!this.#model || topic !== `joints:${this.#model.name}`) return;
    for (const {name, axis, position, rate, drive, default_gains: suited} of joints ?? []) {
      const row = axis === 0 && this.#rows.get(name);
      if (!row) continue;
      const at = (value: number) => numberText(Math.round((value / row.factor) * 1e4) / 1e4);
      row.present.textContent = `${at(position)} ${row.unit}, ${at(rate)} ${row.unit}/s`;
      row.suggest(suited?.[this.#mode]);
      const isOutdated = equal(drive ?? null, row.outdated);
      row.outdated = undefined;  // a second such push shows the edit of another user
      if (!isOutdated && !equal(drive, row.drive)) row.show(drive);
    }
  }

  /** Nothing is asked of the joints any more. */
  async #reset(joints: DrivenJoint[]) {
    const model = this.#model?.name;
    for (const {joint} of joints) {
      const scoped = `${model}::${joint.name}`;
      await this.page.actions.edit({kind: 'joint', joint: scoped, mode: 'force', value: 0});
    }
  }
}

const gainPart = ({name, gain}: {name: string, gain: Input}) =>
  h(
    'span',
    {class: 'part'},
    h('i', {text: name.toUpperCase(), 'aria-hidden': 'true'}),
    gain.element,
  );
