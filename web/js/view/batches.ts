/**
 * Many bodies in few draws: what has equal geometry and material becomes one instanced mesh, from a
 * handful on, or one merged mesh where a processor draws, which also merges different small meshes of
 * one material; fewer are meshes of their own, which are left out when they are not in sight.
 */
import {InstancedMesh, Mesh, DynamicDrawUsage} from 'three';
import {CASTERS} from './contact_shadows.js';
import {MergedMesh, mergeable, movingForm} from './merged_mesh.js';
import {MixedMesh, mixable} from './mixed_mesh.js';
import type {BufferGeometry, Material, Matrix4, Object3D} from 'three';
import type {Owner} from './model_views.js';

const HANDFUL = 4;
/** From here on a geometry's plainer form will do, where it has one. */
const CROWD = 64;

/** One thing drawn; also what picking looks at. */
export interface Item {
  geometry: BufferGeometry;
  material: Material|Material[];
  /** world from geometry; tell `moved` when it changes */
  matrix: Matrix4;
  /** link from geometry */
  local?: Matrix4;
  owner: Owner;
  castShadow: boolean;
  receiveShadow: boolean;
  renderOrder: number;
  /** of its batch */
  key: string;
  /** its place in the batch */
  slot: number;
}

class Batch {
  scene;
  sample;
  merging;
  mixed;
  items: Item[] = [];
  #meshes: Mesh[] = [];
  /** All of them in one. */
  #crowd: InstancedMesh|MergedMesh|MixedMesh|null = null;
  #capacity = 0;
  #moving = false;

  constructor(scene: Object3D, sample: Item, {merging, mixed}: {merging: boolean, mixed: boolean}) {
    this.scene = scene;
    this.sample = sample;
    this.merging = merging;
    this.mixed = mixed;
  }

  add(item: Item) {
    item.slot = this.items.length;
    this.items.push(item);
    if (this.#crowd && this.items.length <= this.#capacity) {
      this.#count();
      this.move(item);
    } else if (!this.#crowd && this.items.length <= HANDFUL) {
      const mesh = new Mesh(item.geometry, item.material);
      mesh.matrixAutoUpdate = false;
      this.#show(mesh);
      this.#meshes.push(mesh);
      this.move(item);
    } else this.#grow();
  }

