/** White wire boxes round what is selected, aligned with it. */
import {LineBasicMaterial} from 'three';
import {boxLines, fitBox} from './markers.js';
import {ViewPart} from './view_part.js';
import type {LineSegments} from 'three';
import type {ViewParts} from './view.js';

const material = new LineBasicMaterial({color: 0xffffff, fog: false});

export class SelectionBoxes extends ViewPart {
  #boxes: LineSegments[] = [];
  #stale = false;

  constructor(parts: ViewParts) {
    super(parts);
    const {store} = parts;
    for (const event of ['selection', 'document'] as const) {
      store.listen(event, () => this.update());
    }
    // `follow` applies the poses of moving models; lights change by their documents only.
    store.listen('entity', ({detail}) => {
      if (detail.kind === 'light' && store.selection.length) this.update();
    });
  }

  /** Centres of the boxes that are seen, for tests. */
  get places() {
    this.catchUp();
    return this.#boxes.filter(({visible}) => visible).map(({position}) => position.toArray());
  }

  /** Fits the boxes to what is selected now. */
  update() {
    this.#stale = false;
    const {selection} = this.store;
    for (const box of this.#boxes.splice(selection.length)) this.stage.scene.remove(box);
    while (this.#boxes.length < selection.length) {
      const box = boxLines(material);
      box.renderOrder = 60;
      this.#boxes.push(box);
      this.stage.scene.add(box);
    }
    selection.forEach((name, index) => this.#fit(this.#boxes[index], name));
    this.stage.invalidate();
  }

  /** Goes along when one of the links belongs to the selection. */
  follow(ids: Set<number>|null) {
    const {selection} = this.store;
    if (!selection.length) return;
    if (!ids) {
      this.#stale = true;
      this.stage.invalidate();
    } else if (selection.some((name) => this.#touches(name, ids))) this.update();
  }

  /** Before a picture: after thousands of changes the boxes are fitted once. */
  catchUp() {
    if (this.#stale) this.update();
  }

  #touches(name: string, ids: Set<number>) {
    const entity = this.store.entity(name);
    return entity?.model?.links.some(({id}) => ids.has(id));
  }

  #fit(box: LineSegments, name: string) {
    const pose = this.models.shownPose(name);
    box.visible = pose !== null;
    if (pose) fitBox(box, pose, this.models.bounds(name, pose), 0.01);
  }
}
