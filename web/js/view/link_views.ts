/** A model and its links as they are drawn. */
import {Matrix4, Vector3} from 'three';
import {boxOf} from './shape_meshes.js';
import type {Item} from './batches.js';
import type {Link, Model} from '../protocol.js';

export class LinkView {
  link;
  items: Item[] = [];
  matrix = new Matrix4();
  /** The pose that is shown. */
  shown = new Float64Array(7);
  /** Of the visuals about the link's origin, m; 0: not known yet. */
  radius = 0;

  constructor(link: Link) {
    this.link = link;
  }
}

export class ModelView {
  document;
  links: Map<number, LinkView> = new Map();
  gone = false;

  constructor(document: Model) {
    this.document = document;
    for (const link of document.links) this.links.set(link.id, new LinkView(link));
  }
}

/** @returns radius of a sphere about the origin of a link that contains its visuals, m */
export function radiusOf({items}: LinkView): number {
  const corner = new Vector3();
  let farthest = 0.05;
  for (const {geometry, local} of items) {
    const box = boxOf(geometry);
    if (local) box.applyMatrix4(local);
    corner.set(Math.max(-box.min.x, box.max.x), Math.max(-box.min.y, box.max.y),
      Math.max(-box.min.z, box.max.z));
    if (Number.isFinite(corner.length())) farthest = Math.max(farthest, corner.length());
  }
  return farthest;
}
