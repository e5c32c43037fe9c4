/** three materials for the document's, one object for each appearance, so that they are shared. */
import {
  CanvasTexture, DoubleSide, FrontSide, MeshBasicMaterial, MeshLambertMaterial, MeshPhongMaterial,
  RepeatWrapping, SRGBColorSpace, TextureLoader, Vector3,
} from 'three';
import {colorOf} from './three_convert.js';
import {frontsFirst} from './fronts_first.js';
import {patternCanvas} from './builtin_textures.js';
import {DULLEST, GREY, GROUND, SHININESS} from './palette.js';
import {terrainMaterial} from './terrain_material.js';
/** @import {LoadingManager, Texture} from 'three' */

/** @typedef {import('../protocol.js').Material} MaterialDocument */
/** @typedef {Pick<MaterialDocument, 'texture'> & Partial<MaterialDocument>} Paint */
/** @typedef {import('../protocol.js').Texture} TextureDocument */
/** @typedef {import('../protocol.js').TerrainLayer} TerrainLayer */
/** @typedef {import('three').Material} ThreeMaterial */
/**
 * How a surface is drawn; `pushed`: it lies just behind others; `endless`: its rim goes over into
 * what is behind it.
 * @typedef {{doubleSided?: boolean, pushed?: boolean, endless?: boolean}} MaterialUse
 */

const DULL = [0, 0, 0, 1];

/**
 * @typedef {object} Variant
 * @property {number} [opacity]     times the material's own, 0..1
 * @property {boolean} [wireframe]
 */

export class Materials {
  /** @type {Map<string, ThreeMaterial>} */
  #cache = new Map();
  /** @type {Map<string, Texture|null>} */
  #textures = new Map();
  #manager;
  /** Colour in which endless grounds end, as the screen shows it. */
  #distance = {value: new Vector3(0.7, 0.7, 0.7)};

  /** @param {LoadingManager} manager  reports that pictures have arrived */
  constructor(manager) {
    this.#manager = manager;
  }

  /**
   * Whether a document's material says anything that a mesh's own would not.
   * @param {Paint|null|undefined} material
   */
  static speaks(material) {
    return Boolean(material && (material.diffuse || material.ambient || material.texture ||
      material.emissive));
  }

  /**
   * @param {Paint|null} material  of the document, or null for the default
   * @param {Variant} [variant]
   * @param {MaterialUse} [surface]
   */
  get(material, variant = {}, surface = {}) {
    const key = JSON.stringify([material, variant, surface]);
    let made = this.#cache.get(key);
    if (!made) this.#cache.set(key, made = this.#make(material, variant, surface));
    return made;
  }

  /** @param {import('three').Color} color  of what is behind an endless ground */
  setDistance(color) {
    const {r, g, b} = color.clone().convertLinearToSRGB();
    this.#distance.value.set(r, g, b);
  }

  /**
   * A mesh's own material in another appearance.
   * @param {ThreeMaterial} material
   * @param {Variant} variant
   */
  own(material, variant) {
    const {opacity = 1, wireframe = false} = variant;
    if (opacity === 1 && !wireframe) return material;
    const key = `${material.uuid} ${opacity} ${wireframe}`;
    let made = this.#cache.get(key);
    if (!made) {
      made = frontsFirst(material.clone());
      Object.assign(made, {wireframe});
      made.opacity = material.opacity * opacity;
      made.transparent = made.opacity < 1 || material.transparent;
      made.depthWrite = !made.transparent;
      this.#cache.set(key, made);
    }
    return made;
  }

