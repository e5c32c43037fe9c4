/** Boxes with names round what others drag or have selected. */
import {Color, LineBasicMaterial, Vector3} from 'three';
import {colorOf} from '../person_color.js';
import {label} from './label_sprite.js';
import {boxLines, fitBox, ICON_SIZE} from './markers.js';
import {ViewPart} from './view_part.js';
import type {LineSegments, Sprite} from 'three';
import type {Person} from '../protocol.js';
import type {ViewParts} from './view.js';

const MARGIN = 0.03;

export class PeopleMarks extends ViewPart {
  #marks: {name: string, box: LineSegments, text: Sprite}[] = [];
  #materials: Map<string, LineBasicMaterial> = new Map();

  constructor(parts: ViewParts) {
    super(parts);
    for (const event of ['people', 'document', 'entity'] as const) {
      this.store.listen(event, () => this.#rebuild());
    }
  }

  /** Names of the marked entities, one per mark. */
  get shown() { return this.#marks.map(({name}) => name); }

  #rebuild() {
    const {others} = this.store;
    if (!others.length && !this.#marks.length) return;
    for (const {box, text} of this.#marks.splice(0)) this.stage.scene.remove(box, text);
    for (const person of others) {
      for (const name of new Set([...person.held, ...person.selected])) this.#add(person, name);
    }
    this.follow(null);
    this.stage.invalidate();
  }

  #add(person: Person, name: string) {
    if (!this.store.entity(name)) return;
    const color = colorOf(person);
    const material = this.#materials.get(color) ??
      new LineBasicMaterial({color: new Color(color), fog: false});
    this.#materials.set(color, material);
    const box = boxLines(material);
    box.renderOrder = 59;
    const text = label(person.held.includes(name) ? `${person.name} is moving it` : person.name,
      color);
    this.#marks.push({name, box, text});
    this.stage.scene.add(box, text);
  }

  /** Moves the marks of models with moved links; null: all marks. */
  follow(ids: Set<number>|null) {
    for (const {name, box, text} of this.#marks) {
      const links = this.store.entity(name)?.model?.links;
      if (ids && !links?.some(({id}) => ids.has(id))) continue;
      const pose = this.models.shownPose(name);
      box.visible = text.visible = pose !== null;
      if (!pose) continue;
      fitBox(box, pose, this.models.bounds(name, pose), MARGIN);
      text.position.copy(box.position);
      text.position.z += this.models.bounds(name)?.getSize(new Vector3()).z ?? ICON_SIZE;
    }
  }
}
