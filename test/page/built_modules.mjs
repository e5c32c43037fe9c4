/**
 * Loads the page's modules as JavaScript, which the set-up has made of them, and gives Node.js 18 the
 * globals of browsers and of Node.js 20 that it lacks.
 */
import {File} from 'node:buffer';
import {register} from 'node:module';
import {pathToFileURL} from 'node:url';

globalThis.File ??= File;

globalThis.CustomEvent ??= class CustomEvent extends Event {
  constructor(type, options = {}) {
    super(type, options);
    this.detail = options.detail ?? null;
  }
};

const packages = process.env.MY_SIMULATIONS_NODE_MODULES;
if (!packages) throw new Error('MY_SIMULATIONS_NODE_MODULES must name the node_modules of the workspace');
const sources = JSON.stringify(new URL('../../web/js/', import.meta.url).href);
const built = JSON.stringify(pathToFileURL(`${packages}/my_simulations_page/js/`).href);
register(`data:text/javascript,${encodeURIComponent(`
export const resolve = (name, context, next) => {
  const address = name.startsWith('.') ? new URL(name, context.parentURL).href : name;
  return next(address.startsWith(${sources}) ? ${built} + address.slice(${sources}.length) : name, context);
};`)}`);
