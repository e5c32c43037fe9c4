/** Records what the view shows, as a WebM file that the browser stores. */
import {saveBlob} from '../actions.js';

const RATE = 30;

export class Video {
  /** @param {import('./panels.js').Page} page @param {() => void} changed begun or ended */
  constructor(page, changed) {
    this.#page = page;
    this.#changed = changed;
  }

  #page;
  #changed;
  #recorder = null;

  get recording() {
    return this.#recorder !== null;
  }

  /** Begins, or ends and hands the file over. */
  toggle() {
    if (this.#recorder) this.#recorder.stop();
    else this.#begin();
  }

  #begin() {
    const canvas = document.querySelector('#view canvas');
    if (!canvas?.captureStream || !globalThis.MediaRecorder) {
      this.#page.notices.say('This browser cannot record the view.');
      return;
    }
    const parts = [];
    const recorder = new MediaRecorder(canvas.captureStream(RATE), {mimeType: 'video/webm'});
    recorder.ondataavailable = ({data}) => parts.push(data);
    recorder.onstop = () => {
      this.#recorder = null;
      this.#changed();
      const blob = new Blob(parts, {type: 'video/webm'});
      if (blob.size) saveBlob(blob, `${this.#page.store.document?.name ?? 'world'}.webm`);
      else this.#page.notices.say('Nothing moved meanwhile: there is no video.');
    };
    recorder.start(1000);
    this.#recorder = recorder;
    this.#changed();
  }
}
