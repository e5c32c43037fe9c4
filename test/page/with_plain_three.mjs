/** Lets modules that are imported later have `plain_three.mjs` for three. */
import {register} from 'node:module';

const three = JSON.stringify(new URL('plain_three.mjs', import.meta.url).href);
register(`data:text/javascript,${encodeURIComponent(`
export const resolve = (name, context, next) =>
  name === 'three' ? {url: ${three}, shortCircuit: true} : next(name, context);`)}`);
