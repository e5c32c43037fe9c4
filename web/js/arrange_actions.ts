/** Several of a kind, alignment, equal gaps, and what is hidden or locked in this browser. */
import {alignMoves} from './align.js';
import {arrayOffsets, clearSpacing, copiesIn, distributeMoves, MOST_COPIES} from './arrange.js';
import {membersOf, withGroups} from './model_groups.js';
import {NOTHING} from './nothing.js';
import {isGround} from './selected_model.js';
import {add, orientation, position} from './pose.js';
import type {AlignChoice} from './align.js';
import type {ActionParts, Outcome} from './actions.js';
import type {Operation} from './protocol.js';
import type {Pose7, Vec3} from './pose.js';

export function arrangeActions({store, ask, edit, dialog, note, view}: ActionParts) {
  /** Poses and bounding boxes of the selected models, those of selected links, too. */
  const chosenBoxes = () =>
    [...new Set(store.selection.flatMap((name) => store.split(name)[0]?.name ?? []))].flatMap((name) => {
      const [pose, bounds] = [store.worldPose(name), view()?.bounds(name)];
      return pose && bounds ? [{name, pose, ...bounds}] : [];
    });

  /** Moves models in one step of the history; the view shows them there at once. */
  async function moveTogether(poses: Record<string, Pose7>, label: string): Promise<Outcome> {
    const shown = view();
    if (!shown || !Object.keys(poses).length) return NOTHING;
    return shown.carry(poses, edit({kind: 'move', poses, label}));
  }

  /** The selected models and lights; of links, their models. */
  const chosen = () => [...new Set(store.selection.flatMap((name) => store.wholeOf(name) ?? []))];

  /** What can be copied of the selection, in the order of a world file: models, then lights. */
  const copied = () => {
    const kinds = ['model', 'light'] as const;
    return kinds.flatMap((kind) => store.selection.filter((name) => store.entity(name)?.kind === kind));
  };

  /** The selected links of the model in the model editor. */
  const editedLinks = () => store.selection.filter((name) => {
    const entity = store.entity(name);
    return entity?.kind === 'link' && entity.model.name === store.modelEditing?.name;
  });

  /** Makes copies in one step of the history, and selects them. */
  async function addCopies(ops: Operation[], label: string): Promise<Outcome> {
    const done = await edit({kind: 'group', ops, label});
    if (done.ok && done.value.names) store.select(done.value.names);
    return done;
  }

  function copiesOfLinks(links: string[]) {
    const [beside] = clearSpacing(links.flatMap((name) => view()?.bounds(name) ?? []));
    const ops = links.flatMap((link): Operation[] => {
      const pose = store.worldPose(link);
      return pose ? [{kind: 'copy_link', link,
        pose: [...add(position(pose), [beside, 0, 0]), ...orientation(pose)] as Pose7}] : [];
    });
    return addCopies(ops, `Duplicate ${links.join(', ')}`);
  }

  /**
   * @param names  models, then lights
   * @param offsets  of the copies, m
   */
  async function copies(names: string[], offsets: Vec3[], label: string): Promise<Outcome> {
    const last = names.at(-1);
    const from = last && (store.worldPose(last) ?? store.light(last)?.pose);
    if (!from || !offsets.length) return NOTHING;
    const outcome = await ask('copy', {names});
    if (!outcome.ok) return outcome;
    const {text} = outcome.value;
    const poses = offsets.map((offset) => [...add(position(from), offset), ...orientation(from)] as Pose7);
    return addCopies([{kind: 'paste', text, poses}], label);
  }

  const arrange = {
    /** What keeps the copies of the selection apart, m. */
    spacing: () => clearSpacing(copied().flatMap((name) => view()?.bounds(name) ?? [])),
    /** A copy of the selected models and lights, or of links of the edited model, beside them. */
    duplicate() {
      const names = copied();
      const links = editedLinks();
      if (!names.length && links.length) return copiesOfLinks(links);
      if (!names.length) {
        note('Select models, lights or links of the edited model to duplicate.');
        return Promise.resolve(NOTHING);
      }
      return copies(names, [[arrange.spacing()[0], 0, 0]], `Duplicate ${names.join(', ')}`);
    },
    /** Asks for the numbers of an array. */
    arrayOfSelection: () => (copied().length ? dialog('array') : note('Select models or lights to copy.')),
    /**
     * Copies of the selection in rows, columns and layers.
     * @param counts  cells along x, y and z
     * @param spacing  m
     */
    array(counts: number[], spacing: number[]) {
      const names = copied();
      const added = copiesIn(counts);
      if (added > MOST_COPIES) throw new RangeError(`An array has at most ${MOST_COPIES} copies.`);
      return copies(names, arrayOffsets(counts, spacing), `Array of ${added + 1} ${names.join(', ')}`);
    },
    /** Shows where the models would go; `null` ends the preview. */
    alignPreview: (choice: AlignChoice|null) =>
      view()?.setPreviewPoses(choice ? alignMoves(chosenBoxes(), choice) : null),
    align(choice: AlignChoice) {
      view()?.setPreviewPoses(null);
      return moveTogether(alignMoves(chosenBoxes(), choice), 'align');
    },
    /** Equal gaps between the selected models. */
    async distribute(axis: 'x'|'y'|'z'): Promise<Outcome> {
      const boxes = chosenBoxes();
      if (boxes.length < 3) note('Select at least three models to distribute.');
      return moveTogether(distributeMoves(boxes, axis), 'distribute');
    },
    distributeX: () => arrange.distribute('x'),
    distributeY: () => arrange.distribute('y'),
    distributeZ: () => arrange.distribute('z'),
    /** The selected models and icons of lights are not drawn any more, in this browser. */
    hide(names = chosen()) {
      for (const name of names) store.setOverlay('hidden', true, name);
      store.select(store.selection.filter((name) => !names.includes(store.wholeOf(name) ?? '')));
    },
    showHidden: (names = marked('hidden')) => names.forEach((name) => store.setOverlay('hidden', null, name)),
    /** Locks what is selected against the mouse; unlocks it where all of it is locked. */
    lock(names = chosen()) {
      const on = names.every((name) => store.overlay('locked', name)) ? null : true;
      for (const name of names) store.setOverlay('locked', on, name);
    },
    unlockAll: () => marked('locked').forEach((name) => store.setOverlay('locked', null, name)),
    /** Puts the selected models and lights into a new group, kept in the world's file. */
    async groupSelection(): Promise<Outcome> {
      const names = chosen();
      if (names.length < 2) {
        note('Select at least two models or lights to group.');
        return NOTHING;
      }
      // Not after the reply: the user may have selected something else by then.
      store.select(names);
      return edit({kind: 'set_group', names});
    },
    /** Takes what is selected, and the others of its groups, out of them. */
    async ungroupSelection(): Promise<Outcome> {
      const members = membersOf(store.document);
      const grouped = new Set(members.flatMap(({name, group}) => (group ? [name] : [])));
      const names = withGroups(members, chosen()).filter((name) => grouped.has(name));
      if (names.length) return edit({kind: 'set_group', names, group: ''});
      note('No member of a group is selected.');
      return NOTHING;
    },
    /** What a click can select: no ground, neither hidden nor locked. */
    selectAll: () => store.select((store.document?.models ?? []).filter((model) => !isGround(model))
      .map(({name}) => name)
      .filter((name) => !store.overlay('hidden', name) && !store.overlay('locked', name))),
    commands: () => dialog('commands'),
  };

  const marked = (flag: 'hidden'|'locked') =>
    membersOf(store.document).map(({name}) => name).filter((name) => store.overlay(flag, name));

  return arrange;
}
