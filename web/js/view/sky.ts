/** The background: the world's sky, or a plain gradient if the world defines none. */
import {
  Color, DoubleSide, LatheGeometry, Mesh, ShaderMaterial, SphereGeometry, Vector2, Vector3,
} from 'three';
import {colorOf} from './three_convert.js';
import {SKY, SKY_COLOR} from '../palette.js';
import type {BufferGeometry} from 'three';
import type {Scene as SceneSettings, Sky} from '../protocol.js';

/** Gazebo's defaults (SDF spec 1.7, scene): a world that has these has not chosen. */
const DEFAULTS = {ambient: [0.4, 0.4, 0.4], background: [0.7, 0.7, 0.7]};
/** Colours of the gradient, sRGB. */
const GRADIENT = {zenith: 0x3f7cc4, horizon: 0xdbe6f0};

const same = (color: number[]|null|undefined, other: number[]) =>
  other.every((part, index) => Math.abs((color?.[index] ?? part) - part) < 1e-3);

/** Returns whether a world sets no background. */
export const leavesBackground = ({background, sky, fog}: Pick<SceneSettings,
    'background'|'sky'|'fog'>) =>
  !sky && (!fog || fog.type === 'none') && same(background, DEFAULTS.background);

/** Returns whether a world sets no ambient light. */
export const leavesAmbient = ({ambient}: Pick<SceneSettings, 'ambient'>) => same(ambient,
    DEFAULTS.ambient);

const VERTEX = `
varying vec3 ahead;
void main() {
  ahead = position;
  // An orthographic camera looks the same way everywhere.
  float radius = projectionMatrix[3][3] == 1.0 ? 1.0e5 : 1.0;
  vec4 place = projectionMatrix * vec4(radius * (mat3(viewMatrix) * position), 1.0);
  gl_Position = place.xyww;
}`;

const SKY_FRAGMENT = `
varying vec3 ahead;
${SKY_COLOR}void main() {
  gl_FragColor = vec4(sky(normalize(ahead)), 1.0);
  #include <colorspace_fragment>
}`;

/** The gradient is computed at the corners, and on the screen's scale: between them nothing is left to do. */
const GRADIENT_VERTEX = `
uniform vec3 zenith, horizon;
varying vec3 shown;
vec3 encoded(vec3 color) { return pow(color, vec3(1.0 / 2.4)) * 1.055 - 0.055; }
${VERTEX.replace('varying vec3 ahead;', '').replace('ahead = position;',
    'shown = encoded(mix(horizon, zenith, pow(max(position.z, 0.0), 0.52)));')}`;

const GRADIENT_FRAGMENT = `
varying vec3 shown;
void main() { gl_FragColor = vec4(shown, 1.0); }`;

/** Rings of the gradient, closer together towards the horizon, where it changes most. */
const RINGS = 40;

function rings() {
  const levels = Array.from({length: RINGS + 1}, (_, ring) => (ring / RINGS) ** 2);
  const outline = [-1, ...levels].map((z) => new Vector2(Math.sqrt(1 - z * z), z));
  return new LatheGeometry(outline, 24).rotateX(Math.PI / 2);
}

/** @param geometry  about the eye */
function dome(geometry: BufferGeometry, shaders: {vertexShader: string, fragmentShader: string,
    uniforms: Record<string, {value: unknown}>}) {
  const mesh = new Mesh(geometry, new ShaderMaterial({...shaders, side: DoubleSide, depthWrite: false,
    fog: false}));
  // Last of what is opaque: only what nothing covers is computed.
  mesh.renderOrder = 0.5;
  mesh.frustumCulled = false;
  return mesh;
}

const DAY = {zenith: new Color(SKY.day_zenith), horizon: new Color(SKY.day_horizon)};
const NIGHT = {zenith: new Color(SKY.night_zenith), horizon: new Color(SKY.night_horizon)};
const DUSK = new Color(SKY.dusk);

/** The sky that a world describes. */
export class WorldSky {
  dome = dome(new SphereGeometry(1, 32, 24), {vertexShader: VERTEX, fragmentShader: SKY_FRAGMENT,
    uniforms: {sun: {value: new Vector3()}, zenith: {value: new Color()},
      horizon: {value: new Color()}, cloud_color: {value: new Color()}, cover: {value: 0.5},
      size: {value: 1}, drift: {value: 0}}});

  /** @returns of what is level with the eye and below */
  get horizon(): Color { return this.dome.material.uniforms.horizon.value; }

  /** Hours of the day put the sun and its colours where they belong. */
  take(sky: Sky) {
    const {uniforms} = this.dome.material;
    const day = sky.sunset - sky.sunrise;
    const part = day > 0 ? (sky.time - sky.sunrise) / day : 0.5;
    const elevation = Math.sin(Math.PI * part);
    uniforms.sun.value.set(Math.cos(Math.PI * part), -0.25, elevation).normalize();
    const light = Math.min(Math.max(elevation * 3 + 0.15, 0), 1);
    uniforms.zenith.value.lerpColors(NIGHT.zenith, DAY.zenith, light);
    uniforms.horizon.value.lerpColors(NIGHT.horizon, DAY.horizon, light)
      .lerp(DUSK, Math.max(0, 0.6 - Math.abs(elevation) * 2.5));
    uniforms.cloud_color.value.copy(colorOf(sky.cloud_ambient)).multiplyScalar(1.15 * light + 0.05);
    uniforms.cover.value = Math.min(Math.max(sky.cloud_humidity, 0), 1);
    uniforms.size.value = 0.6 + sky.cloud_mean_size;
    uniforms.drift.value = sky.cloud_direction;
  }
}

/** The gradient of the view itself. */
export class Gradient {
  horizon = new Color(GRADIENT.horizon);
  dome = dome(rings(), {vertexShader: GRADIENT_VERTEX, fragmentShader: GRADIENT_FRAGMENT,
    uniforms: {zenith: {value: new Color(GRADIENT.zenith)}, horizon: {value: this.horizon}}});
}
