/** Mesh files, each read once. Coordinates stay as the file has them, in metres; z is up. */
import {faultText} from '../panels/dialog.js';
import {frontsFirst} from './fronts_first.js';
import {
  BufferAttribute, BufferGeometry, Camera, DoubleSide, Light, LoadingManager, Mesh, MeshPhongMaterial,
  MeshStandardMaterial, SkinnedMesh,
} from 'three';
import {coarse, limitFor} from './coarse_mesh.js';
import {fillNormals} from './facet_normals.js';
/** @import {Color, Material, Matrix4, Object3D, Texture} from 'three' */
/** @import {Geometry} from '../protocol.js' */

/** A file that holds a mesh; `fallback`: the simulator's form of it, STL.
 * @typedef {{url: string, format?: string|null, fallback?: string|null}} MeshSource */

/**
 * @typedef {object} MeshPart
 * @property {BufferGeometry} geometry
 * @property {Material|Material[]} material  the file's own: a three material or, for groups, a list
 * @property {Matrix4} matrix  file frame from part
 * @property {string[]} names  of the part and the nodes above it
 * @property {boolean} [whole] it is the mesh in one, its parts have no names
 */

const plainMaterial = new MeshPhongMaterial({color: 0xc8c8c8, specular: 0x0d0d0d,
  side: DoubleSide});
const paintedMaterial = new MeshPhongMaterial({vertexColors: true, specular: 0x0d0d0d,
  side: DoubleSide});

/** @param {string} url @param {LoadingManager} manager */
async function bytes(url, manager) {
  const response = await fetch(manager.resolveURL(url));
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return response.arrayBuffer();
}

/** @param {string} url @param {LoadingManager} manager */
const text = async (url, manager) => new TextDecoder().decode(await bytes(url, manager));
/** three turns a scene unless its file says that y is up. */
const UP_AXIS = /<up_axis>[^<]*<\/up_axis>/;
const SHADING = /<(lambert|phong|blinn|constant)>.*?<\/\1>/gs;
const CLIPS = /<library_animation_clips\b.*?<\/library_animation_clips>/gs;
const HOW_CLEAR = /<(transparent|transparency)>.*?<\/\1>/gs;

const PICTURE = /<texture\b[^>]*(?:\/>|>.*?<\/texture>)/s;

/** @param {string} shading @param {string} kind */
const element = (shading, kind) => new RegExp(`<${kind}>.*?</${kind}>`, 's').exec(shading)?.[0];

/**
 * A material has one picture: that of its diffuse colour, else one that it has for another.
 * @param {string} shading
 */
function withItsPicture(shading) {
  const kinds = shading.startsWith('<constant') ? []
    : shading.startsWith('<lambert') ? ['emission', 'ambient'] : ['specular', 'emission', 'ambient'];
  const diffuse = element(shading, 'diffuse');
  if (PICTURE.test(diffuse ?? '')) return shading;
  const [picture] = kinds.flatMap((kind) => PICTURE.exec(element(shading, kind) ?? '') ?? []);
  if (!picture) return shading;
  const colored = `${diffuse?.replace('</diffuse>', '') ?? '<diffuse>'}${picture}</diffuse>`;
  return shading.replace(picture, '').replace(diffuse ?? /$/, '').replace('>', () => `>${colored}`);
}

/**
 * COLLADA as Gazebo reads it, for three: coordinates are Z up whatever the file says (public issue
 * 1305); a material is clear only where the file says how that is meant (`opaque`), and has one
 * picture; animations are played whole, whatever clips it names.
 * @param {string} content
 */
export function asGazeboReads(content) {
  const upright = content.replace(UP_AXIS, '<up_axis>Y_UP</up_axis>').replace(CLIPS, '');
  return upright.replace(SHADING, (shading) => withItsPicture(
    /<transparent\s[^>]*opaque\s*=/.test(shading) ? shading : shading.replace(HOW_CLEAR, '')));
}

/** An address as a person reads it; files may name pictures with a bare %. @param {string} url */
function readable(url) {
  try {
    return decodeURI(url);
  } catch {
    return url;
  }
}

/** @param {string} url */
const folder = (url) => url.slice(0, url.lastIndexOf('/') + 1);

