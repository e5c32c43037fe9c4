/**
 * Soft dark spots on the ground where things stand on it or hover near. Seen from below the ground:
 * the lower a thing, the darker; then blurred.
 */
import {
  LinearFilter, Mesh, MeshBasicMaterial, OrthographicCamera, PlaneGeometry, Scene, ShaderMaterial,
  WebGLRenderTarget,
} from 'three';
import type {Object3D, Texture, WebGLRenderer} from 'three';

/** The layer of the objects that cast contact shadows on the ground. */
export const CASTERS = 1;
const PIXELS = 256;
const STRENGTH = 0.62;

const DEPTH_VERTEX = `
void main() {
  #include <begin_vertex>
  #include <project_vertex>
}`;

const DEPTH_FRAGMENT = `
void main() {
  float low = 1.0 - gl_FragCoord.z;
  gl_FragColor = vec4(0.0, 0.0, 0.0, low * low);
}`;

const BLUR_VERTEX = `
varying vec2 at;
void main() {
  at = uv;
  gl_Position = vec4(position.xy * 2.0, 0.0, 1.0);
}`;

/** Nine taps of a bell curve, one way at a time. */
const BLUR_FRAGMENT = `
uniform sampler2D source;
uniform vec2 way;
varying vec2 at;
void main() {
  float sum = 0.0, weights = 0.0;
  for (int tap = -4; tap <= 4; tap++) {
    float weight = exp(-float(tap * tap) / 8.0);
    sum += weight * texture2D(source, at + float(tap) * way).a;
    weights += weight;
  }
  gl_FragColor = vec4(0.0, 0.0, 0.0, sum / weights);
}`;

const target = () => new WebGLRenderTarget(PIXELS, PIXELS, {minFilter: LinearFilter,
  magFilter: LinearFilter});

export class ContactShadows {
  #camera = new OrthographicCamera();
  #first = target();
  #second = target();
  /** Lies on the ground. */
  mesh = new Mesh(new PlaneGeometry(2, 2), new MeshBasicMaterial({color: 0x000000,
    map: this.#first.texture, transparent: true, opacity: STRENGTH, depthWrite: false,
    fog: false, toneMapped: false,
    // Without a factor: in a coarse picture the slope of one pixel is more than a thin floor.
    polygonOffset: true, polygonOffsetUnits: -4}));
  #depth = new ShaderMaterial({vertexShader: DEPTH_VERTEX, fragmentShader: DEPTH_FRAGMENT, side: 2});
  #blur = new ShaderMaterial({vertexShader: BLUR_VERTEX, fragmentShader: BLUR_FRAGMENT,
    uniforms: {source: {value: null as Texture|null}, way: {value: [0, 0]}},
    depthTest: false, depthWrite: false});
  #sheet = new Scene();
  /** Height of the ground, m; null without ground. */
  #ground: number|null = null;
  #centre: number[] = [0, 0];
  #reach = 8;

  constructor() {
    this.mesh.renderOrder = 0.7;
    this.mesh.visible = false;
    this.#camera.layers.set(CASTERS);
    const sheet = new Mesh(new PlaneGeometry(1, 1), this.#blur);
    sheet.frustumCulled = false;
    // The camera that draws the sheet renders this layer only.
    sheet.layers.set(CASTERS);
    this.#sheet.add(sheet);
  }

  /** @param height  of the ground, m */
  stand(height: number|null) {
    this.#ground = height;
    this.mesh.visible = height !== null;
  }

  /**
   * @param centre  of what is looked at, world, m
   * @param reach  m round it
   */
  cover(centre: number[], reach: number) {
    this.#centre = centre;
    this.#reach = Math.min(Math.max(reach * 0.6, 1.5), 40);
  }

  /** Renders the contact shadows. */
  render(renderer: WebGLRenderer, scene: Scene) {
    if (this.#ground === null) return;
    const reach = this.#reach;
    // From just below the ground upwards, x mirrored by that and turned back by the flipped sheet.
    const camera = this.#camera;
    Object.assign(camera, {left: -reach, right: reach, top: reach, bottom: -reach, near: 0,
      far: Math.min(Math.max(reach * 0.08, 0.12), 0.6)});
    camera.position.set(this.#centre[0], this.#centre[1], this.#ground - 0.002);
    camera.rotation.set(Math.PI, 0, 0);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.mesh.position.set(this.#centre[0], this.#centre[1], this.#ground + 0.001);
    this.mesh.scale.set(reach, -reach, 1);
    this.mesh.updateMatrixWorld();
    const {background, fog, overrideMaterial} = scene;
    Object.assign(scene, {background: null, fog: null, overrideMaterial: this.#depth});
    this.#draw(renderer, this.#first, scene, camera);
    Object.assign(scene, {background, fog, overrideMaterial});
    this.#pass(renderer, this.#first, this.#second, [1 / PIXELS, 0]);
    this.#pass(renderer, this.#second, this.#first, [0, 1 / PIXELS]);
  }

  #draw(renderer: WebGLRenderer, into: WebGLRenderTarget, scene: Object3D, camera: OrthographicCamera) {
    const {autoClear} = renderer;
    const {enabled} = renderer.shadowMap;
    const alpha = renderer.getClearAlpha();
    renderer.shadowMap.enabled = enabled && scene !== this.#sheet;
    renderer.autoClear = true;
    renderer.setClearAlpha(0);
    renderer.setRenderTarget(into);
    renderer.render(scene, camera);
    renderer.setRenderTarget(null);
    renderer.setClearAlpha(alpha);
    renderer.autoClear = autoClear;
    renderer.shadowMap.enabled = enabled;
  }

  #pass(renderer: WebGLRenderer, from: WebGLRenderTarget, into: WebGLRenderTarget, way: number[]) {
    this.#blur.uniforms.source.value = from.texture;
    this.#blur.uniforms.way.value = way;
    this.#draw(renderer, into, this.#sheet, this.#camera);
  }
}
