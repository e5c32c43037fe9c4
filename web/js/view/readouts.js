/** What the view says beside its picture: numbers while dragging, and how far files have come. */

/** Milliseconds after which it is told that meshes and textures are on their way. */
const SLOW_FILES = 500;

/**
 * Numbers over the view while something is dragged; '' hides them.
 * @param {HTMLElement} parent
 */
export function readout(parent) {
  const element = document.createElement('output');
  element.className = 'readout';
  element.hidden = true;
  parent.append(element);
  return (/** @type {string} */ text) => {
    element.hidden = !text;
    element.textContent = text;
  };
}

/**
 * Returns a function that reports progress after a delay of `SLOW_FILES`, and then the end.
 * @param {(done: number, of: number) => void} tell
 */
export function counted(tell) {
  /** @type {ReturnType<typeof setTimeout>|undefined} */
  let timer;
  /** @type {[number, number]} */
  let news = [0, 0];
  let shown = false;
  return (/** @type {number} */ done, /** @type {number} */ of) => {
    news = [done, of];
    if (done < of) {
      timer ??= setTimeout(() => {
        timer = undefined;
        shown = news[0] < news[1];
        if (shown) tell(...news);
      }, shown ? 100 : SLOW_FILES);
      return;
    }
    clearTimeout(timer);
    timer = undefined;
    if (shown) tell(done, of);
    shown = false;
  };
}