/** @param {string} url @param {LoadingManager} manager */
async function readCollada(url, manager) {
  const [{ColladaLoader}, content] = await Promise.all([
    import('three/addons/loaders/ColladaLoader.js'), text(url, manager)]);
  const loader = new ColladaLoader(manager);
  const read = loader.parse(asGazeboReads(content), folder(url));
  if (!read) throw new Error(`${url} is not COLLADA`);
  return read.scene;
}

/** @param {string} url @param {LoadingManager} manager */
async function readStl(url, manager) {
  const [{STLLoader}, content] = await Promise.all([
    import('three/addons/loaders/STLLoader.js'), bytes(url, manager)]);
  const geometry = new STLLoader().parse(content);
  fillNormals(geometry.attributes.position.array, geometry.attributes.normal.array);
  return new Mesh(geometry, plainMaterial);
}

/** The simulator's form of PLY files. @param {string} url @param {LoadingManager} manager */
async function readPly(url, manager) {
  const [{PLYLoader}, content] = await Promise.all([
    import('three/addons/loaders/PLYLoader.js'), bytes(url, manager)]);
  const geometry = new PLYLoader().parse(content);
  return new Mesh(geometry, geometry.hasAttribute('color') ? paintedMaterial : plainMaterial);
}

/** @param {string} url @param {LoadingManager} manager */
async function readTerrain(url, manager) {
  const [{sharedCorners}, read] = await Promise.all([import('./terrain_grid.js'), readStl(url, manager)]);
  const found = sharedCorners(/** @type {Float32Array} */ (read.geometry.attributes.position.array));
  if (!found) return read;
  const {position, normal, uv, index} = found;
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(position, 3))
    .setAttribute('normal', new BufferAttribute(normal, 3))
    .setAttribute('uv', new BufferAttribute(uv, 2)).setIndex(new BufferAttribute(index, 1));
  return new Mesh(geometry, plainMaterial);
}

/** @param {string} url @param {LoadingManager} manager */
async function readObj(url, manager) {
  const [{OBJLoader}, {MTLLoader}, content] = await Promise.all([
    import('three/addons/loaders/OBJLoader.js'), import('three/addons/loaders/MTLLoader.js'),
    text(url, manager)]);
  const loader = new OBJLoader(manager);
  const library = /^mtllib\s+(.+?)\s*$/m.exec(content)?.[1];
  if (library) {
    const address = new URL(encodeURI(library), new URL(url, location.href)).href;
    const materials = new MTLLoader(manager).parse(await text(address, manager), folder(address));
    materials.preload();
    loader.setMaterials(materials);
  }
  return loader.parse(content);
}

/**
 * The materials of glTF reflect surroundings, which the view has none of.
 * @param {Material} material
 */
function plainly(material) {
  if (!(material instanceof MeshStandardMaterial)) return material;
  const {name, color, map, opacity, transparent, alphaTest, vertexColors, emissive, emissiveMap,
    normalMap} = material;
  return new MeshPhongMaterial({name, color, map, opacity, transparent, alphaTest, vertexColors,
    emissive, emissiveMap, normalMap, specular: 0x0d0d0d});
}

/** @param {string} url @param {LoadingManager} manager */
async function readGltf(url, manager) {
  const [{GLTFLoader}, content] = await Promise.all([
    import('three/addons/loaders/GLTFLoader.js'), bytes(url, manager)]);
  const {scene} = await new GLTFLoader(manager).parseAsync(content, folder(url));
  scene.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    object.material = Array.isArray(object.material)
      ? object.material.map(plainly) : plainly(object.material);
  });
  return scene;
}

/** @param {string} url @param {LoadingManager} manager */
async function readBvh(url, manager) {
  const [{sceneOf}, content] = await Promise.all([import('./bvh.js'), text(url, manager)]);
  return sceneOf(content);
}

/** @type {Record<string, (url: string, manager: LoadingManager) => Promise<Object3D>>} */
const READERS = {dae: readCollada, stl: readStl, obj: readObj, glb: readGltf, gltf: readGltf,
  terrain: readTerrain, bvh: readBvh, ply: readPly};

/** @param {MeshSource} meshSource */
function formatOf({format, url}) {
  return (format || (url.split('?')[0].split('.').pop() ?? '')).toLowerCase();
}

