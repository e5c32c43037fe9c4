/** Globals of browsers and of Node.js 20 that Node.js 18 lacks. */
import {File} from 'node:buffer';

globalThis.File ??= File;

globalThis.CustomEvent ??= class CustomEvent extends Event {
  constructor(type, options = {}) {
    super(type, options);
    this.detail = options.detail ?? null;
  }
};
