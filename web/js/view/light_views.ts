/** The world's lights, their icons in the view, and the ambient light. */
import {
  BufferAttribute, BufferGeometry, Color, DirectionalLight, Group, HemisphereLight, LineBasicMaterial,
  LineSegments, Mesh, MeshBasicMaterial, PointLight, Quaternion, SphereGeometry, SpotLight, Vector3,
} from 'three';
import {free} from './markers.js';
import {leavesAmbient} from './sky.js';
import {lightColorOf, place} from './three_convert.js';
import {withParts} from '../parts.js';
import type {Light} from '../protocol.js';
import type {Pose7} from '../pose.js';
import type {ViewParts} from './view.js';

type Lamp = DirectionalLight|PointLight|SpotLight;
/** A light of the world with its lamp and its icon in the view. */
type LightEntry = {light: Light, lamp: Lamp, icon: Group};

/** three's lamps are physical: three divides the light on a white wall by pi. */
const STRENGTH = Math.PI;
/** Daylight is bluish from above, warm from the ground; what a world sets is left as it is. */
const FROM_ABOVE = new Color(1.04, 1.09, 1.16);
const FROM_BELOW = new Color(1.0, 0.95, 0.88);
const SHADOW_SIZE = 2048;
/** Texels over which the edge of a shadow fades. */
const SOFT = 3.5;
/** More shadow maps than this, and simple machines stutter. */
const MOST_SHADOWS = 4;

const wireMaterial = new LineBasicMaterial({color: 0xf5c518});
const hitMaterial = new MeshBasicMaterial({visible: false});
const hitGeometry = new SphereGeometry(0.3, 8, 6);

function wires(points: number[][][]) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points.flat(2)), 3));
  geometry.userData.single = true;
  return new LineSegments(geometry, wireMaterial);
}

function circle(radius: number, z: number, count = 16) {
  const at = (index: number) => {
    const angle = (2 * Math.PI * index) / count;
    return [radius * Math.cos(angle), radius * Math.sin(angle), z];
  };
  return Array.from({length: count}, (_, index) => [at(index), at(index + 1)]);
}

const OCTAHEDRON = (() => {
  const r = 0.25;
  const ring = [[r, 0, 0], [0, r, 0], [-r, 0, 0], [0, -r, 0]];
  return ring.flatMap((corner, index) => [
    [corner, ring[(index + 1) % 4]], [corner, [0, 0, r]], [corner, [0, 0, -r]]]);
})();

/** The wires of a light that shines down its -z. */
function shapeOf({type, outer_angle: outer}: Light) {
  if (type === 'point') return OCTAHEDRON;
  if (type === 'spot') {
    const reach = 0.6;
    const radius = Math.min(reach * Math.tan(Math.min(outer || 1, 2.8) / 2), 1.2);
    const rim = circle(radius, -reach);
    return [...rim, ...rim.filter((_, index) => index % 4 === 0).map(([a]) => [[0, 0, 0], a])];
  }
  const square = [[-0.3, -0.3, 0], [0.3, -0.3, 0], [0.3, 0.3, 0], [-0.3, 0.3, 0]];
  return square.flatMap((corner, index) => [[corner, square[(index + 1) % 4]],
    [corner.map((part) => part / 2), [corner[0] / 2, corner[1] / 2, -0.6]]]);
}

/** The icon of a light: wires, and a ball that the mouse can hit. */
export function lightIcon(light: Light): Group {
  const group = new Group();
  const icon = wires(shapeOf(light));
  if (light.type !== 'point') {
    icon.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, -1),
      new Vector3().fromArray(light.direction).normalize()));
  }
  group.add(icon, new Mesh(hitGeometry, hitMaterial));
  place(group, light.pose);
  return group;
}

/**
 * three dims by a power of the distance only: the power and strength that come nearest to
 * 1 / (constant + linear d + quadratic d^2) about a third of the range away.
 */
function dimming({constant, linear, quadratic, range}: Light) {
  const near = Math.min(3, Math.max(range / 3, 0.1));
  const divisor = constant + linear * near + quadratic * near * near || 1;
  const decay = (linear * near + 2 * quadratic * near * near) / divisor;
  return {decay, strength: near ** decay / divisor};
}

function lampOf(light: Light) {
  const color = lightColorOf(light.diffuse);
  if (light.type === 'directional') return new DirectionalLight(color, STRENGTH);
  const {decay, strength} = dimming(light);
  if (light.type === 'point') {
    return new PointLight(color, STRENGTH * strength, light.range, decay);
  }
  const outer = Math.min(light.outer_angle || Math.PI, Math.PI * 0.98) / 2;
  const penumbra = outer > 0 ? 1 - Math.min(light.inner_angle / 2 / outer, 1) : 0;
  return new SpotLight(color, STRENGTH * strength, light.range, outer, penumbra, decay);
}

function prepareShadow(lamp: Lamp) {
  lamp.castShadow = true;
  const size = lamp instanceof PointLight ? SHADOW_SIZE / 4 : SHADOW_SIZE;
  lamp.shadow.mapSize.set(size, size);
  lamp.shadow.bias = lamp instanceof DirectionalLight ? -0.0004 : -0.002;
  lamp.shadow.normalBias = 0.02;
  lamp.shadow.radius = SOFT;
}

