/** The world's models in the scene: built from the document, moved by pose frames. */
import {Box3, Matrix4} from 'three';
import {compose, displacement, inverse} from '../pose.js';
import {ModelView, radiusOf} from './link_views.js';
import {matrixOf} from './three_convert.js';
import {boxOf, visualParts} from './shape_meshes.js';
import {withParts} from '../parts.js';
import type {LinkView} from './link_views.js';
import type {Model, Visual} from '../protocol.js';
import type {Part} from './shape_meshes.js';
import type {Pose7, Vec3} from '../pose.js';
import type {ViewParts} from './view.js';

/** of an item */
export type Owner = {model: string, link: string, linkId: number, plane: boolean};

/** Pixels: less is no movement, and up to the second number it is creeping. */
const STILL = 0.7;
const CREEPING = 2.5;

export class Models extends withParts<Pick<ViewParts, 'store'|'batches'|'stock'|'stage'>>() {
  #views: Map<string, ModelView> = new Map();
  /** By link id. */
  #byLink: Map<number, ModelView> = new Map();
  /** Poses that the user's hand holds: pose frames for these links wait. */
  #held: Map<number, Pose7> = new Map();
  /** By model name. */
  #stretched: Map<string, Matrix4> = new Map();
  #faded: Set<string> = new Set();
  /** Links that have moved, but not so far that it is seen. */
  #late: Set<number> = new Set();

