/** Mesh files, each read once. Coordinates stay as the file has them, in metres; z is up. */
import {faultText} from '../ui/dialog.js';
import {frontsFirst} from './fronts_first.js';
import {
  BufferAttribute, BufferGeometry, Camera, DoubleSide, Light, LoadingManager, Mesh, MeshPhongMaterial,
  MeshStandardMaterial, SkinnedMesh,
} from 'three';
import {disposeOf, simplified, stlGeometry} from './simplified_mesh.js';
import {limitFor} from './coarse_mesh.js';
import {bodyOf} from './response_body.js';
import {readStl} from './stl.js';
import {StlReader} from './stl_reader.js';
import type {Color, Material, Object3D, Texture} from 'three';
import type {Geometry} from '../protocol.js';
import type {MeshPart} from './simplified_mesh.js';

/** A file that holds a mesh; `fallback`: the simulator's form of it, STL. */
export type MeshSource = {url: string, format?: string|null|undefined, fallback?: string|null|undefined};

const plainMaterial = new MeshPhongMaterial({color: 0xc8c8c8, specular: 0x0d0d0d,
  side: DoubleSide});
const paintedMaterial = new MeshPhongMaterial({vertexColors: true, specular: 0x0d0d0d,
  side: DoubleSide});

async function bytes(url: string, manager: LoadingManager) {
  return bodyOf(await answerOf(url, manager), () => {});
}

async function answerOf(url: string, manager: LoadingManager) {
  const response = await fetch(manager.resolveURL(url));
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return response;
}

const text = async (url: string, manager: LoadingManager) =>
    new TextDecoder().decode(await bytes(url, manager));
/** three turns a scene unless its file says that y is up. */
const UP_AXIS = /<up_axis>[^<]*<\/up_axis>/;
const SHADING = /<(lambert|phong|blinn|constant)>.*?<\/\1>/gs;
const CLIPS = /<library_animation_clips\b.*?<\/library_animation_clips>/gs;
/** An attribute value with `<`, which XML does not allow and TinyXML accepts. */
const ANGLE_IN_VALUE = /(?<==")[^"<\n]*<[^"\n]*(?=")/g;
const HOW_CLEAR = /<(transparent|transparency)>.*?<\/\1>/gs;

const PICTURE = /<texture\b[^>]*(?:\/>|>.*?<\/texture>)/s;

const element = (shading: string, kind: string) => new RegExp(`<${kind}>.*?</${kind}>`,
    's').exec(shading)?.[0];

/** A material has one picture: that of its diffuse colour, else one that it has for another. */
function withItsPicture(shading: string) {
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
 * picture; animations are played whole, whatever clips it names; names may contain `<`.
 */
export function asGazeboReads(content: string) {
  const upright = content.replace(UP_AXIS, '<up_axis>Y_UP</up_axis>').replace(CLIPS, '')
    .replace(ANGLE_IN_VALUE, (value) => value.replaceAll('<', '&lt;'));
  return upright.replace(SHADING, (shading) => withItsPicture(
    /<transparent\s[^>]*opaque\s*=/.test(shading) ? shading : shading.replace(HOW_CLEAR, '')));
}

/** An address as a person reads it; files may name pictures with a bare %. */
function readable(url: string) {
  try {
    return decodeURI(url);
  } catch {
    return url;
  }
}

const folder = (url: string) => url.slice(0, url.lastIndexOf('/') + 1);

async function readCollada(url: string, manager: LoadingManager) {
  const [{ColladaLoader}, content] = await Promise.all([
    import('three/addons/loaders/ColladaLoader.js'), text(url, manager)]);
  const loader = new ColladaLoader(manager);
  const read = loader.parse(asGazeboReads(content), folder(url));
  if (!read) throw new Error(`${url} is not COLLADA`);
  return read.scene;
}

/** The simulator's form of PLY files. */
async function readPly(url: string, manager: LoadingManager) {
  const [{PLYLoader}, content] = await Promise.all([
    import('three/addons/loaders/PLYLoader.js'), bytes(url, manager)]);
  const geometry = new PLYLoader().parse(content);
  return new Mesh(geometry, geometry.hasAttribute('color') ? paintedMaterial : plainMaterial);
}

async function readTerrain(url: string, manager: LoadingManager) {
  const [{sharedCorners}, content] = await Promise.all([import('./terrain_grid.js'), bytes(url, manager)]);
  const read = readStl(content, null);
  const found = read.facets && sharedCorners(read.facets.position);
  if (!found) return new Mesh(stlGeometry(read), plainMaterial);
  const {position, normal, uv, index} = found;
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(position, 3))
    .setAttribute('normal', new BufferAttribute(normal, 3))
    .setAttribute('uv', new BufferAttribute(uv, 2)).setIndex(new BufferAttribute(index, 1));
  return new Mesh(geometry, plainMaterial);
}

