/** What can be shown of models besides their looks: collisions, joints, masses, contacts, … */
import {
  BoxGeometry, CanvasTexture, DoubleSide, Group, LineBasicMaterial, Matrix4, Mesh,
  MeshBasicMaterial, MeshPhongMaterial, Quaternion, SRGBColorSpace, Vector3,
} from 'three';
import {equivalentBox} from '../inertia_math.js';
import {skeletonOf} from '../skeleton.js';
import {place} from './three_convert.js';
import {meshOf, visualParts} from './shape_meshes.js';
import {arrow, ball, boxLines, empty, free, segments, through, triad} from './markers.js';
import {patternCanvas} from './builtin_textures.js';
import {ViewPart} from './view_part.js';
import type {Box3, Object3D} from 'three';
import type {Contact, Joint, Link, Model} from '../protocol.js';
import type {OverlayFlag} from '../store.js';
import type {Part} from './shape_meshes.js';
import type {Vec3} from '../pose.js';
import type {ViewParts} from './view.js';

const PER_MODEL: readonly OverlayFlag[] = ['collisions', 'joints', 'com', 'inertia', 'frames',
    'skeleton'];
/** Density of lead: a ball of the link's mass is then small enough to see round. */
const LEAD = 11340;
const FRAME_SIZE = 0.25;
const JOINT_SIZE = 0.45;
/** The longest arrow of a joint, as a part of the diagonal of its model's box. */
const JOINT_PART = 0.4;
const SOCKET_SIZE = 0.02;

const collisionMaterial = new MeshPhongMaterial({color: 0xff8c1a, opacity: 0.4, transparent: true,
  depthWrite: false, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: -1,
  polygonOffsetUnits: -1});
const axisMaterial = through(0xffe600, 0.8);
const inertiaMaterial = through(0xb030d0, 0.4);
const crossMaterial = new LineBasicMaterial({color: 0x33cc66, depthTest: false, transparent: true});
const contactMaterial = through(0x2563eb, 0.9);
const normalMaterial = new LineBasicMaterial({color: 0x22d3ee, depthTest: false,
  transparent: true});
const socketMaterial = through(0xf5f5f5, 0.9);
const boneMaterial = new LineBasicMaterial({color: 0xf5f5f5, depthTest: false, transparent: true});
const unitBox = new BoxGeometry(1, 1, 1);

/** The rotation whose axes are three unit vectors. */
function basisOf(vectors: number[][]) {
  const [x, y, z] = vectors.map((axis) => new Vector3().fromArray(axis));
  return new Matrix4().makeBasis(x, y, z);
}

let massLooks: MeshBasicMaterial|undefined;

/** One for all links; there is a canvas for it only in a page. */
function massMaterial() {
  massLooks ??= makeMassMaterial();
  return massLooks;
}

function makeMassMaterial() {
  const canvas = patternCanvas('com');
  const map = canvas && new CanvasTexture(canvas);
  if (map) map.colorSpace = SRGBColorSpace;
  return new MeshBasicMaterial({map, depthTest: false, depthWrite: false, transparent: true});
}

function massMark({inertial}: Link, bounds: Box3|null) {
  const group = new Group();
  place(group, inertial.pose);
  const mark = new Mesh(ball, massMaterial());
  mark.scale.setScalar(Math.cbrt((3 * Math.max(inertial.mass, 1e-6)) / (4 * Math.PI * LEAD)));
  mark.renderOrder = 52;
  const half = bounds ? bounds.getSize(new Vector3()).multiplyScalar(0.5).toArray()
    : [0.1, 0.1, 0.1];
  const ends = [0, 1, 2].flatMap((axis) => [-1, 1].map((sign) =>
    [0, 1, 2].map((index) => (index === axis ? sign * half[axis] : 0))));
  group.add(mark, segments(ends, crossMaterial));
  return group;
}

