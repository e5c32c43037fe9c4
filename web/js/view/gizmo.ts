/** The handles for moving, turning and scaling: always of one size on the screen, always on top. */
import {
  BoxGeometry, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, TorusGeometry,
  Vector3,
} from 'three';
import type {BufferGeometry, Object3D} from 'three';

export type GizmoMode = 'translate'|'rotate'|'scale';
export type AxisName = 'x'|'y'|'z';

const COLORS = {x: 0xe5383b, y: 0x38b000, z: 0x2f6fed};
const AXES = ['x', 'y', 'z'] as const;
const LIT = 0xffd60a;
const PIXELS = 96;

const paint = (color: number) => new MeshBasicMaterial({color, depthTest: false, depthWrite: false,
  transparent: true, opacity: 0.95, fog: false});
const unseen = new MeshBasicMaterial({visible: false});

/** What each mode's handle along z is made of; `grip` is what the mouse hits. */
const HANDLES = {
  translate: (material: MeshBasicMaterial) => [
    piece(new CylinderGeometry(0.018, 0.018, 0.8, 8), material, 0.45),
    piece(new ConeGeometry(0.07, 0.2, 16), material, 0.92),
    piece(new CylinderGeometry(0.1, 0.1, 0.95, 6), unseen, 0.6),
  ],
  scale: (material: MeshBasicMaterial) => [
    piece(new CylinderGeometry(0.018, 0.018, 0.8, 8), material, 0.45),
    piece(new BoxGeometry(0.13, 0.13, 0.13), material, 0.9),
    piece(new CylinderGeometry(0.1, 0.1, 0.95, 6), unseen, 0.6),
  ],
  rotate: (material: MeshBasicMaterial) => [
    new Mesh(new TorusGeometry(0.85, 0.016, 8, 64), material),
    new Mesh(new TorusGeometry(0.85, 0.08, 6, 32), unseen),
  ],
};

/** three's cylinders stand along y. */
function piece(geometry: BufferGeometry, material: MeshBasicMaterial, height: number) {
  const mesh = new Mesh(geometry.rotateX(Math.PI / 2), material);
  mesh.position.z = height;
  return mesh;
}

const ALONG = {x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1)};
const UP = new Vector3(0, 0, 1);

function makeMode(mode: GizmoMode) {
  const group = new Group();
  for (const axis of AXES) {
    const handle = new Group();
    const material = paint(COLORS[axis]);
    handle.add(...HANDLES[mode](material));
    handle.quaternion.setFromUnitVectors(UP, ALONG[axis]);
    handle.userData = {axis, material};
    handle.traverse((part) => {
      part.renderOrder = 100;
      part.castShadow = false;
    });
    group.add(handle);
  }
  group.visible = false;
  return group;
}

export class Gizmo {
  group = new Group();
  #modes = {translate: makeMode('translate'), rotate: makeMode('rotate'),
    scale: makeMode('scale')};
  #mode: GizmoMode|null = null;
  #lit: AxisName|null = null;

  constructor(scene: Object3D) {
    this.group.add(...Object.values(this.#modes));
    scene.add(this.group);
  }

  show(mode: 'translate'|'rotate'|'scale'|null) {
    this.#mode = mode;
    for (const [name, group] of Object.entries(this.#modes)) group.visible = name === mode;
  }

  get shown() { return this.#mode !== null; }

  /**
   * @param pose  pose7 of the handles' origin and axes
   * @param unit  metres per pixel there
   */
  place(pose: number[], unit: number) {
    this.group.position.set(pose[0], pose[1], pose[2]);
    this.group.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
    this.group.scale.setScalar(PIXELS * unit);
  }

  /** What can be grasped. */
  get grips() {
    return this.#mode ? this.#modes[this.#mode].children : [];
  }

  /** The axis of a hit of `grips`. */
  static axisOf(object: Object3D|null) {
    let node = object;
    while (node && !node.userData.axis) node = node.parent;
    return node?.userData.axis ?? null;
  }

  /**
   * Lights one axis up.
   * @returns whether that changes the picture
   */
  light(axis: AxisName|null): boolean {
    if (axis === this.#lit) return false;
    this.#lit = axis;
    for (const group of Object.values(this.#modes)) {
      for (const {userData} of group.children) {
        const own = userData.axis as AxisName;
        userData.material.color.set(own === axis ? LIT : COLORS[own]);
      }
    }
    return true;
  }
}
