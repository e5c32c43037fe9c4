/** Background, sky, fog, grid, origin and roads: what the world and the view's flags say. */
import {
  BackSide, BufferAttribute, BufferGeometry, Color, Fog, FogExp2, LineBasicMaterial, LineSegments,
  Mesh, ShaderMaterial, SphereGeometry, Vector3,
} from 'three';
import {colorOf} from './three_convert.js';
import {SKY, SKY_COLOR} from './palette.js';
/** @import {Materials} from './materials.js' */
/** @import {Road, Sky} from '../protocol.js' */
/** @import {Stage} from './stage.js' */
/** @import {Store} from '../store.js' */

const GRID_CELLS = 20;

/** @param {number[]} points @param {number[]} [colors] */
function lines(points, colors) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
  if (colors) geometry.setAttribute('color', new BufferAttribute(new Float32Array(colors), 3));
  return geometry;
}

/** Gazebo's grid: 20 x 20 cells of 1 m; every fifth line a little stronger. */
function makeGrid() {
  const half = GRID_CELLS / 2;
  const points = [];
  const colors = [];
  for (let at = -half; at <= half; at++) {
    points.push(-half, at, 0, half, at, 0, at, -half, 0, at, half, 0);
    const shade = at % 5 === 0 ? 0.06 : 0.2;
    for (let end = 0; end < 4; end++) colors.push(shade, shade, shade);
  }
  const grid = new LineSegments(lines(points, colors), new LineBasicMaterial({
    vertexColors: true, transparent: true, opacity: 0.5, depthWrite: false, fog: true}));
  grid.renderOrder = 1;
  return grid;
}

/** The axes at the world's origin. */
function makeOrigin() {
  const points = [0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1];
  const colors = [1, 0.1, 0.1, 1, 0.1, 0.1, 0.1, 0.75, 0.1, 0.1, 0.75, 0.1, 0.2, 0.3, 1, 0.2, 0.3,
    1];
  const origin = new LineSegments(lines(points, colors), new LineBasicMaterial({
    vertexColors: true, depthWrite: false}));
  origin.renderOrder = 2;
  return origin;
}

const SKY_VERTEX = `
varying vec3 ahead;
void main() {
  ahead = position;
  vec4 place = projectionMatrix * vec4(mat3(viewMatrix) * position, 1.0);
  gl_Position = place.xyww;
}`;

const SKY_FRAGMENT = `
varying vec3 ahead;
${SKY_COLOR}void main() {
  gl_FragColor = vec4(sky(normalize(ahead)), 1.0);
  #include <colorspace_fragment>
}`;

const DAY = {zenith: new Color(SKY.day_zenith), horizon: new Color(SKY.day_horizon)};
const NIGHT = {zenith: new Color(SKY.night_zenith), horizon: new Color(SKY.night_horizon)};
const DUSK = new Color(SKY.dusk);

function makeSky() {
  const dome = new Mesh(new SphereGeometry(1, 32, 24), new ShaderMaterial({
    vertexShader: SKY_VERTEX, fragmentShader: SKY_FRAGMENT, side: BackSide, depthWrite: false,
    depthTest: false, fog: false,
    uniforms: {sun: {value: new Vector3()}, zenith: {value: new Color()},
      horizon: {value: new Color()}, cloud_color: {value: new Color()}, cover: {value: 0.5},
      size: {value: 1}, drift: {value: 0}},
  }));
  dome.renderOrder = -10;
  dome.frustumCulled = false;
  return dome;
}

/**
 * Hours of the day put the sun and its colours where they belong.
 * @param {Mesh<SphereGeometry, ShaderMaterial>} dome
 * @param {Sky} sky
 */
function colorSky(dome, sky) {
  const {uniforms} = dome.material;
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

/**
 * Gazebo's fog in three's: constant has no thinning with distance but its density.
 * @param {import('../protocol.js').Fog|null|undefined} fog
 */
function fogOf(fog) {
  if (!fog || fog.type === 'none') return null;
  const color = colorOf(fog.color);
  if (fog.type === 'linear') return new Fog(color, fog.start, fog.end);
  return new FogExp2(color, fog.density * (fog.type === 'quadratic' ? 0.5 : 1) / 10);
}

/** @param {Road} road */
function ribbon({points, width}) {
  /** @type {number[]} */
  const corners = [];
  /** @type {number[]} */
  const uvs = [];
  /** @type {number[]} */
  const triangles = [];
  let along = 0;
  points.forEach((point, index) => {
    const before = points[Math.max(index - 1, 0)];
    const after = points[Math.min(index + 1, points.length - 1)];
    const [dx, dy] = [after[0] - before[0], after[1] - before[1]];
    const norm = Math.hypot(dx, dy) || 1;
    const side = [(-dy / norm) * width / 2, (dx / norm) * width / 2];
    along += index ? Math.hypot(point[0] - before[0], point[1] - before[1]) / width : 0;
    for (const [sign, u] of [[1, 0], [-1, 1]]) {
      corners.push(point[0] + sign * side[0], point[1] + sign * side[1], point[2] + 0.01);
      uvs.push(u, along);
    }
    if (index) {
      const at = 2 * index;
      triangles.push(at - 2, at - 1, at, at, at - 1, at + 1);
    }
  });
  const geometry = lines(corners);
  geometry.setAttribute('uv', new BufferAttribute(new Float32Array(uvs), 2));
  geometry.setIndex(triangles);
  geometry.computeVertexNormals();
  return geometry;
}

const ASPHALT = {texture: {pattern: 'road', scale: [1, 1]}};

export class Surroundings {
  #stage;
  #store;
  #materials;
  #grid = makeGrid();
  #origin = makeOrigin();
  #sky = makeSky();
  /** @type {Mesh[]} */
  #roads = [];

  /** @param {{stage: Stage, store: Store, materials: Materials}} options */
  constructor({stage, store, materials}) {
    this.#stage = stage;
    this.#store = store;
    this.#materials = materials;
    stage.scene.add(this.#grid, this.#origin);
    store.listen('document', () => this.#apply());
    store.listen('overlays', () => this.#flags());
    store.listen('entity', ({detail}) => {
      if (detail.kind === 'world') this.#apply();
    });
  }

  /** Hides the helpers, for a thumbnail. */
  get helpers() {
    return [this.#grid, this.#origin];
  }

  #flags() {
    const {scene} = this.#store.document ?? {};
    this.#grid.visible = this.#store.overlays.scene.grid && scene?.grid !== false;
    this.#origin.visible = this.#store.overlays.scene.origin && scene?.origin_visual !== false;
    this.#stage.invalidate();
  }

  #apply() {
    if (!this.#store.document) return;
    const {scene: settings, roads} = this.#store.document;
    const {scene} = this.#stage;
    scene.fog = fogOf(settings.fog);
    scene.background = scene.fog && !settings.sky ? scene.fog.color.clone()
      : colorOf(settings.background);
    scene.remove(this.#sky);
    if (settings.sky) {
      colorSky(this.#sky, settings.sky);
      scene.add(this.#sky);
    }
    for (const road of this.#roads) scene.remove(road);
    this.#roads = roads.filter(({points}) => points.length > 1).map((road) => {
      const mesh = new Mesh(ribbon(road),
        this.#materials.get(road.material ?? ASPHALT, {}, {doubleSided: true}));
      mesh.receiveShadow = true;
      scene.add(mesh);
      return mesh;
    });
    this.#flags();
  }
}
