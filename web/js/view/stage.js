/**
 * The canvas, and when it is drawn: on change only. While things move on a slow machine the picture
 * is drawn coarser, and once more in full when they rest.
 */
import {
  Color, OrthographicCamera, PCFShadowMap, PerspectiveCamera, Scene, SRGBColorSpace, WebGLRenderer,
  WebGLRenderTarget,
} from 'three';

/** Frames slower than this (ms) make the next ones coarser, faster than the other finer. */
const SLOW = 45;
const FAST = 18;
const COARSEST = 0.5;
/** Milliseconds of rest before the full picture. */
const REST = 250;

/** Thrown where the browser offers no WebGL. */
export class NoWebGL extends Error {}

export class Stage {
  scene = new Scene();
  perspective = new PerspectiveCamera(40, 1, 0.1, 5000);
  orthographic = new OrthographicCamera(-1, 1, 1, -1, -5000, 5000);
  /** The one of the two that is looked through. */
  camera = this.perspective;
  /** Pictures in the last second, 0 at rest. */
  fps = 0;
  /** Called before each picture with its time, ms; true: another one is wanted after it. */
  onBeforeDraw = () => false;
  /** Called when the canvas has another size. */
  onResize = () => {};

  #element;
  #wanted = 0;
  #quality = 1;
  #times = [];
  #restTimer = null;
  #lost = false;
  #last = 0;
  #resizes;
  #shadowsWanted = true;

  /**
   * @param {HTMLElement} element  the canvas is put into it and follows its size
   * @throws {NoWebGL}
   */
  constructor(element) {
    this.#element = element;
    this.canvas = document.createElement('canvas');
    this.canvas.className = 'view-canvas';
    Object.assign(this.canvas.style, {position: 'absolute', inset: '0', width: '100%',
      height: '100%', display: 'block', touchAction: 'none'});
    try {
      this.renderer = new WebGLRenderer({canvas: this.canvas, antialias: true,
        powerPreference: 'high-performance'});
    } catch (error) {
      throw new NoWebGL(String(error.message ?? error));
    }
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.scene.background = new Color(0.7, 0.7, 0.7);
    this.scene.matrixAutoUpdate = false;
    this.canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.#lost = true;
    });
    this.canvas.addEventListener('webglcontextrestored', () => {
      this.#lost = false;
      this.shadowsChanged();
    });
    element.prepend(this.canvas);
    this.#resizes = new ResizeObserver(() => this.#resize());
    this.#resizes.observe(element);
    this.#resize();
  }

  get width() { return Math.max(this.#element.clientWidth, 1); }
  get height() { return Math.max(this.#element.clientHeight, 1); }
  get aspect() { return this.width / this.height; }

  /** Asks for a picture at the browser's next turn. */
  invalidate() {
    if (this.#wanted || this.#lost) return;
    this.#wanted = requestAnimationFrame((time) => this.#frame(time));
  }

  /** Something that throws a shadow, or its light, has changed. */
  shadowsChanged() {
    this.#shadowsWanted = true;
    this.invalidate();
  }

  /** Draws at once and gives the picture as a PNG. @returns {Promise<Blob>} */
  picture() {
    this.#setQuality(1);
    this.#draw(performance.now());
    return new Promise((resolve) => this.canvas.toBlob(resolve, 'image/png'));
  }

  /**
   * Draws another scene into a square and comes back to this one.
   * @returns {Promise<Blob>} PNG
   */
  borrow(scene, camera, size) {
    const shadows = this.renderer.shadowMap.enabled;
    this.renderer.shadowMap.enabled = false;
    const target = new WebGLRenderTarget(size, size, {samples: 4, colorSpace: SRGBColorSpace});
    this.renderer.setRenderTarget(target);
    this.renderer.render(scene, camera);
    const pixels = new Uint8ClampedArray(size * size * 4);
    this.renderer.readRenderTargetPixels(target, 0, 0, size, size, pixels);
    this.renderer.setRenderTarget(null);
    this.renderer.shadowMap.enabled = shadows;
    target.dispose();
    return asPng(pixels, size);
  }

  dispose() {
    cancelAnimationFrame(this.#wanted);
    clearTimeout(this.#restTimer);
    this.#resizes.disconnect();
    this.renderer.dispose();
    this.canvas.remove();
  }

  #frame(time) {
    this.#wanted = 0;
    if (this.#lost) return;
    const gap = time - this.#last;
    this.#last = time;
    if (gap < 500) this.#adapt(gap);
    if (this.#draw(time)) this.invalidate();
    this.#count(time);
    clearTimeout(this.#restTimer);
    this.#restTimer = setTimeout(() => this.#rest(), REST);
  }

  /** Between the frames of a run of them: the time that one takes, whoever is slow. */
  #adapt(gap) {
    this.#times.push(gap);
    if (this.#times.length < 8) return;
    const typical = this.#times.sort((a, b) => a - b)[4];
    this.#times = [];
    if (typical > SLOW) this.#setQuality(Math.max(this.#quality * 0.75, COARSEST));
    else if (typical < FAST) this.#setQuality(Math.min(this.#quality * 1.25, 1));
  }

  #rest() {
    this.#times = [];
    this.fps = 0;
    if (this.#quality === 1 && !this.#shadowsWanted) return;
    this.#setQuality(1);
    this.#draw(performance.now());
  }

  #setQuality(quality) {
    if (quality === this.#quality) return;
    this.#quality = quality;
    this.#applySize();
  }

  /** @returns {boolean} whether another picture is wanted */
  #draw(time) {
    const more = this.onBeforeDraw(time);
    this.renderer.shadowMap.needsUpdate = this.#shadowsWanted;
    this.#shadowsWanted = false;
    this.renderer.render(this.scene, this.camera);
    return more;
  }

  #count(time) {
    this.#recent = this.#recent.filter((then) => time - then < 1000);
    this.#recent.push(time);
    this.fps = this.#recent.length;
  }
  #recent = [];

  #resize() {
    this.#applySize();
    this.onResize();
    // At once: an emptied canvas would flicker until the next turn.
    if (!this.#lost) this.#draw(performance.now());
  }

  #applySize() {
    this.renderer.setPixelRatio(Math.min(globalThis.devicePixelRatio ?? 1, 2) * this.#quality);
    this.renderer.setSize(this.width, this.height, false);
  }
}

/** Pixels as WebGL gives them, lowest row first. @returns {Promise<Blob>} */
function asPng(pixels, size) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = size;
  const upright = new ImageData(size, size);
  const row = size * 4;
  for (let y = 0; y < size; y++) {
    upright.data.set(pixels.subarray((size - 1 - y) * row, (size - y) * row), y * row);
  }
  canvas.getContext('2d').putImageData(upright, 0, 0);
  return new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
}
