/** The world's models in the scene: built from the document, moved by pose frames. */
import {Box3, Matrix4} from 'three';
import {canonicalLink} from '../store.js';
import {compose, inverse} from '../pose.js';
import {matrixOf} from './three_convert.js';
import {visualParts} from './shape_meshes.js';

/** @typedef {{model: string, link: string, linkId: number, plane: boolean}} Owner  of an item */

class LinkView {
  items = [];
  matrix = new Matrix4();

  constructor(link) {
    this.link = link;
  }
}

class ModelView {
  /** @type {Map<number, LinkView>} */
  links = new Map();
  gone = false;

  constructor(document) {
    this.document = document;
    for (const link of document.links) this.links.set(link.id, new LinkView(link));
  }
}

export class Models {
  #store;
  #batches;
  #stock;
  #stage;
  /** @type {Map<string, ModelView>} */
  #views = new Map();
  #byLink = new Map();
  /** Poses that the user's hand holds: pose frames for these links wait. */
  #held = new Map();
  #stretched = new Map();
  #faded = new Set();

  /**
   * @param {{store: import('../store.js').Store, batches: import('./batches.js').Batches,
   *          stock: any, stage: import('./stage.js').Stage}} parts
   */
  constructor({store, batches, stock, stage}) {
    this.#store = store;
    this.#batches = batches;
    this.#stock = stock;
    this.#stage = stage;
    store.addEventListener('document', () => this.rebuildAll());
    store.addEventListener('entity', ({detail: {name, kind, value}}) => {
      if (kind === 'model') this.#replace(name, value);
    });
    store.addEventListener('poses', ({detail: ids}) => this.#followFrame(ids));
  }

  /** Called after models were built or moved, with the ids of links or null for any. */
  onMoved = () => {};

  rebuildAll() {
    for (const name of [...this.#views.keys()]) this.#replace(name, null);
    for (const model of this.#store.document?.models ?? []) this.#replace(model.name, model);
  }

  /** Builds a model anew, after its appearance was changed. */
  rebuild(name) {
    const model = this.#store.model(name);
    if (model) this.#replace(name, model);
  }

  /** Shows a model half transparent while the hand is on it, or as it is. */
  fade(name, faded) {
    if (this.#faded.has(name) === faded) return;
    if (faded) this.#faded.add(name);
    else this.#faded.delete(name);
    this.rebuild(name);
  }

  /**
   * Puts models where the user drags them, with every link as it lies in them.
   * @param {Record<string, number[]>} poses  pose7 by model name
   */
  hold(poses) {
    for (const [name, pose] of Object.entries(poses)) {
      const view = this.#views.get(name);
      if (!view) continue;
      const here = this.#store.worldPose(name);
      const toModel = inverse(here);
      for (const [id, linkView] of view.links) {
        this.#held.set(id, compose(pose, compose(toModel, this.#store.poses.get(id))));
        this.#moveLink(view, linkView);
      }
    }
    this.#changed(null);
  }

  /**
   * Lets go of models; `keep`: where they are held is where they are, until a frame says otherwise.
   */
  release(names, {keep = false} = {}) {
    for (const name of names) {
      const view = this.#views.get(name);
      this.#stretched.delete(name);
      if (!view) continue;
      for (const [id, linkView] of view.links) {
        const pose = this.#held.get(id);
        if (keep && pose && this.#store.poses.has(id)) this.#store.poses.get(id).set(pose);
        this.#held.delete(id);
        this.#moveLink(view, linkView);
      }
    }
    this.#changed(null);
  }

  /**
   * Shows models at new places at once, and lets go when the simulator has answered: at the new
   * places when it agreed, where they were when not.
   * @param {Record<string, number[]>} poses
   * @param {Promise<{ok: boolean}>} asked
   */
  async carry(poses, asked) {
    this.hold(poses);
    const outcome = await asked;
    this.release(Object.keys(poses), {keep: outcome.ok});
    return outcome;
  }

  /** Shows a model stretched by factors along its own axes. */
  stretch(name, factors) {
    this.#stretched.set(name, new Matrix4().makeScale(...factors));
    const view = this.#views.get(name);
    for (const linkView of view?.links.values() ?? []) this.#moveLink(view, linkView);
    this.#changed(null);
  }

  /** Where an entity is shown, held or not. @returns {number[]|null} pose7 */
  shownPose(name) {
    const entity = this.#store.entity(name);
    if (!entity) return null;
    if (entity.kind === 'light') return [...entity.light.pose];
    if (entity.kind === 'link') return [...this.#linkPose(entity.link.id)];
    const first = canonicalLink(entity.model);
    if (!first) return [...entity.model.pose];
    return compose(this.#linkPose(first.id), inverse(first.pose));
  }

  /** The matrix of a link as it is shown. */
  linkMatrix(id) {
    return this.#byLink.get(id)?.links.get(id)?.matrix;
  }

  /**
   * The bounding box of a model or link.
   * @param {number[]|null} [frame]  pose7 of the axes it is aligned with; the world's without
   * @returns {Box3|null} null when nothing of it is drawn
   */
  bounds(name, frame = null) {
    const entity = this.#store.entity(name);
    if (!entity || entity.kind === 'light') return null;
    const view = this.#views.get(entity.model.name);
    const links = entity.kind === 'link' ? [view?.links.get(entity.link.id)] : view?.links.values();
    const toFrame = frame ? matrixOf(frame).invert() : null;
    const box = new Box3();
    const part = new Matrix4();
    for (const linkView of links ?? []) {
      for (const {geometry, matrix} of linkView?.items ?? []) {
        if (!geometry.boundingBox) geometry.computeBoundingBox();
        part.copy(matrix);
        if (toFrame) part.premultiply(toFrame);
        box.union(geometry.boundingBox.clone().applyMatrix4(part));
      }
    }
    return box.isEmpty() ? null : box;
  }

  #linkPose(id) {
    return this.#held.get(id) ?? this.#store.poses.get(id);
  }

  #replace(name, model) {
    const before = this.#views.get(name);
    if (before) {
      before.gone = true;
      for (const [id, {items}] of before.links) {
        for (const item of items) this.#batches.remove(item);
        if (this.#byLink.get(id) === before) this.#byLink.delete(id);
      }
      this.#views.delete(name);
    }
    if (model) this.#build(name, model);
    this.#changed(null);
  }

  #build(name, model) {
    const view = new ModelView(model);
    this.#views.set(name, view);
    for (const [id, linkView] of view.links) {
      this.#byLink.set(id, view);
      this.#moveLink(view, linkView);
      for (const visual of linkView.link.visuals) this.#addVisual(view, linkView, visual);
    }
  }

  #addVisual(view, linkView, visual) {
    const {name} = view.document;
    if (this.#store.overlays.hiddenLayers.has(visual.layer ?? 0)) return;
    const look = {
      opacity: this.#store.overlay('transparent', name) || this.#faded.has(name) ? 0.5 : 1,
      wireframe: Boolean(this.#store.overlay('wireframe', name)),
    };
    const owner = {model: name, link: linkView.link.name, linkId: linkView.link.id,
      plane: visual.geometry.type === 'plane'};
    const add = (parts) => {
      for (const part of parts) {
        const item = this.#batches.add({...part, matrix: new Matrix4(), owner,
          castShadow: visual.cast_shadows && !owner.plane && !look.wireframe});
        item.local = part.matrix;
        linkView.items.push(item);
      }
      this.#moveLink(view, linkView);
    };
    const parts = visualParts(visual, this.#stock, look);
    if (!(parts instanceof Promise)) add(parts);
    else {
      parts.then((ready) => {
        if (view.gone) return;
        add(ready);
        this.#changed(null);
      });
    }
  }

  #moveLink(view, linkView) {
    const pose = this.#linkPose(linkView.link.id);
    if (!pose) return;
    matrixOf(pose, linkView.matrix);
    const stretch = this.#stretched.get(view.document.name);
    if (stretch) {
      const frame = matrixOf(this.shownPose(view.document.name));
      linkView.matrix.premultiply(frame.clone().invert()).premultiply(stretch).premultiply(frame);
    }
    for (const item of linkView.items) {
      item.matrix.multiplyMatrices(linkView.matrix, item.local);
      this.#batches.moved(item);
    }
  }

  #followFrame(ids) {
    for (const id of ids) {
      if (this.#held.has(id)) continue;
      const view = this.#byLink.get(id);
      if (view) this.#moveLink(view, view.links.get(id));
    }
    this.#changed(ids);
  }

  #changed(ids) {
    this.#stage.shadowsChanged();
    this.onMoved(ids);
  }
}
