/** Dark and light: the browser's preference, unless the user has chosen. */
import {remembered} from './dom.js';

export type ThemeName = 'auto'|'dark'|'light';

export function mountTheme(): {get: () => string, set: (name: ThemeName) => void} {
  const apply = (name: ThemeName) => {
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
