/** Puts the 3D view into the page, or a notice if WebGL is not available. */
import {SceneView} from './scene_view.js';
import {NoWebGL} from './stage.js';
import type {Actions} from '../actions.js';
import type {Connection} from '../connection.js';
import type {Store} from '../store.js';
import type {Topics} from '../topics/topics.js';
import type {Watches} from '../watches.js';
import type {Batches} from './batches.js';
import type {CameraRig} from './camera_rig.js';
import type {Lights} from './light_views.js';
import type {Models} from './model_views.js';
import type {Picker} from './picking.js';
import type {Stock} from './shape_meshes.js';
import type {Stage} from './stage.js';

/** What the view's parts share. */
export interface ViewParts {
  store: Store;
  actions: Actions;
  connection: Connection;
  watches?: Watches|undefined;
  stage: Stage;
  stock: Stock;
  batches: Batches;
  models: Models;
  lights: Lights;
  rig: CameraRig;
  picker: Picker;
}

/** `resolveUrl` returns where a mesh or picture is loaded from; without it, from the simulator. */
export type ViewOptions = Pick<ViewParts, 'store'|'actions'|'connection'|'watches'> &
    {topics: Topics, resolveUrl?: (url: string) => string};

const NO_WEBGL = `WebGL is not available in this browser, and the 3D view needs it. The tree, the
  properties, the time bar and saving work without it. To get the 3D view, enable hardware
  acceleration in the browser's settings, update the graphics driver, or allow software rendering
  (Chromium: --enable-unsafe-swiftshader).`;

/** Shows a notice in place of the view if WebGL is not available. */
function withoutWebGL(element: HTMLElement) {
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

/** @param element  gets the canvas */
export function mountView(element: HTMLElement, parts: ViewOptions): Pick<SceneView,
    'fps'|'available'|'thumbnail'|'redraw'|'dispose'> {
  try {
    return new SceneView(element, parts);
  } catch (error) {
    if (!(error instanceof NoWebGL)) throw error;
    return withoutWebGL(element);
  }
}