  /**
   * @param {Paint|null} material
   * @param {Variant} variant
   * @param {MaterialUse} surface
   */
  #make(material, variant, surface) {
    const made = this.#plain(material, variant, surface);
    if (surface.endless) this.#fadeRim(made);
    else if (surface.doubleSided) frontsFirst(made);
    return made;
  }

  /**
   * Lets a plane end in the colour of what is behind it, from half of the way to its rim on.
   * @param {ThreeMaterial} material
   */
  #fadeRim(material) {
    material.onBeforeCompile = (shader) => {
      shader.uniforms.distance_color = this.#distance;
      shader.vertexShader = `varying vec2 out_of_middle;\n${shader.vertexShader}`.replace(
        '#include <begin_vertex>', `#include <begin_vertex>
          out_of_middle = position.xy * 2.0;`);
      shader.fragmentShader = `uniform vec3 distance_color;
        varying vec2 out_of_middle;
        ${shader.fragmentShader}`.replace('#include <fog_fragment>', `#include <fog_fragment>
          gl_FragColor.rgb = mix(gl_FragColor.rgb, distance_color,
            smoothstep(0.3, 0.97, length(out_of_middle)));`);
    };
    material.customProgramCacheKey = () => 'endless';
  }

  /**
   * @param {Paint|null} material
   * @param {Variant} variant
   * @param {MaterialUse} surface
   */
  #plain(material, {opacity = 1, wireframe = false}, {doubleSided = false, pushed = false}) {
    const diffuse = material?.diffuse ?? material?.ambient ??
      (material?.texture ? [1, 1, 1, 1] : GREY);
    // The simulator includes alpha in the transparency; other materials have alpha only.
    const seen = (1 - (material?.transparency ?? 1 - (diffuse[3] ?? 1))) * opacity;
    const common = {
      color: colorOf(diffuse).multiplyScalar(pushed ? GROUND : 1),
      opacity: seen, transparent: seen < 1 || Boolean(material?.blended), depthWrite: seen >= 1,
      wireframe, alphaTest: material?.alpha_test ?? 0,
      side: doubleSided ? DoubleSide : FrontSide, map: this.#map(material?.texture),
      polygonOffset: pushed, polygonOffsetFactor: 2, polygonOffsetUnits: 2,
    };
    if (material?.lighting === false) return new MeshBasicMaterial(common);
    const emissive = colorOf(material?.emissive, [0, 0, 0]);
    // A picture colours what glows, too, as in Ogre.
    const glow = {emissive, emissiveMap: emissive.r + emissive.g + emissive.b > 0 ? common.map : null};
    const specular = material?.specular ?? DULL;
    if (Math.max(...specular.slice(0, 3)) <= DULLEST) {
      return new MeshLambertMaterial({...common, ...glow});
    }
    return new MeshPhongMaterial({...common, ...glow, shininess: SHININESS, specular: colorOf(specular)});
  }

  /**
   * The material of a terrain with textures.
   * @param {TerrainLayer[]} layers
   * @param {number} base  height of black, m
   * @param {Variant} variant
   */
  terrain(layers, base, variant) {
    const key = JSON.stringify([layers, base, variant]);
    let made = this.#cache.get(key);
    if (!made) {
      const covered = layers.map((layer) => ({layer,
        map: this.#map({url: layer.url, pattern: layer.pattern, scale: [1, 1]}),
        bumps: layer.normal_url ? this.#normalMap(layer.normal_url) : null}));
      this.#cache.set(key, made = terrainMaterial(covered, base, variant));
    }
    return made;
  }

  /** @param {string} url */
  #normalMap(url) {
    const key = `normals ${url}`;
    let map = this.#textures.get(key) ?? null;
    if (!map) {
      map = this.#loadFile(url);
      map.wrapS = map.wrapT = RepeatWrapping;
      this.#textures.set(key, map);
    }
    return map;
  }

  /** @param {TextureDocument|null|undefined} texture */
  #map(texture) {
    if (!texture || (!texture.url && !texture.pattern)) return null;
    const key = JSON.stringify(texture);
    if (!this.#textures.has(key)) this.#textures.set(key, this.#load(texture));
    return this.#textures.get(key) ?? null;
  }

  /** @param {TextureDocument} textureDocument */
  #load({url, pattern, scale = [1, 1]}) {
    const map = url ? this.#loadFile(url) : drawn(pattern ?? '');
    if (!map) return null;
    map.colorSpace = SRGBColorSpace;
    map.wrapS = map.wrapT = RepeatWrapping;
    map.anisotropy = 4;
    // Ogre's `scale s` enlarges the picture: it repeats 1/s times.
    map.repeat.set(1 / (scale[0] || 1), 1 / (scale[1] || 1));
    return map;
  }

  /** @param {string} url @returns {Texture} */
  #loadFile(url) {
    const known = /** @type {TextureLoader|null} */ (this.#manager.getHandler(url));
    return (known ?? new TextureLoader(this.#manager)).load(url);
  }
}

/** A built-in pattern as a texture; null for an unknown one. @param {string} pattern */
function drawn(pattern) {
  const canvas = patternCanvas(pattern);
  return canvas ? new CanvasTexture(canvas) : null;
}
