/**
 * Stands for three where a test looks at what is in the scene, where, and what was freed: trees,
 * positions and `dispose` are real; of the rest nothing is computed.
 */

/** An object any other property of which is a function that returns the object. */
const lenient = (made) => new Proxy(made, {
  get: (target, name, proxy) => {
    if (name in target || typeof name === 'symbol') return Reflect.get(target, name, proxy);
    return () => proxy;
  },
});

class Thing {
  disposed = 0;
  userData = {};
  constructor() { return lenient(this); }
  dispose() { this.disposed += 1; }
}

class Vector extends Thing {
  x = 0; y = 0; z = 0;
  set(x, y, z) { return Object.assign(this, {x, y, z}); }
  copy({x, y, z}) { return this.set(x, y, z); }
  fromArray([x, y, z]) { return this.set(x, y, z); }
  toArray() { return [this.x, this.y, this.z]; }
}

class Place extends Thing {
  children = [];
  geometry = undefined;
  position = new Vector();
  rotation = new Vector();
  scale = new Vector();
  quaternion = new Vector();
  matrix = new Thing();
  layers = new Thing();
  visible = true;
  add(...children) {
    this.children.push(...children);
    return this;
  }
  remove(...gone) {
    this.children = this.children.filter((child) => !gone.includes(child));
    return this;
  }
  clear() {
    this.children = [];
    return this;
  }
  traverse(visit) {
    visit(this);
    for (const child of this.children) child.traverse(visit);
  }
}

class Shown extends Place {
  constructor(geometry, material) {
    super();
    Object.assign(this, {geometry, material});
  }
}

class Lamp extends Place {
  color = new Thing();
  groundColor = new Thing();
  target = new Place();
  shadow = {mapSize: new Vector(), camera: new Thing()};
}

class Geometry extends Thing {
  attributes = {};
  setAttribute(name, attribute) {
    this.attributes[name] = attribute;
    return this;
  }
}

class Attribute extends Thing {
  constructor(array) {
    super();
    Object.assign(this, {array});
  }
}

class Looks extends Thing {
  constructor(options) {
    super();
    Object.assign(this, options);
  }
}

export class Scene extends Place {}
export class Group extends Place {}
export class Mesh extends Shown {}
export class InstancedMesh extends Mesh {
  colors = [];
  constructor(geometry, material, count) {
    super(geometry, material);
    this.count = count;
  }
  setColorAt(index, color) { this.colors[index] = color; }
}
export class Line extends Shown {}
export class LineSegments extends Line {}
export class Points extends Shown {}
export class Sprite extends Shown {
  center = new Vector();
  constructor(material) {
    super(null, material);
    Object.assign(this, {material});
  }
}
export class HemisphereLight extends Lamp {}
export class DirectionalLight extends Lamp {}
export class PointLight extends Lamp {}
export class SpotLight extends Lamp {}
export class Vector3 extends Vector {
  constructor(x = 0, y = 0, z = 0) {
    super();
    Object.assign(this, {x, y, z});
  }
}
export class FogExp2 extends Thing {
  constructor(color, density) {
    super();
    Object.assign(this, {color, density});
  }
}
export class Fog extends Thing {
  constructor(color, near, far) {
    super();
    Object.assign(this, {color, near, far});
  }
}
export class Color extends Thing {
  setRGB(r, g, b) { return Object.assign(this, {r, g, b}); }
}
export {
  Attribute as BufferAttribute, Geometry as BoxGeometry, Geometry as BufferGeometry,
  Geometry as CapsuleGeometry, Geometry as ConeGeometry,
  Geometry as CylinderGeometry, Geometry as EdgesGeometry,
  Geometry as ExtrudeGeometry, Geometry as LatheGeometry,
  Geometry as PlaneGeometry, Geometry as SphereGeometry,
  Geometry as TorusGeometry, Looks as LineBasicMaterial, Looks as Material,
  Looks as MeshBasicMaterial, Looks as MeshLambertMaterial, Looks as MeshPhongMaterial,
  Looks as MeshStandardMaterial, Looks as PointsMaterial, Looks as ShaderMaterial,
  Looks as SpriteMaterial, Place as Bone, Place as Camera, Place as Light, Place as Object3D,
  Place as OrthographicCamera, Place as PerspectiveCamera, Shown as SkinnedMesh,
  Thing as AnimationClip, Thing as AnimationMixer, Thing as Box3, Thing as CanvasTexture,
  Thing as DataTexture,
  Thing as LoadingManager, Thing as Matrix4,
  Thing as Path, Thing as Quaternion, Thing as QuaternionKeyframeTrack, Thing as Shape, Thing as Raycaster, Thing as Sphere, Thing as Texture,
  Thing as TextureLoader, Thing as Vector2,
  Thing as VectorKeyframeTrack, Thing as WebGLRenderTarget, Thing as WebGLRenderer,
};
export const ShaderChunk = {};
export const CustomToneMapping = 5;
export const DoubleSide = 2;
export const DynamicDrawUsage = 35048;
export const FrontSide = 0;
export const LinearFilter = 1006;
export const LinearSRGBColorSpace = 'srgb-linear';
export const NearestFilter = 1003;
export const PCFShadowMap = 1;
export const RGBAFormat = 1023;
export const RepeatWrapping = 1000;
export const SRGBColorSpace = 'srgb';
