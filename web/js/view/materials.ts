/** three materials for the document's, one object for each appearance, so that they are shared. */
import {
  CanvasTexture, DoubleSide, FrontSide, MeshBasicMaterial, MeshLambertMaterial, MeshPhongMaterial,
  RepeatWrapping, SRGBColorSpace, TextureLoader, Vector3,
} from 'three';
import {colorOf} from './three_convert.js';
import {frontsFirst} from './fronts_first.js';
import {patternCanvas} from './builtin_textures.js';
import {DULLEST, GREY, GROUND, SHININESS} from '../palette.js';
import {terrainMaterial} from './terrain_material.js';
import type {Color, LoadingManager, Material, Texture} from 'three';

type MaterialDocument = import('../protocol.js').Material;
type Paint = Pick<MaterialDocument, 'texture'> & Partial<MaterialDocument>;
type TextureDocument = import('../protocol.js').Texture;
type TerrainLayer = import('../protocol.js').TerrainLayer;
type ThreeMaterial = Material;
/**
 * How a surface is drawn; `pushed`: it lies just behind others; `endless`: its rim goes over into
 * what is behind it.
 */
type MaterialUse = {doubleSided?: boolean, pushed?: boolean, endless?: boolean};

const DULL = [0, 0, 0, 1];

/** Faces of as many materials at one place are drawn without stripes. */
const DEPTHS = 4;
/** Steps of the depth buffer between them; all of them are less than those of `frontsFirst`. */
const DEPTH_STEPS = 2;

export interface Variant {
  /** times the material's own, 0..1 */
  opacity?: number;
  wireframe?: boolean;
  /** draw what is seen from the front only */
  frontOnly?: boolean;
}

export class Materials {
  #cache: Map<string, ThreeMaterial> = new Map();
  #textures: Map<string, Texture|null> = new Map();
  #manager;
  /** Of the last material, as a number of levels behind the nearest. */
  #depth = 0;
  /** Colour in which endless grounds end, as the screen shows it. */
  #distance = {value: new Vector3(0.7, 0.7, 0.7)};

  /** @param manager  reports that pictures have arrived */
  constructor(manager: LoadingManager) {
    this.#manager = manager;
  }

  /** Whether a document's material says anything that a mesh's own would not. */
  static speaks(material: Paint|null|undefined) {
    return Boolean(material && (material.diffuse || material.ambient || material.texture ||
      material.emissive));
  }

  /** @param material  of the document, or null for the default */
  get(material: Paint|null, variant: Variant = {}, surface: MaterialUse = {}) {
    const key = JSON.stringify([material, variant, surface]);
    let made = this.#cache.get(key);
    if (!made) this.#cache.set(key, made = this.#make(material, variant, surface));
    return made;
  }

  /** @param color  of what is behind an endless ground */
  setDistance(color: Color) {
    const {r, g, b} = color.clone().convertLinearToSRGB();
    this.#distance.value.set(r, g, b);
  }

  /** A mesh's own material in another appearance. */
  own(material: ThreeMaterial, variant: Variant) {
    const {opacity = 1, wireframe = false, frontOnly = false} = variant;
    if (opacity === 1 && !wireframe && !frontOnly) return material;
    const key = `${material.uuid} ${opacity} ${wireframe} ${frontOnly}`;
    let made = this.#cache.get(key);
    if (!made) {
      made = material.clone();
      if (frontOnly) made.side = FrontSide;
      else frontsFirst(made);
      Object.assign(made, {wireframe});
      made.opacity = material.opacity * opacity;
      made.transparent = made.opacity < 1 || material.transparent;
      made.depthWrite = !made.transparent;
      this.#cache.set(key, made);
    }
    return made;
  }

  #make(material: Paint|null, variant: Variant, surface: MaterialUse) {
    const made = this.#plain(material, variant, surface);
    if (surface.endless) this.#fadeRim(made);
    else if (surface.doubleSided) frontsFirst(made);
    if (!surface.pushed) this.#separate(made);
    return made;
  }

  /**
   * Gives the next material another depth, so that one of two faces at the same place is drawn, such
   * as those at the junction of two walls. Both would be drawn in stripes otherwise.
   */
  #separate(made: ThreeMaterial) {
    this.#depth = (this.#depth + 1) % DEPTHS;
    made.polygonOffset = true;
    made.polygonOffsetUnits = DEPTH_STEPS * this.#depth;
  }

  /** Lets a plane end in the colour of what is behind it, from half of the way to its rim on. */
  #fadeRim(material: ThreeMaterial) {
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

  #plain(material: Paint|null, {opacity = 1, wireframe = false}: Variant, {doubleSided = false,
      pushed = false}: MaterialUse) {
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
   * @param base  height of black, m
   */
  terrain(layers: TerrainLayer[], base: number, variant: Variant) {
    const key = JSON.stringify([layers, base, variant]);
    let made = this.#cache.get(key);
    if (!made) {
      const covered = layers.map((layer) => ({layer,
        map: this.#map({url: layer.url ?? null, pattern: layer.pattern ?? null, scale: [1, 1]}),
        bumps: layer.normal_url ? this.#normalMap(layer.normal_url) : null}));
      this.#cache.set(key, made = terrainMaterial(covered, base, variant));
    }
    return made;
  }

  #normalMap(url: string) {
    const key = `normals ${url}`;
    let map = this.#textures.get(key) ?? null;
    if (!map) {
      map = this.#loadFile(url);
      map.wrapS = map.wrapT = RepeatWrapping;
      this.#textures.set(key, map);
    }
    return map;
  }

  #map(texture: TextureDocument|null|undefined) {
    if (!texture || (!texture.url && !texture.pattern)) return null;
    const key = JSON.stringify(texture);
    if (!this.#textures.has(key)) this.#textures.set(key, this.#load(texture));
    return this.#textures.get(key) ?? null;
  }

  #load({url, pattern, scale = [1, 1]}: TextureDocument) {
    const map = url ? this.#loadFile(url) : drawn(pattern ?? '');
    if (!map) return null;
    map.colorSpace = SRGBColorSpace;
    map.wrapS = map.wrapT = RepeatWrapping;
    map.anisotropy = 4;
    // Ogre's `scale s` enlarges the picture: it repeats 1/s times.
    map.repeat.set(1 / (scale[0] || 1), 1 / (scale[1] || 1));
    return map;
  }

  #loadFile(url: string): Texture {
    const known = this.#manager.getHandler(url) as TextureLoader|null;
    return (known ?? new TextureLoader(this.#manager)).load(url);
  }
}

/** A built-in pattern as a texture; null for an unknown one. */
function drawn(pattern: string) {
  const canvas = patternCanvas(pattern);
  return canvas ? new CanvasTexture(canvas) : null;
}