  /** The last one takes the place of the one that goes. */
  remove(item: Item) {
    const last = this.items.pop();
    if (last && last !== item) {
      last.slot = item.slot;
      this.items[item.slot] = last;
      this.move(last);
    }
    if (this.#crowd) this.#count();
    else this.scene.remove(...this.#meshes.splice(-1));
    if (!this.items.length) this.#drop();
  }

  /**
   * Before a picture.
   * @param moving  draw the plainer forms, where there are any
   * @returns whether that changes what is drawn
   */
  prepare(moving: boolean) {
    const changes = moving !== this.#moving && this.items.some(({geometry}) => movingForm(geometry) !== geometry);
    this.#moving = moving;
    if (this.#crowd instanceof MixedMesh) this.#crowd.prepare(moving);
    else if (changes && this.#crowd) this.#crowd.geometry = this.#form(this.sample.geometry);
    else if (changes) this.#meshes.forEach((mesh, slot) => { mesh.geometry = this.#form(this.items[slot].geometry); });
    return changes;
  }

  #form(geometry: BufferGeometry) {
    return this.#moving ? movingForm(geometry) : geometry;
  }

  move(item: Item) {
    const {slot, matrix, geometry} = item;
    if (this.#crowd instanceof MixedMesh) this.#crowd.move(slot);
    else if (this.#crowd) {
      this.#crowd.setMatrixAt(slot, matrix);
      if (this.#crowd instanceof InstancedMesh) this.#crowd.instanceMatrix.needsUpdate = true;
    } else {
      const mesh = this.#meshes[slot];
      mesh.geometry = this.#form(geometry);
      mesh.matrix.copy(matrix);
      mesh.matrixWorldNeedsUpdate = true;
    }
  }

  #grow() {
    this.#drop();
    const {geometry, material} = this.sample;
    this.#capacity = this.mixed ? Infinity : Math.max(16, 2 * this.items.length);
    const plainer = this.items.length > CROWD ? geometry.userData.plainer : null;
    const mesh = this.#mesh(plainer ?? geometry, material);
    // Its bounds would have to follow every body at every frame.
    mesh.frustumCulled = false;
    this.#show(mesh);
    this.#crowd = mesh;
    this.#count();
    for (const item of this.items) this.move(item);
  }

  #count() {
    if (this.#crowd instanceof MixedMesh) this.#crowd.show(this.items);
    else if (this.#crowd instanceof MergedMesh) this.#crowd.show(this.items.length);
    else if (this.#crowd) this.#crowd.count = this.items.length;
  }

  #mesh(geometry: BufferGeometry, material: Material|Material[]) {
    if (this.mixed) return new MixedMesh([material].flat()[0]);
    if (this.merging && mergeable(geometry, material)) {
      return new MergedMesh(geometry, [material].flat()[0], this.#capacity);
    }
    const mesh = new InstancedMesh(this.#form(geometry), material, this.#capacity);
    mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    return mesh;
  }

  #show(mesh: Mesh) {
    mesh.castShadow = this.sample.castShadow;
    if (mesh.castShadow) mesh.layers.enable(CASTERS);
    mesh.receiveShadow = this.sample.receiveShadow;
    mesh.renderOrder = this.sample.renderOrder;
    this.scene.add(mesh);
  }

  #drop() {
    for (const mesh of this.#meshes) this.scene.remove(mesh);
    this.#meshes = [];
    if (this.#crowd) {
      this.scene.remove(this.#crowd);
      this.#crowd.dispose();
      this.#crowd = null;
    }
  }
}

const materialKey = (material: Material|Material[]) => Array.isArray(material)
  ? material.map(({uuid}) => uuid).join() : material.uuid;

export class Batches {
  #batches: Map<string, Batch> = new Map();
  #scene;
  #merging;
  #nextAlone = 0;

  /** @param options  merging: instances cost as much as draws */
  constructor(scene: Object3D, {merging = false}: {merging?: boolean} = {}) {
    this.#scene = scene;
    this.#merging = merging;
  }

  add({castShadow = true, receiveShadow = true, renderOrder = 0, ...wanted}: Pick<Item,
      'geometry'|'material'|'matrix'|'owner'> & Partial<Item>): Item {
    // What is seen through is sorted by distance, which instances are not.
    const alone = [wanted.material].flat().some(({transparent}) => transparent);
    const mixed = this.#merging && mixable(wanted.geometry, wanted.material);
    const key = [mixed ? 'mixed' : wanted.geometry.uuid, materialKey(wanted.material), castShadow, receiveShadow,
      renderOrder, alone ? this.#nextAlone++ : ''].join(' ');
    const item = {...wanted, castShadow, receiveShadow, renderOrder, key, slot: 0};
    let batch = this.#batches.get(item.key);
    if (!batch) this.#batches.set(item.key, batch = new Batch(this.#scene, item, {merging: this.#merging, mixed}));
    batch.add(item);
    return item;
  }

  remove(item: Item) {
    const batch = this.#batches.get(item.key);
    if (!batch) return;
    batch.remove(item);
    if (!batch.items.length) this.#batches.delete(item.key);
    if (item.geometry.userData.single) item.geometry.dispose();
  }

  /** Applies an item's changed matrix. */
  moved(item: Item) {
    this.#batches.get(item.key)?.move(item);
  }

  /**
   * Write what has changed, before a picture.
   * @param moving  draw the plainer forms of meshes, where they have any
   * @returns whether what is drawn has other forms than before
   */
  prepare(moving = false) {
    let changed = false;
    for (const batch of this.#batches.values()) changed = batch.prepare(moving) || changed;
    return changed;
  }

  /** Everything that is drawn. */
  *items(): Generator<Item> {
    for (const batch of this.#batches.values()) yield* batch.items;
  }
}
