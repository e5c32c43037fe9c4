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
  const button = h('button', {class: 'look-switch', onclick: () =>
    actions.toggleOverlay('cameraColors')});
  const show = () => {
    const scene = store.document?.scene;
    const asCameras = store.overlays.scene.cameraColors;
    button.hidden = !scene || !(leavesBackground(scene) || leavesAmbient(scene));
    button.textContent = asCameras ? 'Camera colors' : 'Editor colors';
    button.title = asCameras ? 'Shown: the background and the light that cameras see. Click for the sky and the soft light of the editor.'
      : 'Shown: a sky and a soft light that only the editor has. Click for the background and the light that cameras see.';
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