/** @param {Mesh} object */
function namesOf(object) {
  /** @type {string[]} */
  const names = [];
  /** @type {Object3D|null} */
  let node = object;
  for (; node; node = node.parent) if (node.name) names.push(node.name);
  if (object.geometry.name) names.push(object.geometry.name);
  return names;
}

/**
 * The file of a geometry, null where it has none that the page can load.
 * @param {Geometry} geometry
 * @returns {MeshSource|null}
 */
export function sourceOf(geometry) {
  if (!('url' in geometry) || !geometry.url) return null;
  const {url, format} = geometry;
  return {url, format, fallback: geometry.type === 'mesh' ? geometry.fallback : null};
}

/** The meshes of a file that hold anything, ready to be drawn. @param {Object3D} root */
function meshesOf(root) {
  /** @type {Mesh[]} */
  const found = [];
  root.updateMatrixWorld(true);
  root.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    if (!object.geometry.getAttribute('position')) return;
    if (!object.geometry.getAttribute('normal')) object.geometry.computeVertexNormals();
    const materials = Array.isArray(object.material) ? object.material : [object.material];
    for (const material of materials) {
      material.side = DoubleSide;
      frontsFirst(material);
      if (material.map) material.map.anisotropy = 4;
      showUnseen(material);
      glowByMap(material);
    }
    found.push(object);
  });
  return found;
}

/**
 * Old exporters write an opaque material as one of transparency 0, which would be nothing at all.
 * @param {Material} material
 */
function showUnseen(material) {
  if (material.opacity > 0) return;
  material.opacity = 1;
  material.transparent = false;
}

/**
 * A picture colours what glows, too (Ogre's fixed function): calibration boards glow white under theirs.
 * @param {Material & {map?: Texture|null, emissive?: Color, emissiveMap?: Texture|null}} material
 */
function glowByMap(material) {
  if (material.emissive && material.map) material.emissiveMap ??= material.map;
}

/** @param {Object3D} root */
const partsOf = (root) => meshesOf(root).map((object) => ({geometry: object.geometry,
  material: object.material, matrix: object.matrixWorld.clone(), names: namesOf(object)}));

/** A file's scene without its lights and cameras. @param {Object3D} root */
function figureOf(root) {
  /** @type {Object3D[]} */
  const left = [];
  root.traverse((object) => {
    if (object instanceof Light || object instanceof Camera) left.push(object);
  });
  for (const object of left) object.removeFromParent();
  for (const mesh of meshesOf(root)) {
    mesh.castShadow = mesh.receiveShadow = true;
    // Its bounds are those of the rest pose, its bones may carry it elsewhere.
    mesh.frustumCulled = !(mesh instanceof SkinnedMesh);
  }
  return root;
}

/**
 * A part with fewer triangles; the same one where it is small, or has textures, colours, several
 * materials or bones.
 * @param {MeshPart} part
 * @param {number} limit
 * @returns {MeshPart}
 */
function coarser(part, limit) {
  const {attributes, groups, index} = part.geometry;
  const plain = !groups.length && Object.keys(attributes).every((name) => name === 'position' || name === 'normal');
  const {position, normal} = attributes;
  if (!plain || !(position instanceof BufferAttribute) || !(normal instanceof BufferAttribute)) return part;
  const found = coarse(position.array, normal.array, index?.array ?? null, limit);
  if (!found) return part;
  part.geometry.dispose();
  return {...part, geometry: new BufferGeometry().setAttribute('position', new BufferAttribute(found.position, 3))
    .setAttribute('normal', new BufferAttribute(found.normal, 3))};
}

export class Meshes {
  /** Whether large meshes are simplified, for browsers without a graphics card. */
  simplified = false;
  /** Reports pictures that arrive after their mesh. */
  manager = new LoadingManager();
  #busy = false;
  /** How many are there, of how many. */
  #textures = [0, 0];
  #meshes = [0, 0];
  /** @type {(() => void)[]} */
  #waiting = [];
  /** @type {Map<string, Promise<MeshPart[]>>} */
  #files = new Map();
  /** @type {Map<string, MeshPart[]>} */
  #ready = new Map();