function inertiaMark({inertial}: Link) {
  const box = equivalentBox(inertial);
  if (!box) return null;
  const group = new Group();
  place(group, inertial.pose);
  const solid = new Mesh(unitBox, inertiaMaterial);
  const lines = boxLines(crossMaterial);
  const axes = basisOf(box.vectors);
  for (const part of [solid, lines]) {
    part.quaternion.copy(new Quaternion().setFromRotationMatrix(axes));
    part.scale.fromArray(box.size.map((edge) => Math.max(edge, 1e-4)));
    part.renderOrder = 51;
    group.add(part);
  }
  return group;
}

/** @param most  length of its arrow, m */
function jointMark(joint: Joint, most: number) {
  const group = new Group();
  place(group, joint.pose);
  const length = Math.min(JOINT_SIZE, most);
  group.add(triad(FRAME_SIZE / JOINT_SIZE * length));
  for (const axis of [joint.axis, joint.axis2]) {
    if (!axis) continue;
    const mark = arrow(axis.xyz, axisMaterial);
    mark.scale.setScalar(length);
    group.add(mark);
  }
  return group;
}

function skeletonMark(model: Model, link: Link) {
  const {bones, sockets} = skeletonOf(model, link);
  if (!bones.length) return null;
  const group = new Group();
  group.add(segments(bones.flat(), boneMaterial));
  for (const at of sockets) {
    const mark = new Mesh(ball, socketMaterial);
    mark.position.fromArray(at);
    mark.scale.setScalar(SOCKET_SIZE);
    mark.renderOrder = 52;
    group.add(mark);
  }
  return group;
}

export class Overlays extends ViewPart {
  /** Groups of marks by model name, then by link id. */
  #groups: Map<string, Map<number, Group>> = new Map();
  #contacts = new Group();
  #unwatch: (() => void)|null = null;
  /** Models that are selected. */
  #selected: Set<string> = new Set();

