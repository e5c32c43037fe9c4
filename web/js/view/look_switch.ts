/**
 * A switch that is in sight while the view's sky, haze or ambient light differ from those of cameras:
 * it says so, and changes to the values of the world.
 */
import {h} from '../ui/dom.js';
import {leavesAmbient, leavesBackground} from './sky.js';
import type {Actions} from '../actions.js';
import type {Store} from '../store.js';

/** @param parent  the view's element */
export function mountLookSwitch(parent: HTMLElement, {store, actions}: {store: Store, actions: Actions}) {
  const button = h('button', {type: 'button', class: 'look-switch', onclick: () =>
    actions.toggleOverlay('cameraColors')});
  const show = () => {
    const scene = store.document?.scene;
    const asCameras = store.overlays.scene.cameraColors;
    button.hidden = !scene || !(leavesBackground(scene) || leavesAmbient(scene));
    button.textContent = asCameras ? 'Sky as in cameras' : 'Sky of the editor';
    button.title = asCameras ? 'Show the sky and the soft light of the editor'
      : 'Only the editor shows this sky and this soft light; cameras see the background and the light of the world. Click to show these.';
    button.setAttribute('aria-pressed', String(asCameras));
  };
  for (const event of ['document', 'entity', 'overlays'] as const) store.listen(event, show);
  show();
  // The view's mouse is not for the switch.
  for (const event of ['pointerdown', 'dblclick'] as const) {
    button.addEventListener(event, (one) => one.stopPropagation());
  }
  parent.append(button);
}
