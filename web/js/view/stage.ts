/**
 * The canvas, and when it is drawn: on change only. While things move on a slow machine the picture
 * is drawn coarser, and once more in full when they rest.
 */
import {
  Color, CustomToneMapping, OrthographicCamera, PCFShadowMap, PerspectiveCamera, Scene,
  SRGBColorSpace, WebGLRenderer, WebGLRenderTarget,
} from 'three';
import {GiveWay} from './give_way.js';
import {gazeboFog, keepHighlights, spareProcessor} from './shader_chunks.js';
import type {Camera} from 'three';

/** Pictures that take longer (ms) make the next ones coarser, quicker than the other finer. */
const SLOW = 45;
const FAST = 15;
const COARSEST = 0.5;
/** Milliseconds between new shadows while pictures are slow. */
const SLOW_SHADOWS = 300;
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software/i;
/**
 * A processor that draws in place of a graphics card pays for smooth edges with every picture:
 * there moving pictures are coarse, and those at rest are drawn larger than they are shown. It also
 * pays for each change of size, so it begins with the coarsest.
 */
const QUALITY = {card: {start: 1, best: 1}, processor: {start: COARSEST, best: 1.5}};
/** Milliseconds of rest before the full picture, and times the last picture took: a hand that drags pauses as long. */
const REST = 600;
const REST_PICTURES = 3;
/** Milliseconds between pictures of what creeps: they are drawn in full, for the rest goes on. */
const CREEP = 1000;

/** The name of what draws. @throws {NoWebGL} */
function driver() {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) throw new NoWebGL('no WebGL 2');
  const names = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return name;
}

/** Thrown where the browser offers no WebGL. */
export class NoWebGL extends Error {}

export class Stage {
  canvas = document.createElement('canvas');
  software;
  renderer;
  scene = new Scene();
  perspective = new PerspectiveCamera(40, 1, 0.1, 5000);
  orthographic = new OrthographicCamera(-1, 1, 1, -1, -5000, 5000);
  /** The one of the two that is looked through. */
  camera: PerspectiveCamera|OrthographicCamera = this.perspective;
  /** Pictures in the last second, 0 at rest. */
  fps = 0;
  /** Pictures since the page began. */
  pictures = 0;
  /**
   * Called before each picture with its time, ms, and whether it is drawn as well as can be; true: another one is
   * wanted after it.
   */
  onBeforeDraw: (time: number, full: boolean) => boolean = () => false;
  /** Called before shadows are drawn. */
  onShadows: (renderer: WebGLRenderer, scene: Scene) => void = () => {};
  /** Called before a picture with whether it may take its time. */
  onQuality: (full: boolean) => void = () => {};
  /** Called when the canvas has another size. */
  onResize = () => {};

  #element;
  #wanted = 0;
  #quality = 1;
  #best = 1;
  #times: number[] = [];
  #restTimer: ReturnType<typeof setTimeout>|undefined;
  #lost = false;
  #creeping = false;
  #crept = -CREEP;
  #fence: WebGLSync|null = null;
  #begun = 0;
  /** Milliseconds of the last picture. */
  #took = 0;
  #waited = false;
  #shadowed = -SLOW_SHADOWS;
  #drawn = false;
  #recent: number[] = [];
  #way = new GiveWay();
  #next: number|null = null;
  #resizes = new ResizeObserver(() => this.#resize());
  #shadowsWanted = true;
  /** Pixels of the page, noted because asking the element costs a layout. */
  #size = [1, 1];

  /**
   * @param element  the canvas is put into it and follows its size
   * @throws {NoWebGL}
   */
  constructor(element: HTMLElement) {
    this.#element = element;
    this.canvas.className = 'view-canvas';
    Object.assign(this.canvas.style, {position: 'absolute', inset: '0', width: '100%',
      height: '100%', display: 'block', touchAction: 'none'});
    const software = SOFTWARE.test(driver());
    this.software = software;
    ({start: this.#quality, best: this.#best} = QUALITY[software ? 'processor' : 'card']);
    try {
      this.renderer = new WebGLRenderer({canvas: this.canvas, antialias: !software,
        powerPreference: 'high-performance'});
    } catch (error) {
      throw new NoWebGL(error instanceof Error ? error.message : String(error));
    }
    keepHighlights();
    gazeboFog();
    if (software) spareProcessor();
    this.renderer.toneMapping = CustomToneMapping;
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
      this.#fence = null;
      this.shadowsChanged();
    });
    element.prepend(this.canvas);
    this.#resizes.observe(element);
    this.#resize();
  }

