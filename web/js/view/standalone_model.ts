/** A model drawn by itself, outside of the world: ghosts, previews, thumbnails. */
import {Group} from 'three';
import {free} from './markers.js';
import {place} from './three_convert.js';
import {meshOf, visualParts} from './shape_meshes.js';
import type {Model} from '../protocol.js';
import type {Part, Stock} from './shape_meshes.js';

/**
 * @returns the group's children are
 * the links, named so; its own pose is left to the caller
 */
export function standaloneModel(model: Model, stock: Stock, look: {opacity?: number} = {}):
    {group: Group, ready: Promise<void>, dispose: () => void} {
  const group = new Group();
  const waits: Promise<void>[] = [];
  for (const link of model.links) {
    const linkGroup = new Group();
    linkGroup.name = link.name;
    place(linkGroup, link.pose);
    group.add(linkGroup);
    for (const visual of link.visuals) {
      const add = (parts: Part[]) => {
        for (const part of parts) {
          const mesh = meshOf(part);
          mesh.castShadow = visual.cast_shadows;
          mesh.receiveShadow = true;
          linkGroup.add(mesh);
        }
      };
      const parts = visualParts(visual, stock, look);
      if (parts instanceof Promise) waits.push(parts.then(add));
      else add(parts);
    }
  }
  const dispose = () => free(group);
  return {group, ready: Promise.all(waits).then(() => {}), dispose};
}
