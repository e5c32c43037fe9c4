/**
 * Background, sky, fog, grid, origin, contact shadows and roads: what the world and the view's flags
 * say, and the view's own gradient and haze where the world says nothing.
 */
import {BufferAttribute, BufferGeometry, Fog, FogExp2, Mesh} from 'three';
import {originScale} from '../camera_math.js';
import {ContactShadows} from './contact_shadows.js';
import {GroundGrid, makeOrigin} from './ground_grid.js';
import {groundHeight} from './ground.js';
import {free} from './markers.js';
import {roadStrip} from './road_strip.js';
import {colorOf} from './three_convert.js';
import {Gradient, WorldSky, leavesBackground} from './sky.js';
import {withParts} from '../parts.js';
import type {Materials} from './materials.js';
import type {Road} from '../protocol.js';
import type {Stage} from './stage.js';
import type {Store} from '../store.js';

/**
 * Converts Gazebo's fog to three's. A negative density marks fog whose exponent is linear in the
 * distance, see `gazeboFog`. The SDF types constant and quadratic are not supported by Gazebo.
 */
function fogOf(fog: import('../protocol.js').Fog|null|undefined) {
  if (!fog || fog.type === 'none') return null;
  const color = colorOf(fog.color);
  if (fog.type === 'linear') return new Fog(color, fog.start, fog.end);
  if (fog.type === 'exp') return new FogExp2(color, -Math.max(fog.density, 0));
  if (fog.type === 'exp2') return new FogExp2(color, Math.max(fog.density, 0));
  return new FogExp2(color, fog.density * (fog.type === 'quadratic' ? 0.5 : 1) / 10);
}

function ribbon(road: Road) {
  const {corners, uvs, triangles} = roadStrip(road);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(corners), 3));
  geometry.setAttribute('uv', new BufferAttribute(new Float32Array(uvs), 2));
  geometry.setIndex(triangles);
  geometry.computeVertexNormals();
  geometry.userData.single = true;
  return geometry;
}

const ASPHALT = {texture: {pattern: 'road', scale: [1, 1]}};

/** Where the view's own haze begins and ends, in distances of the eye from what it looks at. */
const HAZE = {from: 5, to: 22, nearest: 45};

export class Surroundings extends withParts<{stage: Stage, store: Store, materials: Materials}>() {
  #grid = new GroundGrid();
  #origin = makeOrigin();
  #sky = new WorldSky();
  #gradient = new Gradient();
  #contact = new ContactShadows();
  #haze: Fog|null = null;
  #roads: Mesh[] = [];
  /** What they were laid for. */
  #laid: Road[] = [];

  constructor(parts: {stage: Stage, store: Store, materials: Materials}) {
    super(parts);
    const {stage, store} = parts;
    stage.scene.add(this.#grid.mesh, this.#origin, this.#contact.mesh);
    stage.onShadows = (renderer, scene) => this.#contact.render(renderer, scene);
    store.listen('document', () => this.#apply());
    store.listen('overlays', ({detail: {flag}}) => (flag === 'cameraColors' ? this.#apply() : this.#flags()));
    store.listen('entity', ({detail}) => {
      if (detail.kind === 'world') this.#apply();
      else if (detail.kind === 'model') this.#contact.stand(this.#ground());
    });
  }

  /**
   * Follows the camera.
   * @param centre  of what is looked at, world, m
   * @param distance  of the eye from it, m
   */
  cover(centre: number[], distance: number) {
    this.#grid.cover(centre, distance);
    this.#contact.cover(centre, distance);
    this.#origin.scale.setScalar(originScale(distance));
    this.#origin.updateMatrixWorld();
    if (!this.#haze) return;
    this.#haze.near = Math.max(distance * HAZE.from, HAZE.nearest);
    this.#haze.far = this.#haze.near * HAZE.to / HAZE.from;
  }

  #flags() {
    const {scene} = this.store.document ?? {};
    this.#grid.mesh.visible = this.store.overlays.scene.grid && scene?.grid !== false;
    this.#origin.visible = this.store.overlays.scene.origin && scene?.origin_visual !== false;
    this.stage.invalidate();
  }

  /** Contact shadows belong to a world with shadows. */
  #ground() {
    const {document} = this.store;
    return document?.scene.shadows ? groundHeight(document.models) : null;
  }

  #apply() {
    if (!this.store.document) return;
    const {scene: settings} = this.store.document;
    const {scene} = this.stage;
    scene.remove(this.#sky.dome, this.#gradient.dome);
    scene.fog = fogOf(settings.fog);
    scene.background = scene.fog && !settings.sky ? scene.fog.color.clone()
      : colorOf(settings.background);
    this.#haze = null;
    let distant = scene.background;
    if (settings.sky) {
      this.#sky.take(settings.sky);
      scene.add(this.#sky.dome);
      distant = this.#sky.horizon;
    } else if (leavesBackground(settings) && !this.store.overlays.scene.cameraColors) {
      scene.add(this.#gradient.dome);
      distant = this.#gradient.horizon;
      scene.fog = this.#haze = new Fog(distant, HAZE.nearest, 4 * HAZE.nearest);
    }
    this.materials.setDistance(distant);
    this.#contact.stand(this.#ground());
    this.#layRoads();
    this.#flags();
  }

  #layRoads() {
    const {scene} = this.stage;
    const roads = this.store.document?.roads ?? [];
    if (roads === this.#laid) return;
    this.#laid = roads;
    scene.remove(...this.#roads);
    this.#roads.forEach(free);
    this.#roads = roads.filter(({points}) => points.length > 1).map((road) => {
      const mesh = new Mesh(ribbon(road),
        this.materials.get(road.material ?? ASPHALT, {}, {doubleSided: true}));
      mesh.receiveShadow = true;
      scene.add(mesh);
      return mesh;
    });
  }
}
