/** Puts the 3D view into the page, or a notice if WebGL is not available. */
import {View} from './scene_view.js';
import {NoWebGL} from './stage.js';
/** @import {Actions} from '../actions.js' */
/** @import {Connection} from '../connection.js' */
/** @import {Store} from '../store.js' */
/** @import {Topics} from '../topics/topics.js' */
/** @import {Watches} from '../watches.js' */
/** @import {Batches} from './batches.js' */
/** @import {CameraRig} from './camera_rig.js' */
/** @import {Lights} from './light_views.js' */
/** @import {Models} from './model_views.js' */
/** @import {Picker} from './picking.js' */
/** @import {Stock} from './shape_meshes.js' */
/** @import {Stage} from './stage.js' */

/**
 * What the view's parts share.
 * @typedef {object} ViewParts
 * @property {Store} store
 * @property {Actions} actions
 * @property {Connection} connection
 * @property {Watches} [watches]
 * @property {Stage} stage
 * @property {Stock} stock
 * @property {Batches} batches
 * @property {Models} models
 * @property {Lights} lights
 * @property {CameraRig} rig
 * @property {Picker} picker
 */

/** @typedef {InstanceType<typeof View>} SceneView */

/**
 * `resolveUrl` returns where a mesh or picture is loaded from; without it, from the simulator.
 * @typedef {Pick<ViewParts, 'store'|'actions'|'connection'|'watches'> &
 *   {topics: Topics, resolveUrl?: (url: string) => string}} ViewOptions
 */

const NO_WEBGL = `WebGL is not available in this browser, and the 3D view needs it. The tree, the
  properties, the time bar and saving work without it. To get the 3D view, enable hardware
  acceleration in the browser's settings, update the graphics driver, or allow software rendering
  (Chromium: --enable-unsafe-swiftshader).`;

/** Shows a notice in place of the view if WebGL is not available. @param {HTMLElement} element */
function withoutWebGL(element) {
  const text = document.createElement('p');
  text.className = 'no-webgl';
  text.setAttribute('role', 'alert');
  text.textContent = NO_WEBGL;
  element.append(text);
  return {
    fps: 0, available: false, thumbnail: async () => null, redraw: () => {},
    dispose: () => text.remove(),
  };
}

/**
 * @param {HTMLElement} element  gets the canvas
 * @param {ViewOptions} parts
 * @returns {Pick<SceneView, 'fps'|'available'|'thumbnail'|'redraw'|'dispose'>}
 */
export function mountView(element, parts) {
  try {
    return new View(element, parts);
  } catch (error) {
    if (!(error instanceof NoWebGL)) throw error;
    return withoutWebGL(element);
  }
}