async function readObj(url: string, manager: LoadingManager) {
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

/** The materials of glTF reflect surroundings, which the view has none of. */
function plainly(material: Material) {
  if (!(material instanceof MeshStandardMaterial)) return material;
  const {name, color, map, opacity, transparent, alphaTest, vertexColors, emissive, emissiveMap,
    normalMap} = material;
  return new MeshPhongMaterial({name, color, map, opacity, transparent, alphaTest, vertexColors,
    emissive, emissiveMap, normalMap, specular: 0x0d0d0d});
}

async function readGltf(url: string, manager: LoadingManager) {
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

async function readBvh(url: string, manager: LoadingManager) {
  const [{sceneOf}, content] = await Promise.all([import('./bvh.js'), text(url, manager)]);
  return sceneOf(content);
}

const READERS: Record<string, (url: string, manager: LoadingManager) =>
    Promise<Object3D>> = {dae: readCollada, obj: readObj, glb: readGltf, gltf: readGltf,
  terrain: readTerrain, bvh: readBvh, ply: readPly};

function formatOf({format, url}: MeshSource) {
  return (format || (url.split('?')[0].split('.').pop() ?? '')).toLowerCase();
}

function namesOf(object: Mesh) {
  const names: string[] = [];
  let node: Object3D|null = object;
  for (; node; node = node.parent) if (node.name) names.push(node.name);
  if (object.geometry.name) names.push(object.geometry.name);
  return names;
}

/** The file of a geometry, null where it has none that the page can load. */
export function sourceOf(geometry: Geometry): MeshSource|null {
  if (!('url' in geometry) || !geometry.url) return null;
  const {url, format} = geometry;
  return {url, format, fallback: geometry.type === 'mesh' ? geometry.fallback : null};
}

/** The meshes of a file that hold anything, ready to be drawn. */
function meshesOf(root: Object3D) {
  const found: Mesh[] = [];
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

/** Old exporters write an opaque material as one of transparency 0, which would be nothing at all. */
function showUnseen(material: Material) {
  if (material.opacity > 0) return;
  material.opacity = 1;
  material.transparent = false;
}

/** A picture colours what glows, too (Ogre's fixed function): calibration boards glow white under theirs. */
function glowByMap(material: Material & {map?: Texture|null, emissive?: Color,
    emissiveMap?: Texture|null}) {
  if (material.emissive && material.map) material.emissiveMap ??= material.map;
}

const partsOf = (root: Object3D) => meshesOf(root).map((object) => ({geometry: object.geometry,
  material: object.material, matrix: object.matrixWorld.clone(), names: namesOf(object)}));

/** A file's scene without its lights and cameras. */
function figureOf(root: Object3D) {
  const left: Object3D[] = [];
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

export class Meshes {
  onProblem;
  /** Whether large meshes are simplified, for browsers without a graphics card. */
  #simplified = false;
  /** Reports pictures that arrive after their mesh. */
  manager = new LoadingManager();
  #busy = false;
  /** How many are there, of how many. */
  #textures = [0, 0];
  #meshes = [0, 0];
  /** Of large files: loaded, and all. */
  #bytes = [0, 0];
  #stl;
  #waiting: (() => void)[] = [];
  #files: Map<string, Promise<MeshPart[]>> = new Map();
  #ready: Map<string, MeshPart[]> = new Map();

  /**
   * @param onProblem  called once for each file that cannot be read
   * @param resolveUrl  returns where a file is loaded from
   */
  constructor(onProblem: (problem: string) => void, resolveUrl?: (url: string) => string) {
    this.onProblem = onProblem;
    this.#stl = new StlReader({alone: Boolean(resolveUrl)});
    if (resolveUrl) this.manager.setURLModifier(resolveUrl);
    const told: Set<string> = new Set();
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
  onCount = (_done: number, _of: number, _bytes: string) => {};

  #count() {
    const [loaded, size] = this.#bytes.map((count) => Math.round(count / 1e6));
    this.onCount(this.#meshes[0] + this.#textures[0], this.#meshes[1] + this.#textures[1],
      size ? `${loaded} of ${size} MB` : '');
  }

  /** Triangles of all meshes that are there. */
  get triangles() {
    return [...this.#ready.values()].flat().reduce((sum, {geometry}) =>
      sum + (geometry.index ?? geometry.getAttribute('position')).count / 3, 0);
  }

  /** Choose whether meshes read from now on are simplified, and forget those that are there. */
  simplify(simplified: boolean) {
    if (simplified === this.#simplified) return;
    this.#simplified = simplified;
    for (const part of [...this.#ready.values()].flat()) disposeOf(part);
    this.#ready.clear();
    this.#files.clear();
  }

  /** How many meshes and pictures are under way. */
  get waiting() {
    return this.#meshes[1] + this.#textures[1] - this.#meshes[0] - this.#textures[0];
  }

  /** Resolves when no picture is under way. */
  idle(): Promise<void> {
    return this.#busy ? new Promise((resolve) => { this.#waiting.push(resolve); }) : Promise.resolve();
  }

  /** The parts of a mesh that was read before, or undefined. */
  present(geometry: MeshSource): MeshPart[]|undefined {
    return this.#ready.get(geometry.url);
  }

  /** @returns empty for a file that cannot be read */
  load(geometry: MeshSource): Promise<MeshPart[]> {
    const {url} = geometry;
    const known = this.#files.get(url);
    if (!known) {
      this.#meshes[1] += 1;
      this.#count();
    }
    const parts = known ?? this.#readSomehow(geometry, partsOf)
      .then(({found, whole}) => {
        this.#meshes[0] += 1;
        if (this.#meshes[0] === this.#meshes[1]) this.#bytes = [0, 0];
        this.#count();
        const ready = (found ?? []).map((part) => (whole ? {...part, whole} : part))
          .map((part) => (this.#simplified ? simplified(part, this.#meshes[1]) : part));
        this.#ready.set(url, ready);
        return ready;
      });
    this.#files.set(url, parts);
    return parts;
  }

  /**
   * A mesh as a scene of its own, with bones and `animations`, for one that moves in itself. Each
   * call makes another one.
   * @returns null for a file that cannot be read
   */
  async figure(geometry: MeshSource): Promise<Object3D|null> {
    return (await this.#readSomehow(geometry, figureOf)).found;
  }

  /** @template T  What this page cannot read the simulator may have read: its form then, without colours. */
  async #readSomehow<T>(geometry: MeshSource, use: (root: Object3D) => T) {
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

  async #read(geometry: MeshSource) {
    if (formatOf(geometry) === 'stl') return this.#readStl(geometry.url);
    const reader = READERS[formatOf(geometry)];
    if (!reader) throw new Error(`unsupported format; supported: stl, ${Object.keys(READERS).join(', ')}`);
    await this.#withTga();
    return reader(geometry.url, this.manager);
  }

  async #readStl(url: string) {
    const content = await bodyOf(await answerOf(url, this.manager), (loaded, size) => {
      this.#bytes[0] += loaded;
      this.#bytes[1] += size;
      this.#count();
    });
    const files = this.#meshes[1];
    const limits = this.#simplified ? {rest: limitFor(files), moving: limitFor(files, {moving: true})} : null;
    return new Mesh(stlGeometry(await this.#stl.read(content, limits)), plainMaterial);
  }

  async #withTga() {
    if (this.manager.getHandler('a.tga')) return;
    const {TGALoader} = await import('three/addons/loaders/TGALoader.js');
    this.manager.addHandler(/\.tga$/i, new TGALoader(this.manager));
  }
}
