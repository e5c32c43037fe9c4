/** A small cube that turns with the camera; a click on a face looks at the world from there. */
import {forward, right, up} from '../camera_math.js';
import {h} from '../ui/dom.js';
import type {Actions} from '../actions.js';
import type {View} from '../camera_math.js';

const HALF = 27;
/**
 * Side, and how its face is turned in CSS. The world's x is CSS's x, its z is CSS's -y (down is
 * positive), its y is CSS's -z (towards the viewer is positive).
 */
const FACES: ['top'|'bottom'|'front'|'back'|'left'|'right', string][] = [
  ['front', 'rotateY(90deg)'], ['back', 'rotateY(-90deg)'], ['left', 'rotateY(180deg)'],
  ['right', ''], ['top', 'rotateX(90deg)'], ['bottom', 'rotateX(-90deg)'],
];

/**
 * How the names on top and bottom are turned, in degrees, so that they stand upright as far as quarter
 * turns go.
 * @param yaw  of the camera, rad
 */
export function nameTurns(yaw: number) {
  const quarters = Math.round((yaw - 1e-6) / (Math.PI / 2));
  return {top: 90 - 90 * quarters, bottom: 90 * quarters - 90};
}

export class OrientationCube {
  #cube;
  #faces: Map<string, HTMLElement> = new Map();

  constructor(parent: HTMLElement, actions: Actions) {
    this.#cube = h('div', {class: 'cube-body'}, ...FACES.map(([side, turn]) => {
      const name = h('span', {text: side[0].toUpperCase() + side.slice(1)});
      this.#faces.set(side, name);
      return h('button', {
        tabindex: -1,
        title: `View from ${side}`,
        style: `transform: ${turn} translateZ(${HALF}px)`,
        onclick: () => { actions.viewFrom(side); },
      }, name);
    }));
    parent.append(h('div', {class: 'cube', role: 'group', 'aria-label': 'Orientation'}, this.#cube));
  }

  update(view: View) {
    const [side, top, ahead] = [right(view), up(view), forward(view)];
    // Columns: where the cube's own axes (x, -z, -y of the world) are on the screen (x right,
    // y down, z to the viewer).
    const axes = [[1, 0, 0], [0, 0, -1], [0, -1, 0]].map((axis) => [side, top, ahead].map((one, at) =>
      (at ? -1 : 1) * axis.reduce((sum, part, index) => sum + part * one[index], 0)));
    for (const [side, turn] of Object.entries(nameTurns(view.yaw))) {
      const name = this.#faces.get(side);
      if (name) name.style.transform = `rotate(${turn}deg)`;
    }
    this.#cube.style.transform = `matrix3d(${axes.map((axis) => [...axis, 0].join()).join()},0,0,0,1)`;
  }
}
