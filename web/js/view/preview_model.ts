/** A model that is shown beside the world: a building that is being drawn. */
import {Box3, Vector3} from 'three';
import {standaloneModel} from './standalone_model.js';
import {place} from './three_convert.js';
import {ViewPart} from './view_part.js';
import type {ViewParts} from './view.js';

export class Preview extends ViewPart {
  #shown: ReturnType<typeof standaloneModel>|null = null;
  /** What of it the camera was last turned to. */
  #framed: Box3|null = null;

  constructor(parts: ViewParts) {
    super(parts);
    parts.store.listen('preview', () => this.#show());
  }

  /** The link of the model under a point of the page. */
  pick(clientX: number, clientY: number): {link: string}|null {
    if (!this.#shown) return null;
    const [hit] = this.picker.objects([this.#shown.group], clientX, clientY);
    return hit ? {link: hit.object.parent?.name ?? ''} : null;
  }

  #show() {
    const {store: {preview}, stage, stock} = this;
    if (this.#shown) {
      stage.scene.remove(this.#shown.group);
      this.#shown.dispose();
    }
    this.#shown = preview ? standaloneModel(preview, stock) : null;
    if (preview && this.#shown) {
      const {group, ready} = this.#shown;
      place(group, preview.pose);
      // It can be picked before it is drawn for the first time.
      group.updateMatrixWorld(true);
      stage.scene.add(group);
      ready.then(() => {
        this.#frame(new Box3().setFromObject(group));
        stage.shadowsChanged();
      });
    } else this.#framed = null;
    stage.shadowsChanged();
  }

  /** What is drawn beside the world is in sight when it begins, and when it has outgrown that. */
  #frame(box: Box3) {
    if (box.isEmpty() || this.#framed?.containsBox(box)) return;
    this.#framed = box.clone().expandByScalar(box.getSize(new Vector3()).length() * 0.15);
    this.rig.flyTo(this.#framed);
  }
}
