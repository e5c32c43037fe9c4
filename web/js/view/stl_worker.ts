/** Reads STL files in a worker, so that the page responds meanwhile. */
import {buffersOf, readStl} from './stl.js';
import type {Limits} from './stl.js';

export type Asked = {id: number, content: ArrayBuffer, limits: Limits|null};

addEventListener('message', ({data}: MessageEvent<Asked>) => {
  const {id, content, limits} = data;
  try {
    const found = readStl(content, limits);
    postMessage({id, found}, {transfer: buffersOf(found)});
  } catch (error) {
    postMessage({id, fault: error instanceof Error ? error.message : String(error)});
  }
});
