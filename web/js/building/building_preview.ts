/** The building in the 3D view while it is drawn, and its place in the world afterwards. */
import {RequestError} from '../connection.js';
import {faultText} from '../ui/dialog.js';
import {isEmpty, withoutImages} from './plan.js';
import {withParts} from '../parts.js';
import type {Fault} from './plan_check.js';
import type {Model, Operation, Plan} from '../protocol.js';
import type {Pose7} from '../pose.js';
import type {RequestFunction} from '../connection.js';
import type {Session} from './drawing_session.js';
import type {Store} from '../store.js';

/** Milliseconds after a change until the preview is asked for; large buildings wait longer. */
const PAUSE = 120;
const LONGEST_PAUSE = 2000;

type PreviewParts = {store: Store, session: Session, request: RequestFunction, onIssues: (issues: Fault[]) => void};

export class Preview extends withParts<PreviewParts>() {

  constructor(parts: PreviewParts) {
    super(parts);
    const {session} = parts;
    this.#unlisten = session.listen('change', this.#changed);
    this.#changed();
  }

  #shown: Plan|null = null;
  #timer: ReturnType<typeof setTimeout>|0 = 0;
  #asking = false;
  #took = 0;
  #ended = false;
  #unlisten = () => {};

  #changed = () => {
    if (this.session.plan === this.#shown || this.#timer || this.#ended) return;
    this.#timer = setTimeout(() => {
      this.#timer = 0;
      this.#ask();
    }, Math.min(Math.max(PAUSE, 2 * this.#took), LONGEST_PAUSE));
  };

  /** One request at a time; what came in between is asked for afterwards. */
  async #ask() {
    if (this.#asking || this.#ended) return;
    const {plan} = this.session;
    this.#shown = plan;
    if (isEmpty(plan)) {
      this.store.setPreview(null);
      this.onIssues([]);
      return;
    }
    this.#asking = true;
    const began = performance.now();
    try {
      const {model, issues} = await this.request('building_sdf', {plan: withoutImages(plan), text: false});
      if (!this.#ended) this.store.setPreview(model);
      this.onIssues(issues);
    } catch (fault) {
      // The last picture stays: a plan with a fault is not shown, and is told beside the canvas.
      this.onIssues(issuesOf(fault));
    } finally {
      this.#took = performance.now() - began;
      this.#asking = false;
      this.#changed();
    }
  }

  end() {
    this.#ended = true;
    clearTimeout(this.#timer);
    this.#unlisten();
    this.store.setPreview(null);
  }
}

/** What a refused request says of the plan. */
const issuesOf = (fault: unknown): Fault[] => fault instanceof RequestError
  ? fault.issues : [{severity: 'error', message: faultText(fault)}];

/**
 * The operations that put a building into the world. A building that was opened again replaces the
 * model it was opened for, and stays as far from where it was drawn as that model was.
 * @param building  as `building_sdf` answers
 * @param before  the model when the plan was opened
 */
export function placingOps(store: Store, {model, sdf}: {model: Model, sdf: string},
    before: {name: string, pose: Pose7}|null): Operation[] {
  const insert = (pose: Pose7) => ({kind: 'insert', name: model.name, sdf, pose} as Operation);
  if (!before || !store.model(before.name)) return [insert([...model.pose])];
  const now = store.worldPose(before.name) ?? before.pose;
  const turned = now.slice(3).some((value, at) => Math.abs(value - before.pose[3 + at]) > 1e-6);
  const shifted = model.pose.map((value, at) => at < 3 ? value + now[at] - before.pose[at] : value);
  return [{kind: 'delete', names: [before.name]}, insert(turned ? [...now] : shifted)];
}
