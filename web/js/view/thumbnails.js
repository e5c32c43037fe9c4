/** Small pictures of models for the library, drawn by this page. */
import {
  Box3, Color, DirectionalLight, HemisphereLight, Matrix4, PerspectiveCamera, Scene, Vector3,
} from 'three';
import {forward, framing, lookAt, right, up} from '../camera_math.js';
import {standaloneModel} from './standalone_model.js';
/** @import {Model} from '../protocol.js' */
/** @import {Stage} from './stage.js' */
/** @import {Stock} from './shape_meshes.js' */

const SIZE = 192;
const FOV = 0.6;

/**
 * @param {Stage} stage  whose canvas is borrowed for one picture
 * @param {Model} model
 * @param {Stock} stock
 * @returns {Promise<Blob|null>} PNG; null when nothing of it can be seen
 */
export async function thumbnail(stage, model, stock) {
  const {group, ready} = standaloneModel(model, stock);
  await ready;
  await stock.meshes.idle();
  group.updateMatrixWorld(true);  // the parts' own matrices were set by hand
  const box = new Box3().setFromObject(group);
  if (box.isEmpty()) return null;
  const scene = new Scene();
  scene.background = new Color(0xdfe3e8);
  const sun = new DirectionalLight(0xffffff, 2.4);
  sun.position.set(2, -3, 4);
  scene.add(group, sun, new HemisphereLight(0xffffff, 0x9a948c, 2));
  const view = framing(lookAt([3, -4, 2.6], [0, 0, 0]), shifted(box), FOV, 1);
  const camera = new PerspectiveCamera(FOV * 180 / Math.PI, 1, 0.01, 2000);
  camera.position.fromArray(view.position).add(box.getCenter(new Vector3()));
  camera.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(new Vector3().fromArray(right(view)),
    new Vector3().fromArray(up(view)), new Vector3().fromArray(forward(view)).negate()));
  return stage.borrow(scene, camera, SIZE);
}

/**
 * The box about its own centre, so that the view comes from the same side for every model.
 * @param {Box3} box
 */
function shifted(box) {
  const half = box.getSize(new Vector3()).multiplyScalar(0.5);
  return {min: half.clone().negate().toArray(), max: half.toArray()};
}
