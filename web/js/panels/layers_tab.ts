/** The Layers tab: a check box for each `visual/meta/layer` that occurs. */
import {fill, h, onceAFrame} from '../ui/dom.js';
import type {World} from '../protocol.js';
import type {Page} from './panels.js';

/**
 * The layers of a world. Pure.
 * @returns ascending
 */
export function layersOf(document: World|null): number[] {
  const layers: Set<number> = new Set();
  for (const model of document?.models ?? []) {
    for (const link of model.links) {
      for (const {layer} of link.visuals) {
        if (layer !== undefined && layer !== null) layers.add(layer);
      }
    }
  }
  return [...layers].sort((a, b) => a - b);
}

export function mountLayers(element: HTMLElement, {store}: Page) {
  let shown = '';
  const show = onceAFrame(() => {
    const layers = layersOf(store.document);
    const signature = JSON.stringify([layers, [...store.overlays.hiddenLayers]]);
    if (signature === shown) return;
    shown = signature;
    fill(
      element,
      ...(layers.length
        ? layers.map((layer) =>
            h(
              'label',
              {class: 'check-row'},
              h('input', {
                type: 'checkbox',
                checked: !store.overlays.hiddenLayers.has(layer),
                onchange: () => store.setLayer(layer, store.overlays.hiddenLayers.has(layer)),
              }),
              `Layer ${layer}`,
            ),
          )
        : [
            h('p', {
              class: 'empty',
              text: 'No visual in this world defines a layer (visual/meta/layer).',
            }),
          ]),
    );
  });
  for (const event of ['document', 'entity', 'overlays'] as const) store.listen(event, show);
  show();
}
