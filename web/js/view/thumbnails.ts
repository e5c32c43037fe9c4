/** Small pictures of models for the library, drawn by this page. */
import {
  Box3, Color, DirectionalLight, HemisphereLight, Matrix4, PerspectiveCamera, Scene, Vector3,
} from 'three';
import {forward, framing, lookAt, right, up} from '../camera_math.js';
import {Materials} from './materials.js';
import {Meshes} from './mesh_files.js';
import {standaloneModel} from './standalone_model.js';
import type {Connection} from '../connection.js';
import type {Model} from '../protocol.js';
import type {Stage} from './stage.js';
import type {Stock} from './shape_meshes.js';

const SIZE = 192;
const FOV = 0.6;
const BACKGROUND = new Color(0xdfe3e8);

/**
 * @param stage  whose canvas is borrowed for one picture
 * @returns PNG; null when nothing of it can be seen
 */
async function thumbnail(stage: Stage, model: Model, stock: Stock): Promise<Blob|null> {
  const {group, ready} = standaloneModel(model, stock);
  await ready;
  await stock.meshes.idle();
  group.updateMatrixWorld(true);  // the parts' own matrices were set by hand
  const box = new Box3().setFromObject(group);
  if (box.isEmpty()) return null;
  const scene = new Scene();
  scene.background = BACKGROUND;
  const sun = new DirectionalLight(0xffffff, 2.4);
  sun.position.set(2, -3, 4);
  scene.add(group, sun, new HemisphereLight(0xffffff, 0x9a948c, 2));
  const view = framing(lookAt([3, -4, 2.6], [0, 0, 0]), shifted(box), FOV, 1);
  // A terrain is as far away as it is wide, a screw is not.
  const distance = Math.hypot(...view.position);
  const camera = new PerspectiveCamera(FOV * 180 / Math.PI, 1, distance / 100, distance * 10);
  camera.position.fromArray(view.position).add(box.getCenter(new Vector3()));
  camera.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(new Vector3().fromArray(right(view)),
    new Vector3().fromArray(up(view)), new Vector3().fromArray(forward(view)).negate()));
  return stage.borrow(scene, camera, SIZE);
}

/** The box about its own centre, so that the view comes from the same side for every model. */
function shifted(box: Box3) {
  const half = box.getSize(new Vector3()).multiplyScalar(0.5);
  return {min: half.clone().negate().toArray(), max: half.toArray()};
}

/** Pictures of the library's models: drawn once, and given to the simulator to keep. */
export class Gallery {
  #stage;
  #connection;
  #stock: Stock;
  /** By model URI. */
  #known: Map<string, Promise<string|null>> = new Map();

  constructor(stage: Stage, connection: Connection) {
    this.#stage = stage;
    this.#connection = connection;
    // Thumbnails do not report missing files, because no user has asked for these models.
    const unseen = new Meshes(() => {});
    const materials = new Materials(unseen.manager);
    materials.setDistance(BACKGROUND);
    this.#stock = {meshes: unseen, materials};
  }

  /**
   * @param uri  of the model
   * @param address  where the picture is kept
   * @returns an address for an <img>
   */
  thumbnail(uri: string, address?: string): Promise<string|null> {
    const known = this.#known.get(uri) ?? this.#draw(uri, address);
    this.#known.set(uri, known);
    return known;
  }

  async #draw(uri: string, address?: string) {
    const found = await this.#connection.request('library_get', {uri, quiet: true}).catch(() => null);
    const model = found?.model;
    const blob = model && await thumbnail(this.#stage, model, this.#stock);
    if (!blob) return null;
    if (address) await fetch(address, {method: 'PUT', body: blob}).catch(() => null);
    return URL.createObjectURL(blob);
  }
}
