/** What the view says beside its picture: numbers while dragging, and how far files have come. */

/** Milliseconds after which it is told that meshes and textures are on their way. */
const SLOW_FILES = 500;

/** Numbers over the view while something is dragged; '' hides them. */
export function readout(parent: HTMLElement) {
  const element = document.createElement('output');
  element.className = 'readout';
  element.hidden = true;
  parent.append(element);
  return (text: string) => {
    element.hidden = !text;
    element.textContent = text;
  };
}

/** Returns a function that reports progress after a delay of `SLOW_FILES`, and then the end. */
export function counted(tell: (done: number, of: number, bytes: string) => void) {
  let timer: ReturnType<typeof setTimeout>|undefined;
  let news: [number, number, string] = [0, 0, ''];
  let shown = false;
  return (done: number, of: number, bytes: string) => {
    news = [done, of, bytes];
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
    if (shown) tell(done, of, bytes);
    shown = false;
  };
}
