/** The measure tool: two clicks are a distance, a third one is an angle. */
import {Group, LineBasicMaterial, Mesh, MeshBasicMaterial} from 'three';
import {measures} from '../measure_math.js';
import {label} from './label_sprite.js';
import {ball, empty, segments} from './markers.js';
import {ViewPart} from './view_part.js';
import type {Vec3} from '../pose.js';
import type {ViewParts} from './view.js';
import type {MousePoint} from './pointer.js';
import type {Selector} from './selector.js';

const COLOR = 0xffd54a;
const LABEL = '#ffd54a';
const DOT_PIXELS = 5;
const lineMaterial = new LineBasicMaterial({color: COLOR, depthTest: false, transparent: true, fog: false});
const dotMaterial = new MeshBasicMaterial({color: COLOR, depthTest: false, transparent: true, fog: false});

export class Measure extends ViewPart {
  #points: Vec3[] = [];
  #group = new Group();
  #selector;
  /** What is shown, in words. */
  texts: string[] = [];

  constructor(parts: ViewParts & {selector: Selector}) {
    super(parts);
    const {store, stage, selector} = parts;
    this.#selector = selector;
    stage.scene.add(this.#group);
    store.listen('mode', () => {
      if (store.mode !== 'measure') this.#set([]);
    });
    store.listen('document', () => this.#set([]));
  }

  /** Takes the point under the mouse. */
  click(event: MousePoint) {
    const point = this.#selector.point(event);
    this.#set(this.#points.length === 3 ? [point] : [...this.#points, point]);
  }

  /** The dots keep their size on the screen. */
  follow() {
    for (const child of this.#group.children) {
      if (child instanceof Mesh) {
        child.scale.setScalar(DOT_PIXELS * this.rig.unitAt(child.position.toArray()));
      }
    }
  }

  #set(points: Vec3[]) {
    if (!points.length && !this.#points.length) return;
    this.#points = points;
    this.texts = measures(points);
    empty(this.#group);
    for (const point of points) {
      const dot = new Mesh(ball, dotMaterial);
      dot.position.fromArray(point);
      dot.renderOrder = 58;
      this.#group.add(dot);
    }
    const ends = points.slice(1).flatMap((point, at) => [points[at], point]);
    if (ends.length) {
      const lines = segments(ends, lineMaterial);
      lines.renderOrder = 58;
      this.#group.add(lines);
    }
    this.texts.forEach((text, at) => {
      const sprite = label(text, LABEL);
      // The angle stands at its corner, a distance at the middle of its line.
      const place = at < points.length - 1
        ? points[at].map((part, index) => (part + points[at + 1][index]) / 2) : points[1];
      sprite.position.fromArray(place);
      this.#group.add(sprite);
    });
    this.follow();
    this.stage.invalidate();
  }
}
