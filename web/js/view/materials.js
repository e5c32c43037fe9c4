/** three materials for the document's, one object for each appearance, so that they are shared. */
import {
  CanvasTexture, DoubleSide, FrontSide, MeshBasicMaterial, MeshLambertMaterial, MeshPhongMaterial,
  RepeatWrapping, SRGBColorSpace, TextureLoader,
} from 'three';
import {colorOf} from './three_convert.js';
import {patternCanvas} from './builtin_textures.js';

/** Grey of what has no material (Gazebo/Grey and Gazebo/White for meshes look alike with light). */
const GREY = [0.7, 0.7, 0.7, 1];
const GROUND = 0.8;
const DULL = [0, 0, 0, 1];
/** Highlights weaker than this are not worth their computing. */
const DULLEST = 0.02;

/**
 * @typedef {object} Variant
 * @property {number} [opacity]     times the material's own, 0..1
 * @property {boolean} [wireframe]
 */

export class Materials {
  #cache = new Map();
  #textures = new Map();
  #manager;

  /** @param {import('three').LoadingManager} manager  tells when pictures have arrived */
  constructor(manager) {
    this.#manager = manager;
  }

  /** Whether a document's material says anything that a mesh's own would not. */
  static speaks(material) {
    return Boolean(material && (material.diffuse || material.ambient || material.texture ||
      material.emissive));
  }

  /**
   * @param {any} material  of the document, or null for the default
   * @param {Variant} [variant]
   * @param {{doubleSided?: boolean, pushed?: boolean}} [surface]  pushed: lies just behind others
   */
  get(material, variant = {}, surface = {}) {
    const key = JSON.stringify([material, variant, surface]);
    let made = this.#cache.get(key);
    if (!made) this.#cache.set(key, made = this.#make(material, variant, surface));
    return made;
  }

  /** A mesh's own material in another appearance. */
  own(material, variant) {
    const {opacity = 1, wireframe = false} = variant;
    if (opacity === 1 && !wireframe) return material;
    const key = `${material.uuid} ${opacity} ${wireframe}`;
    let made = this.#cache.get(key);
    if (!made) {
      made = material.clone();
      made.wireframe = wireframe;
      made.opacity = material.opacity * opacity;
      made.transparent = made.opacity < 1 || material.transparent;
      made.depthWrite = !made.transparent;
      this.#cache.set(key, made);
    }
    return made;
  }

  #make(material, {opacity = 1, wireframe = false}, {doubleSided = false, pushed = false}) {
    const diffuse = material?.diffuse ?? material?.ambient ??
      (material?.texture ? [1, 1, 1, 1] : GREY);
    const seen = (diffuse[3] ?? 1) * (1 - (material?.transparency ?? 0)) * opacity;
    const common = {
      // A ground of one grey with what stands on it would swallow its outlines.
      color: colorOf(diffuse).multiplyScalar(pushed ? GROUND : 1),
      opacity: seen, transparent: seen < 1, depthWrite: seen >= 1, wireframe,
      side: doubleSided ? DoubleSide : FrontSide, map: this.#map(material?.texture),
      polygonOffset: pushed, polygonOffsetFactor: 2, polygonOffsetUnits: 2,
    };
    if (material?.lighting === false) return new MeshBasicMaterial(common);
    const emissive = colorOf(material?.emissive, [0, 0, 0]);
    const specular = material?.specular ?? DULL;
    if (Math.max(...specular.slice(0, 3)) <= DULLEST) {
      return new MeshLambertMaterial({...common, emissive});
    }
    return new MeshPhongMaterial({...common, shininess: 30, specular: colorOf(specular), emissive});
  }

  #map(texture) {
    if (!texture || (!texture.url && !texture.pattern)) return null;
    const key = JSON.stringify(texture);
    if (!this.#textures.has(key)) this.#textures.set(key, this.#load(texture));
    return this.#textures.get(key);
  }

  #load({url, pattern, scale = [1, 1]}) {
    let map;
    if (url) {
      const loader = this.#manager.getHandler(url) ?? new TextureLoader(this.#manager);
      map = loader.load(url);
    } else {
      const canvas = patternCanvas(pattern);
      if (!canvas) return null;
      map = new CanvasTexture(canvas);
    }
    map.colorSpace = SRGBColorSpace;
    map.wrapS = map.wrapT = RepeatWrapping;
    map.anisotropy = 4;
    // Ogre's `scale s` enlarges the picture: it repeats 1/s times.
    map.repeat.set(1 / (scale[0] || 1), 1 / (scale[1] || 1));
    return map;
  }
}
