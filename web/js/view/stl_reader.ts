/** Reads STL files in a worker; without workers it reads them in the page. */
import {readStl} from './stl.js';
import type {Limits, ReadStl} from './stl.js';
import type {Asked} from './stl_worker.js';

type Answer = {id: number, found?: ReadStl, fault?: string};

/** In tests and in pages of one file there is no worker, or none that can be loaded. */
const hasWorker = () => typeof Worker !== 'undefined' && location.protocol.startsWith('http');

export class StlReader {
  #worker: Worker|null = null;
  #waiting: Map<number, {take: (found: ReadStl) => void, fail: (fault: Error) => void}> = new Map();
  #last = 0;
  #alone;

  /** @param alone  read without a worker */
  constructor({alone}: {alone: boolean}) {
    this.#alone = alone || !hasWorker();
  }

  /** @param content  is transferred to the worker */
  async read(content: ArrayBuffer, limits: Limits|null): Promise<ReadStl> {
    if (this.#alone) return readStl(content, limits);
    const worker = this.#worker ??= this.#start();
    const asked: Asked = {id: this.#last += 1, content, limits};
    return new Promise((take, fail) => {
      this.#waiting.set(asked.id, {take, fail});
      worker.postMessage(asked, [content]);
    });
  }

  #start() {
    const worker = new Worker('/js/view/stl_worker.js', {type: 'module'});
    worker.addEventListener('message', ({data: {id, found, fault}}: MessageEvent<Answer>) => {
      const waiting = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (found) waiting?.take(found);
      else waiting?.fail(new Error(fault));
    });
    worker.addEventListener('error', (event) => {
      for (const {fail} of this.#waiting.values()) fail(new Error(event.message || 'the reader of STL files has failed'));
      this.#waiting.clear();
      this.#worker = null;
    });
    return worker;
  }
}