  constructor(parts: ViewParts) {
    super(parts);
    const {store, stage} = parts;
    stage.scene.add(this.#contacts);
    store.listen('document', () => this.#rebuildAll());
    store.listen('selection', () => this.#selectionChanged());
    store.listen('overlays', (event) => this.#flagsChanged(event.detail ?? {}));
    store.listen('entity', ({detail}) => {
      if (detail.kind === 'model') this.#rebuild(detail.name);
    });
    store.listen('watch', ({detail}) => {
      if (detail.topic === 'contacts') this.#showContacts(detail.contacts ?? []);
    });
    // Contacts of the running world do not belong to a log that is shown instead.
    store.listen('log', () => {
      this.#contacts.visible = !store.showsLog || Boolean(store.log?.contacts);
      stage.invalidate();
    });
  }

  /** How many marks of contacts are seen, for tests. */
  get contacts() {
    return this.#contacts.visible ? this.#contacts.children.filter((mark) => mark instanceof Mesh).length : 0;
  }

  /**
   * Moves the marks with their links.
   * @param ids  null: all of them
   */
  follow(ids: Set<number>|null) {
    for (const links of this.#groups.values()) {
      for (const [id, group] of links) {
        if (ids && !ids.has(id)) continue;
        const matrix = this.models.linkMatrix(id);
        if (!matrix) continue;
        group.matrix.copy(matrix);
        group.matrixWorldNeedsUpdate = true;
      }
    }
  }

  /** What is shown of the selection alone goes with it. */
  #selectionChanged() {
    const before = this.#selected;
    this.#selected = new Set(this.store.selection.flatMap((name) =>
      this.store.split(name)[0]?.name ?? []));
    if (!Object.values(this.store.overlays.selection).some(Boolean)) return;
    for (const name of new Set([...before, ...this.#selected])) this.#rebuild(name);
    this.#watchContacts();
  }

  #flagsChanged({flag, model, layer}: {flag?: OverlayFlag, model?: string|undefined, layer?: number}) {
    const names = model ? [model] : this.store.document?.models.map(({name}) => name) ?? [];
    if (layer !== undefined || ['transparent', 'wireframe', 'hidden', 'cameraColors', 'simplifiedMeshes'].includes(flag ?? '')) {
      for (const name of names) this.models.rebuild(name);
    }
    if (flag && PER_MODEL.includes(flag)) for (const name of names) this.#rebuild(name);
    if (flag === 'contacts') this.#watchContacts();
    this.stage.invalidate();
  }

  #rebuildAll() {
    for (const name of [...this.#groups.keys()]) this.#drop(name);
    for (const {name} of this.store.document?.models ?? []) this.#rebuild(name);
    this.#watchContacts();
  }

  #drop(name: string) {
    for (const group of this.#groups.get(name)?.values() ?? []) {
      free(group);
      this.stage.scene.remove(group);
    }
    this.#groups.delete(name);
  }

  #rebuild(name: string) {
    this.#drop(name);
    const model = this.store.model(name);
    const flags = PER_MODEL.filter((flag) => this.store.overlay(flag, name));
    if (!model || !flags.length) return;
    const links: Map<number, Group> = new Map();
    this.#groups.set(name, links);
    for (const link of model.links) {
      const group = new Group();
      group.matrixAutoUpdate = false;
      for (const flag of flags) this.#fill(group, flag, model, link);
      links.set(link.id, group);
      this.stage.scene.add(group);
    }
    this.follow(null);
    this.stage.invalidate();
  }

  #fill(group: Group, flag: OverlayFlag, model: Model, link: Link) {
    const add = (mark: Object3D|null) => mark && group.add(mark);
    if (flag === 'frames') add(triad(FRAME_SIZE));
    else if (flag === 'skeleton') add(skeletonMark(model, link));
    else if (flag === 'collisions') this.#addCollisions(group, link);
    else if (flag === 'joints') {
      const most = JOINT_PART * (this.models.bounds(model.name)?.getSize(new Vector3()).length() ?? Infinity);
      for (const joint of model.joints) if (joint.child === link.name) add(jointMark(joint, most));
    } else if (!model.static) {
      const name = `${model.name}::${link.name}`;
      if (flag === 'com') {
        add(massMark(link, this.models.bounds(name, this.models.shownPose(name))));
      } else add(inertiaMark(link));
    }
  }

  #addCollisions(group: Group, link: Link) {
    for (const collision of link.collisions) {
      // An infinite plane would lie over everything.
      if (collision.geometry.type === 'plane') continue;
      const add = (parts: Part[]) => {
        for (const part of parts) {
          const mesh = meshOf(part);
          mesh.renderOrder = 5;
          group.add(mesh);
        }
        this.stage.invalidate();
      };
      const parts = visualParts(collision, this.stock, {material: collisionMaterial});
      if (parts instanceof Promise) parts.then(add);
      else add(parts);
    }
  }

  #watchContacts() {
    const wanted = this.#contactsWanted();
    if (wanted && !this.#unwatch) this.#unwatch = this.watches?.add('contacts') ?? null;
    if (!wanted && this.#unwatch) {
      this.#unwatch();
      this.#unwatch = null;
    }
    if (!wanted) this.#showContacts([]);
  }

  #contactsWanted() {
    const {scene, models, selection} = this.store.overlays;
    return scene.contacts || (selection.contacts && this.store.selection.length > 0) || Object.values(models).some(({contacts}) => contacts);
  }

  #showContacts(contacts: Contact[]) {
    if (!contacts.length && !this.#contacts.children.length) return;
    empty(this.#contacts);
    const shown = contacts.filter(({a, b}) =>
      [a, b].some((name) => this.store.overlay('contacts', this.store.split(name)[0]?.name ?? '')));
    const lines: Vec3[] = [];
    for (const {position, normal, depth} of shown) {
      const mark = new Mesh(ball, contactMaterial);
      mark.position.fromArray(position);
      mark.scale.setScalar(0.02);
      mark.renderOrder = 53;
      this.#contacts.add(mark);
      lines.push(position, position.map((part, i) => part + 0.2 * normal[i]),
        position, position.map((part, i) => part - depth * normal[i]));
    }
    if (lines.length) this.#contacts.add(segments(lines, normalMaterial));
    this.stage.invalidate();
  }
}
