/** Style sheets of editors that few open: fetched when they are. */
import {h} from './dom.js';

/**
 * Settles when the sheet is there, or cannot be had.
 * @param name  of the file in css/
 */
export function styled(name: string): Promise<unknown> {
  const href = new URL(`../../css/${name}`, import.meta.url).href;
  if (document.querySelector(`link[href="${href}"]`)) return Promise.resolve();
  return new Promise((resolve) => {
    document.head.append(h('link', {rel: 'stylesheet', href, onload: resolve, onerror: resolve}));
  });
}
