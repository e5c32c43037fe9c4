/** Dark and light: the browser's preference, unless the user has chosen. */
import {remembered} from './dom.js';

/** @typedef {'auto'|'dark'|'light'} ThemeName */

/** @returns {{get: () => string, set: (name: ThemeName) => void}} */
export function mountTheme() {
  /** @param {ThemeName} name */
  const apply = (name) => {
    if (name === 'auto') delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = name;
  };
  apply(remembered.get('theme', 'auto'));
  return {
    get: () => document.documentElement.dataset.theme ?? 'auto',
    set: (name) => {
      apply(name);
      remembered.set('theme', name);
    },
  };
}