  get width() { return this.#size[0]; }
  get height() { return this.#size[1]; }
  get aspect() { return this.width / this.height; }

  /** Requests a picture in the browser's next animation frame. */
  invalidate() {
    if (this.#wanted || this.#lost) return;
    this.#wanted = requestAnimationFrame((time) => this.#frame(time));
  }

  /**
   * Something has moved by a pixel or two. A picture at rest shows it in full, now and then.
   * @returns whether it does now; else it comes with the next picture
   */
  creep(): boolean {
    const now = performance.now();
    if (this.fps || this.#wanted || this.#lost || now - this.#crept < CREEP) return false;
    this.#crept = now;
    this.#creeping = this.#shadowsWanted = true;
    this.invalidate();
    return true;
  }

  /** A hand is at work beside the view: while pictures are slow, what it does is seen before the next. */
  giveWay(hand: 'press'|'move') {
    this.#way.hand(hand, performance.now());
  }

  /** Marks a change that is too small to draw now: the picture at rest shows it. */
  owe() {
    this.#shadowsWanted = true;
  }

  /** Something that throws a shadow, or its light, has changed. */
  shadowsChanged() {
    this.#shadowsWanted = true;
    this.invalidate();
  }

  /** Draws at once and gives the picture as a PNG. */
  picture(): Promise<Blob|null> {
    this.#drawInFull();
    return new Promise((resolve) => this.canvas.toBlob(resolve, 'image/png'));
  }

  /**
   * Draws another scene into a square and comes back to this one.
   * @returns PNG
   */
  borrow(scene: Scene, camera: Camera, size: number): Promise<Blob|null> {
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

  #frame(time: number) {
    this.#wanted = 0;
    if (this.#lost) return;
    // Pictures that wait behind others would only make the mouse feel late.
    if (this.#isDrawing() || this.#way.waits(performance.now())) {
      this.invalidate();
      return;
    }
    if (this.#creeping) {
      this.#creeping = false;
      this.#drawInFull();
      return;
    }
    if (this.#next !== null) {
      this.#setQuality(this.#next);
      this.#next = null;
    }
    if (this.#draw(time)) this.invalidate();
    this.#count(time);
    this.#watchRest();
  }

  #watchRest() {
    clearTimeout(this.#restTimer);
    this.#restTimer = setTimeout(() => this.#rest(), Math.max(REST, REST_PICTURES * this.#took));
  }

  /** Returns whether the last picture is still being drawn. Records its duration when it is done. */
  #isDrawing() {
    if (!this.#fence) return false;
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    const done = gl.getSyncParameter(this.#fence, gl.SYNC_STATUS) === gl.SIGNALED;
    const took = performance.now() - this.#begun;
    if (!done && took < 2000) {
      this.#waited = true;
      return true;
    }
    gl.deleteSync(this.#fence);
    this.#fence = null;
    // Without an earlier check, a late end does not mean that the picture was slow.
    if (this.#waited || took < SLOW) {
      this.#took = took;
      this.#way.pictured(took, performance.now());
      this.#adapt(took);
    }
    this.#waited = false;
    return false;
  }

  #adapt(took: number) {
    this.#times.push(took);
    if (this.#times.length < 4) return;
    const typical = this.#times.sort((a, b) => a - b)[1];
    this.#times = [];
    if (typical > SLOW) this.#setQuality(Math.max(this.#quality * 0.75, COARSEST));
    else if (typical < FAST) this.#setQuality(Math.min(this.#quality * 1.25, 1));
  }

  #rest() {
    if (this.#wanted || this.#isDrawing()) {
      this.#watchRest();
      return;
    }
    this.fps = 0;
    this.#recent = [];
    if (this.#quality === this.#best && !this.#shadowsWanted) return;
    this.#drawInFull();
  }

  /** Draws at the best quality and keeps the present quality for the next movement. */
  #drawInFull() {
    this.#next ??= this.#quality;
    this.#setQuality(this.#best);
    this.#draw(performance.now());
  }

  #setQuality(quality: number) {
    if (quality === this.#quality) return;
    this.#quality = quality;
    this.#applySize();
  }

  /** @returns whether another picture is wanted */
  #draw(time: number): boolean {
    const {renderer} = this;
    const more = this.onBeforeDraw(time, this.#quality >= this.#best);
    this.onQuality(this.#quality >= 1);
    const shadows = this.#shadowsWanted &&
      (this.#quality >= 1 || time - this.#shadowed > SLOW_SHADOWS);
    if (shadows) {
      this.onShadows(renderer, this.scene);
      renderer.shadowMap.needsUpdate = true;
      this.#shadowsWanted = false;
      this.#shadowed = time;
    }
    renderer.render(this.scene, this.camera);
    const gl = renderer.getContext() as WebGL2RenderingContext;
    if (!this.#fence) {
      this.#fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      this.#begun = performance.now();
    }
    this.#drawn = true;
    this.pictures++;
    return more;
  }

  #count(time: number) {
    this.#recent = this.#recent.filter((then) => time - then < 1000);
    this.#recent.push(time);
    this.fps = this.#recent.length;
  }

  #resize() {
    const width = Math.max(this.#element.clientWidth, 1);
    const height = Math.max(this.#element.clientHeight, 1);
    if (width === this.#size[0] && height === this.#size[1]) return;
    this.#size = [width, height];
    this.#applySize();
    this.onResize();
    // At once: an emptied canvas would flicker until the next turn.
    if (this.#drawn && !this.#lost) this.#draw(performance.now());
  }

  #applySize() {
    this.renderer.setDrawingBufferSize(this.width, this.height,
      Math.min(globalThis.devicePixelRatio ?? 1, 2) * this.#quality);
    // three rounds half a pixel up until the next shadow, and down from then on: without this, pictures
    // with and without new shadows would differ in size.
    this.renderer.setRenderTarget(null);
  }
}

/** Pixels as WebGL gives them, lowest row first. */
function asPng(pixels: Uint8ClampedArray, size: number): Promise<Blob|null> {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = size;
  const upright = new ImageData(size, size);
  const row = size * 4;
  for (let y = 0; y < size; y++) {
    upright.data.set(pixels.subarray((size - 1 - y) * row, (size - y) * row), y * row);
  }
  canvas.getContext('2d')?.putImageData(upright, 0, 0);
  return new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
}