  constructor(parts: Pick<ViewParts, 'store'|'batches'|'stock'|'stage'>) {
    super(parts);
    const {store} = parts;
    store.listen('document', () => this.#whileHolding(() => this.rebuildAll()));
    store.listen('entity', ({detail: {name, kind, value}}) => {
      if (kind === 'model') this.#whileHolding(() => this.#replace(name, value));
    });
    store.listen('poses', ({detail: ids}) => this.#followFrame(ids));
  }

  /** Called after models were built or moved, with the ids of links or null for any. */
  onMoved: (ids: Set<number>|null) => void = () => {};
  /** Called when a mesh that was waited for can be seen. */
  onArrived = () => {};

  /** Metres that a pixel covers at a pose's place. */
  unitAt: (pose: ArrayLike<number>) => number = () => 0;

  /** Before a picture: what has moved unseen is where it is. */
  catchUp() {
    for (const id of this.#late) {
      const view = this.#byLink.get(id);
      const linkView = view?.links.get(id);
      if (view && linkView && !this.#held.has(id)) this.#moveLink(view, linkView);
    }
    this.#late.clear();
  }

  rebuildAll() {
    for (const name of [...this.#views.keys()]) this.#replace(name, null);
    for (const model of this.store.document?.models ?? []) this.#replace(model.name, model);
  }

  /** Rebuilds a model after a change of its appearance. */
  rebuild(name: string) {
    const model = this.store.model(name);
    if (model) this.#replace(name, model);
  }

  /** Shows a model half transparent while the hand is on it, or as it is. */
  fade(name: string, faded: boolean) {
    if (this.#faded.has(name) === faded) return;
    if (faded) this.#faded.add(name);
    else this.#faded.delete(name);
    this.rebuild(name);
  }

  /**
   * Puts models where the user drags them, with every link as it lies in them.
   * @param poses  pose7 by model name
   */
  hold(poses: Record<string, number[]>) {
    for (const [name, pose] of Object.entries(poses)) {
      const view = this.#views.get(name);
      if (!view) {
        this.#holdLink(name, pose);
        continue;
      }
      const here = this.store.worldPose(name);
      if (!here) continue;
      const toModel = inverse(here);
      for (const [id, linkView] of view.links) {
        const now = this.store.poses.get(id);
        if (now) this.#held.set(id, compose(pose, compose(toModel, now)));
        this.#moveLink(view, linkView);
      }
    }
    this.#changed(null);
  }

  /** Lets go of models; `keep`: where they are held is where they are, until a frame says otherwise. */
  release(names: string[], {keep = false} = {}) {
    for (const name of names) {
      this.#stretched.delete(name);
      for (const [view, id, linkView] of this.#linksOf(name)) {
        const pose = this.#held.get(id);
        if (keep && pose) this.store.poses.get(id)?.set(pose);
        this.#held.delete(id);
        this.#moveLink(view, linkView);
      }
    }
    this.#changed(null);
  }

  /** One link of a model that is being built. */
  #holdLink(name: string, pose: Pose7) {
    for (const [view, id, linkView] of this.#linksOf(name)) {
      this.#held.set(id, pose);
      this.#moveLink(view, linkView);
    }
  }

  /** The links of a model, or the one that is named. */
  #linksOf(name: string): [ModelView, number, LinkView][] {
    const view = this.#views.get(name);
    if (view) return [...view.links].map(([id, linkView]) => [view, id, linkView]);
    const entity = this.store.entity(name);
    const owner = entity?.kind === 'link' ? this.#views.get(entity.model.name) : null;
    const linkView = entity?.kind === 'link' ? owner?.links.get(entity.link.id) : null;
    return entity?.kind === 'link' && owner && linkView ? [[owner, entity.link.id, linkView]] : [];
  }

  /**
   * @template T  Shows models at new places at once, and lets go when the simulator has answered: at the new
   * places when it agreed, where they were when not.
   */
  async carry<T extends {ok: boolean}>(poses: Record<string, number[]>, asked: Promise<T>): Promise<T> {
    this.hold(poses);
    const outcome = await asked;
    this.release(Object.keys(poses), {keep: outcome.ok});
    return outcome;
  }

  /** Shows a model stretched by factors along its own axes. */
  stretch(name: string, factors: Vec3) {
    this.#stretched.set(name, new Matrix4().makeScale(factors[0], factors[1], factors[2]));
    const view = this.#views.get(name);
    if (view) for (const linkView of view.links.values()) this.#moveLink(view, linkView);
    this.#changed(null);
  }

  /**
   * Where an entity is shown, held or not.
   * @returns pose7
   */
  shownPose(name: string): number[]|null {
    return this.store.poseWith(name, (id) => this.#linkPose(id));
  }

  /** The matrix of a link as it is shown. */
  linkMatrix(id: number) {
    return this.#byLink.get(id)?.links.get(id)?.matrix;
  }

  /**
   * The bounding box of a model or link.
   * @param frame  pose7 of the axes it is aligned with; the world's without
   * @returns null when nothing of it is drawn
   */
  bounds(name: string, frame: number[]|null = null): Box3|null {
    const entity = this.store.entity(name);
    if (!entity || entity.kind === 'light') return null;
    const view = this.#views.get(entity.model.name);
    const links = entity.kind === 'link' ? [view?.links.get(entity.link.id)] : view?.links.values();
    const toFrame = frame ? matrixOf(frame).invert() : null;
    const box = new Box3();
    const part = new Matrix4();
    for (const linkView of links ?? []) {
      for (const {geometry, matrix} of linkView?.items ?? []) {
        const own = boxOf(geometry);
        part.copy(matrix);
        if (toFrame) part.premultiply(toFrame);
        box.union(own.applyMatrix4(part));
      }
    }
    return box.isEmpty() ? null : box;
  }

  #linkPose(id: number) {
    return this.#held.get(id) ?? this.store.poses.get(id);
  }

  #replace(name: string, model: Model|null) {
    const before = this.#views.get(name);
    if (before) {
      before.gone = true;
      for (const [id, {items}] of before.links) {
        for (const item of items) this.batches.remove(item);
        if (this.#byLink.get(id) === before) this.#byLink.delete(id);
      }
      this.#views.delete(name);
    }
    if (model) this.#build(name, model);
    this.#changed(null);
  }

  /**
   * Changes models; of links that are not those of the same model then the hand lets go: their ids may
   * be another's soon.
   */
  #whileHolding(change: () => void) {
    const holders = [...this.#held.keys()].map((id) => [id, this.#holder(id)] as const);
    change();
    for (const [id, holder] of holders) {
      if (!holder || this.#holder(id) !== holder) this.#held.delete(id);
    }
    for (const name of this.#stretched.keys()) if (!this.#views.has(name)) this.#stretched.delete(name);
  }

  /** @param id  of a link */
  #holder(id: number) { return this.#byLink.get(id)?.document.name; }

  #build(name: string, model: Model) {
    const view = new ModelView(model);
    this.#views.set(name, view);
    for (const [id, linkView] of view.links) {
      this.#byLink.set(id, view);
      this.#moveLink(view, linkView);
      for (const visual of linkView.link.visuals) this.#addVisual(view, linkView, visual);
    }
  }

  #addVisual(view: ModelView, linkView: LinkView, visual: Visual) {
    const {name} = view.document;
    if (this.store.overlay('hidden', name)) return;
    if (this.store.overlays.hiddenLayers.has(visual.layer ?? 0)) return;
    const look = {
      opacity: this.store.overlay('transparent', name) || this.#faded.has(name) ? 0.5 : 1,
      wireframe: Boolean(this.store.overlay('wireframe', name)),
    };
    const owner = {model: name, link: linkView.link.name, linkId: linkView.link.id,
      plane: visual.geometry.type === 'plane'};
    const add = (parts: Part[]) => {
      for (const part of parts) {
        const item = this.batches.add({...part, matrix: new Matrix4(), owner,
          castShadow: visual.cast_shadows && !owner.plane && !look.wireframe});
        item.local = part.matrix;
        linkView.items.push(item);
      }
      linkView.radius = 0;
      this.#moveLink(view, linkView);
    };
    const parts = visualParts(visual, this.stock, look);
    if (!(parts instanceof Promise)) add(parts);
    else {
      parts.then((ready) => {
        if (view.gone) return;
        add(ready);
        this.#changed(null);
        this.onArrived();
      });
    }
  }

  #moveLink(view: ModelView, linkView: LinkView) {
    const pose = this.#linkPose(linkView.link.id);
    if (!pose) return;
    matrixOf(pose, linkView.matrix);
    linkView.shown.set(pose);
    const stretch = this.#stretched.get(view.document.name);
    if (stretch) {
      const frame = matrixOf(this.shownPose(view.document.name) ?? view.document.pose);
      linkView.matrix.premultiply(frame.clone().invert()).premultiply(stretch).premultiply(frame);
    }
    for (const item of linkView.items) {
      if (item.local) item.matrix.multiplyMatrices(linkView.matrix, item.local);
      this.batches.moved(item);
    }
  }

  #followFrame(ids: Set<number>) {
    let most = 0;
    const seen: Set<number> = new Set();
    for (const id of ids) {
      const linkView = this.#byLink.get(id)?.links.get(id);
      if (!linkView || this.#held.has(id)) continue;
      const pixels = this.#pixelsMoved(id, linkView);
      most = Math.max(most, pixels);
      if (pixels < STILL) this.#late.add(id);
      else seen.add(id);
    }
    if (this.#late.size) this.stage.owe();
    if (!seen.size) return;
    if (most < CREEPING && !this.stage.creep()) {
      for (const id of seen) this.#late.add(id);
      this.stage.owe();
      return;
    }
    for (const id of seen) {
      const view = this.#byLink.get(id);
      const linkView = view?.links.get(id);
      if (view && linkView) this.#moveLink(view, linkView);
    }
    this.#changed(seen);
  }

  /** How far a link is from where it is shown. */
  #pixelsMoved(id: number, linkView: LinkView) {
    const pose = this.#linkPose(id);
    if (!pose) return 0;
    const unit = this.unitAt(pose);
    if (!(unit > 0)) return Infinity;
    linkView.radius ||= radiusOf(linkView);
    return displacement(linkView.shown, pose, linkView.radius) / unit;
  }

  #changed(ids: Set<number>|null) {
    this.stage.shadowsChanged();
    this.onMoved(ids);
  }
}