  /**
   * @param {(problem: string) => void} onProblem  called once for each file that cannot be read
   * @param {(url: string) => string} [resolveUrl]  returns where a file is loaded from
   */
  constructor(onProblem, resolveUrl) {
    this.onProblem = onProblem;
    if (resolveUrl) this.manager.setURLModifier(resolveUrl);
    /** @type {Set<string>} */
    const told = new Set();
    this.manager.onStart = () => { this.#busy = true; };
    this.manager.onProgress = (_url, loaded, total) => {
      this.#textures = [loaded, total];
      this.#count();
    };
    this.manager.onLoad = () => {
      this.#busy = false;
      for (const resolve of this.#waiting.splice(0)) resolve();
      this.onArrived();
    };
    this.manager.onError = (url) => {
      if (told.has(url)) return;
      told.add(url);
      onProblem(`Failed to load texture ${readable(url)}`);
    };
  }

  /** Called when pictures have come. */
  onArrived = () => {};

  /** Called with how many meshes and pictures there are, of how many. */
  onCount = (/** @type {number} */ _done, /** @type {number} */ _of) => {};

  #count() {
    this.onCount(this.#meshes[0] + this.#textures[0], this.#meshes[1] + this.#textures[1]);
  }

  /** Triangles of all meshes that are there. */
  get triangles() {
    return [...this.#ready.values()].flat().reduce((sum, {geometry}) =>
      sum + (geometry.index ?? geometry.getAttribute('position')).count / 3, 0);
  }

  /** How many meshes and pictures are under way. */
  get waiting() {
    return this.#meshes[1] + this.#textures[1] - this.#meshes[0] - this.#textures[0];
  }

  /** Resolves when no picture is under way. @returns {Promise<void>} */
  idle() {
    return this.#busy ? new Promise((resolve) => { this.#waiting.push(resolve); }) : Promise.resolve();
  }

  /**
   * The parts of a mesh that was read before, or undefined.
   * @param {MeshSource} geometry
   * @returns {MeshPart[]|undefined}
   */
  present(geometry) {
    return this.#ready.get(geometry.url);
  }

  /**
   * @param {MeshSource} geometry
   * @returns {Promise<MeshPart[]>} empty for a file that cannot be read
   */
  load(geometry) {
    const {url} = geometry;
    const known = this.#files.get(url);
    if (!known) {
      this.#meshes[1] += 1;
      this.#count();
    }
    const parts = known ?? this.#readSomehow(geometry, partsOf)
      .then(({found, whole}) => {
        this.#meshes[0] += 1;
        this.#count();
        const limit = limitFor(this.#meshes[1]);
        const ready = (found ?? []).map((part) => (whole ? {...part, whole} : part))
          .map((part) => (this.simplified ? coarser(part, limit) : part));
        this.#ready.set(url, ready);
        return ready;
      });
    this.#files.set(url, parts);
    return parts;
  }

  /**
   * A mesh as a scene of its own, with bones and `animations`, for one that moves in itself. Each
   * call makes another one.
   * @param {MeshSource} geometry
   * @returns {Promise<Object3D|null>} null for a file that cannot be read
   */
  async figure(geometry) {
    return (await this.#readSomehow(geometry, figureOf)).found;
  }

  /**
   * @template T
   * What this page cannot read the simulator may have read: its form then, without colours.
   * @param {MeshSource} geometry
   * @param {(root: Object3D) => T} use
   */
  async #readSomehow(geometry, use) {
    try {
      return {found: use(await this.#read(geometry)), whole: false};
    } catch (error) {
      if (geometry.fallback) {
        const root = await this.#read({url: geometry.fallback, format: 'stl'}).catch(() => null);
        if (root) return {found: use(root), whole: true};
      }
      this.onProblem(`Failed to load mesh ${readable(geometry.url)}: ${faultText(error)}`);
      return {found: null, whole: false};
    }
  }

  /** @param {MeshSource} geometry */
  async #read(geometry) {
    const reader = READERS[formatOf(geometry)];
    if (!reader) throw new Error(`unsupported format; supported: ${Object.keys(READERS).join(', ')}`);
    if (formatOf(geometry) !== 'stl') await this.#withTga();
    return reader(geometry.url, this.manager);
  }

  async #withTga() {
    if (this.manager.getHandler('a.tga')) return;
    const {TGALoader} = await import('three/addons/loaders/TGALoader.js');
    this.manager.addHandler(/\.tga$/i, new TGALoader(this.manager));
  }
}
