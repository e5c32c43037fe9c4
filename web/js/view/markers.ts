/** Small things drawn over the world: axes, arrows, boxes of lines. */
import {
  BoxGeometry, BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, EdgesGeometry,
  Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, Quaternion, SphereGeometry, Vector3,
} from 'three';
import {place} from './three_convert.js';
import {withParts} from '../parts.js';
import type {CameraRig} from './camera_rig.js';
import type {Box3, ColorRepresentation, Material, Object3D} from 'three';
import type {Numbers, Vec3} from '../pose.js';
import type {Stage} from './stage.js';

const UP = new Vector3(0, 0, 1);
/** Edge of the box around a light, m. */
export const ICON_SIZE = 0.7;
const RGB = [[1, 0.15, 0.15], [0.2, 0.8, 0.2], [0.25, 0.45, 1]];

/** A material for marks that show through bodies. */
export const through = (color: ColorRepresentation, opacity = 1) =>
    new MeshBasicMaterial({color, opacity,
  transparent: true, depthTest: false, depthWrite: false, fog: false});

const triadMaterial = new LineBasicMaterial({vertexColors: true, depthTest: false,
  transparent: true, fog: false});
const boxEdges = new EdgesGeometry(new BoxGeometry(1, 1, 1));
const shaft = new CylinderGeometry(0.02, 0.02, 0.8, 8).rotateX(Math.PI / 2).translate(0, 0, 0.4);
const tip = new ConeGeometry(0.06, 0.2, 16).rotateX(Math.PI / 2).translate(0, 0, 0.9);
export const ball = new SphereGeometry(1, 16, 12);

/** Line segments between pairs of points. */
export function segments(points: number[][], material: Material) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points.flat()), 3));
  geometry.userData.single = true;
  const made = new LineSegments(geometry, material);
  made.renderOrder = 50;
  return made;
}

/** Three axes in red, green and blue, `size` m long. */
export function triad(size: number) {
  const points = [0, 1, 2].flatMap((axis) => [[0, 0, 0],
    [0, 1, 2].map((index) => (index === axis ? size : 0))]);
  const made = segments(points, triadMaterial);
  made.geometry.setAttribute('color',
    new BufferAttribute(new Float32Array(RGB.flatMap((color) => [...color, ...color])), 3));
  return made;
}

/** An arrow of length 1 along a direction; scale it. */
export function arrow(direction: Numbers, material: Material) {
  const group = new Group();
  for (const geometry of [shaft, tip]) {
    const mesh = new Mesh(geometry, material);
    mesh.renderOrder = 55;
    group.add(mesh);
  }
  point(group, direction);
  return group;
}

/** Turns an arrow. */
export function point(group: Object3D, direction: Numbers) {
  const way = new Vector3().fromArray(direction);
  if (way.lengthSq() === 0) return;
  group.quaternion.copy(new Quaternion().setFromUnitVectors(UP, way.normalize()));
}

/** The edges of a box of size 1. */
export const boxLines = (material: Material) => new LineSegments(boxEdges, material);

/** Fits the edges of a box around bounds in the axes of a pose, with a margin; around an icon without bounds. */
export function fitBox(box: LineSegments, pose: Numbers, bounds: Box3|null, margin: number) {
  place(box, pose);
  if (!bounds) {
    box.scale.setScalar(ICON_SIZE);
    return;
  }
  bounds.getSize(box.scale).addScalar(margin);
  box.position.add(bounds.getCenter(new Vector3()).applyQuaternion(box.quaternion));
}

/** Frees the geometries that only this object has (`userData.single`). */
export function free(root: Object3D) {
  root.traverse((object) => {
    if ((object instanceof Mesh || object instanceof LineSegments) &&
      object.geometry.userData.single) object.geometry.dispose();
  });
}

/** Takes everything out of a group and frees what belongs to it alone. */
export function empty(group: Object3D) {
  free(group);
  group.clear();
}

/** The small yellow ball that marks what the camera turns about. */
export class PivotMark extends withParts<{stage: Stage, rig: CameraRig}>() {
  #mesh = new Mesh(ball, through(0xffd60a, 0.9));

  constructor(parts: {stage: Stage, rig: CameraRig}) {
    super(parts);
    this.#mesh.visible = false;
    this.#mesh.renderOrder = 90;
    this.stage.scene.add(this.#mesh);
  }

  show(place: Vec3) {
    this.#mesh.visible = true;
    this.#mesh.position.fromArray(place);
    this.#mesh.scale.setScalar(4 * this.rig.unitAt(place));
  }

  hide() {
    if (!this.#mesh.visible) return;
    this.#mesh.visible = false;
    this.stage.invalidate();
  }
}
