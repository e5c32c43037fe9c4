/** Texts on the plan that would lie on each other are moved apart. Pure. */

/** Width of a letter and height of a line, in the size of the type. */
const LETTER = 0.56;
const LINE = 1.25;
const TRIES = 12;

interface Placed {
  /** middle, or the beginning where `start` is set */
  x: number;
  /** middle */
  y: number;
  text: string;
  start?: boolean;
}

function boxOf({x, y, text, start}: Placed, size: number) {
  const width = text.length * LETTER * size;
  return {left: start ? x : x - width / 2, right: start ? x + width : x + width / 2,
    top: y - LINE * size / 2, bottom: y + LINE * size / 2};
}

const meet = (a: ReturnType<typeof boxOf>, b: ReturnType<typeof boxOf>) =>
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

/**
 * The labels with places at which none covers another: those before in the list stay, the others
 * step down and up by turns.
 * @param size  of the type, in the units of x and y
 */
export function spread<T extends Placed>(labels: T[], size: number): T[] {
  const taken: ReturnType<typeof boxOf>[] = [];
  return labels.map((label) => {
    for (let step = 0; step < TRIES; step++) {
      const shift = Math.ceil(step / 2) * (step % 2 ? 1 : -1) * LINE * size;
      const moved = {...label, y: label.y + shift};
      const box = boxOf(moved, size);
      if (taken.some((one) => meet(one, box))) continue;
      taken.push(box);
      return moved;
    }
    return label;
  });
}
