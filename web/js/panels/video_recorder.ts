/** Records what the view shows, as a WebM file that the browser stores. */
import {saveBlob} from '../actions.js';
import type {Page} from './panels.js';

const RATE = 30;
const SLICE_MS = 1000;
const LONGEST_WAIT_MS = 5000;
const STILL_MS = 200;  // a still view is drawn again so often, for a video has no length without

export class Video {
  /** @param changed  begun or ended */
  constructor(page: Page, changed: () => void) {
    this.#page = page;
    this.#changed = changed;
  }

  #page;
  #changed;
  #recorder: MediaRecorder|null = null;
  #redrawing: ReturnType<typeof setInterval>|0 = 0;
  #parts: Blob[] = [];
  #ending = false;

  get recording() {
    return this.#recorder !== null;
  }

  /** Begins, or ends and hands the file over. */
  toggle() {
    if (!this.#recorder) this.#begin();
    else if (this.#recorder.state === 'recording') this.#end();
  }

  /** A film of less than a picture is no file: the first one is waited for. */
  #end() {
    const recorder = this.#recorder;
    if (!recorder) return;
    this.#ending = true;
    if (this.#parts.length) recorder.stop();
    else setTimeout(() => recorder.state === 'recording' && recorder.stop(), LONGEST_WAIT_MS);
  }

  #begin() {
    const canvas = document.querySelector('#view canvas');
    if (!(canvas instanceof HTMLCanvasElement) || !canvas.captureStream || !globalThis.MediaRecorder) {
      this.#page.notices.say('This browser does not support video recording.');
      return;
    }
    const parts: Blob[] = [];
    const recorder = new MediaRecorder(canvas.captureStream(RATE), {mimeType: 'video/webm'});
    recorder.ondataavailable = ({data}) => {
      if (data.size) parts.push(data);
      if (parts.length && this.#ending && recorder.state === 'recording') recorder.stop();
    };
    recorder.onstop = () => {
      this.#recorder = null;
      this.#ending = false;
      clearInterval(this.#redrawing);
      this.#changed();
      const blob = new Blob(parts, {type: 'video/webm'});
      if (blob.size) saveBlob(blob, `${this.#page.store.document?.name ?? 'world'}.webm`);
      else this.#page.notices.say('No frames were recorded; no video was saved.');
    };
    this.#parts = parts;
    recorder.start(SLICE_MS);
    this.#redrawing = setInterval(() => this.#page.view?.redraw(), STILL_MS);
    this.#recorder = recorder;
    this.#changed();
  }
}