export class Lights extends withParts<Pick<ViewParts, 'stage'|'store'>>() {
  #ambient = new HemisphereLight(0xffffff, 0x8a8680, 1);
  #entries: Map<string, LightEntry> = new Map();
  #focus = {centre: new Vector3(1e9, 0, 0), reach: 0};

  constructor(parts: Pick<ViewParts, 'stage'|'store'>) {
    super(parts);
    const {stage, store} = parts;
    this.#ambient.position.set(0, 0, 1);
    stage.scene.add(this.#ambient);
    store.listen('document', () => this.#rebuild());
    store.listen('overlays', ({detail: {flag}}) => {
      if (flag === 'cameraColors') this.#rebuild();
      if (flag === 'hidden') this.#hideIcons();
    });
    store.listen('entity', ({detail: {kind, value}}) => {
      if (kind === 'light' || (kind === 'world' && value.scene)) this.#rebuild();
    });
  }

  /** Icons that are shown by light name, for picking. */
  get icons(): Map<string, Group> {
    return new Map([...this.#entries].filter(([, {icon}]) => icon.visible).map(([name, {icon}]) => [name, icon]));
  }

  /** A hidden light still shines. */
  #hideIcons() {
    for (const [name, {icon}] of this.#entries) icon.visible = !this.store.overlay('hidden', name);
    this.stage.invalidate();
  }

  /** Shows a light elsewhere while it is dragged. */
  move(name: string, pose: Pose7) {
    const entry = this.#entries.get(name);
    if (!entry) return;
    place(entry.icon, pose);
    this.#aim(entry, {...entry.light, pose});
    this.stage.shadowsChanged();
  }

  /**
   * Lets the shadows of far-away lights lie about what the camera looks at.
   * @param centre  world, m
   * @param reach  m round it that must be covered
   */
  cover(centre: number[], reach: number) {
    const wanted = new Vector3().fromArray(centre);
    const {centre: now, reach: width} = this.#focus;
    // Often is expensive, and shadows would swim: only when the old place no longer does.
    if (now.distanceTo(wanted) < width * 0.25 && reach < width * 1.2 && reach > width * 0.5) return;
    this.#focus = {centre: wanted, reach: Math.min(Math.max(reach, 2), 80)};
    for (const entry of this.#entries.values()) this.#aim(entry, entry.light);
    this.stage.shadowsChanged();
  }

  /** Lets the edges of shadows be soft, or as sharp as is quickest. */
  soften(soft: boolean) {
    for (const {lamp} of this.#entries.values()) {
      if (lamp.shadow) lamp.shadow.radius = soft || !this.stage.software ? SOFT : 0;
    }
  }

  #rebuild() {
    const {scene} = this.stage;
    for (const {lamp, icon} of this.#entries.values()) {
      scene.remove(lamp, icon);
      free(icon);
      if ('target' in lamp) scene.remove(lamp.target);
      lamp.dispose();
    }
    this.#entries.clear();
    if (!this.store.document) return;
    const {lights, scene: settings} = this.store.document;
    this.#ambient.color.copy(lightColorOf(settings.ambient));
    this.#ambient.groundColor.copy(this.#ambient.color).multiplyScalar(0.6);
    if (leavesAmbient(settings) && !this.store.overlays.scene.cameraColors) {
      this.#ambient.color.multiply(FROM_ABOVE);
      this.#ambient.groundColor.multiply(FROM_BELOW);
    }
    this.#ambient.intensity = STRENGTH;
    let shadows = 0;
    for (const light of lights) {
      const lamp = lampOf(light);
      if (settings.shadows && light.cast_shadows && shadows < MOST_SHADOWS) {
        prepareShadow(lamp);
        shadows++;
      }
      const entry = {light, lamp, icon: lightIcon(light)};
      this.#entries.set(light.name, entry);
      scene.add(lamp, entry.icon);
      if ('target' in lamp) scene.add(lamp.target);
      this.#aim(entry, light);
    }
    this.#hideIcons();
    this.stage.shadowsChanged();
  }

  #aim({lamp}: LightEntry, light: Light) {
    const at = new Vector3().fromArray(light.pose);
    const turn = new Quaternion().fromArray(light.pose, 3);
    const way = new Vector3().fromArray(light.direction).applyQuaternion(turn).normalize();
    if (!(lamp instanceof DirectionalLight)) {
      lamp.position.copy(at);
      if (lamp instanceof SpotLight) lamp.target.position.copy(at).add(way);
      return;
    }
    const {centre, reach} = this.#focus;
    const focus = reach ? centre : new Vector3();
    lamp.target.position.copy(focus);
    lamp.position.copy(focus).addScaledVector(way, -100);
    if (!lamp.castShadow) return;
    const half = reach || 20;
    Object.assign(lamp.shadow.camera, {left: -half, right: half, top: half, bottom: -half, near: 1,
      far: 250});
    lamp.shadow.camera.updateProjectionMatrix();
  }
}
