/** A rectangle drawn with the mouse: what has its middle in it is selected. */

import {membersOf, withGroups} from '../model_groups.js';
import type {Store} from '../store.js';

type Dragged = {x: number, y: number, lastX: number, lastY: number};

export class BoxSelect {
  #store;
  #element = document.createElement('div');
  #pixelOf;

  /** @param pixelOf  the middle of a model in the page, px */
  constructor(parent: HTMLElement, store: Store, pixelOf: (name: string) =>
      number[]|null) {
    this.#store = store;
    this.#pixelOf = pixelOf;
    this.#element.className = 'box-select';
    this.#element.hidden = true;
    parent.append(this.#element);
  }

  /** Shows the rectangle. */
  show({x, y, lastX, lastY}: Dragged) {
    const box = this.#element.parentElement?.getBoundingClientRect();
    Object.assign(this.#element.style, {
      left: `${Math.min(x, lastX) - (box?.left ?? 0)}px`, width: `${Math.abs(lastX - x)}px`,
      top: `${Math.min(y, lastY) - (box?.top ?? 0)}px`, height: `${Math.abs(lastY - y)}px`,
    });
    this.#element.hidden = false;
  }

  /** Selects what is in the rectangle, with what is selected. */
  end({x, y, lastX, lastY}: Dragged) {
    this.cancel();
    const members = membersOf(this.#store.document);
    const free = members.map(({name}) => name).filter((name) => !this.#store.overlay('locked', name));
    const within = free.filter((name) => {
      const pixel = this.#pixelOf(name);
      return pixel !== null && (pixel[0] - x) * (pixel[0] - lastX) < 0 &&
        (pixel[1] - y) * (pixel[1] - lastY) < 0;
    });
    this.#store.select(withGroups(members, within).filter((name) => free.includes(name)), {add: true});
  }

  cancel() {
    this.#element.hidden = true;
  }
}
