/** Places of links and joints in the schematic view of a model. Pure. */
import type {Joint, Model} from '../protocol.js';

/** Size of a box and gaps between boxes, px. */
export const BOX = Object.freeze({width: 112, height: 26, across: 16, down: 46, margin: 12});

/** left upper corner, px */
export type Placed = {name: string, x: number, y: number};
export type Edge = {joint: Joint, from: Placed, to: Placed};

/** Boxes in rows by the number of joints above them, a child below its parent. */
export function schematicOf({links, joints}: Pick<Model, 'links'|'joints'>): {links: Placed[],
    edges: Edge[], width: number, height: number} {
  const names = [...(joints.some(({parent}) => parent === 'world') ? ['world'] : []), ...links.map(({name}) => name)];
  const rows = rowsOf(names, joints);
  const placed: Map<string, Placed> = new Map();
  const widest = Math.max(1, ...rows.map((row) => row.length));
  rows.forEach((row, level) => row.forEach((name, at) => placed.set(name, {
    name,
    x: BOX.margin + (at + (widest - row.length) / 2) * (BOX.width + BOX.across),
    y: BOX.margin + level * (BOX.height + BOX.down),
  })));
  const edges = joints.flatMap((joint) => {
    const [from, to] = [placed.get(joint.parent), placed.get(joint.child)];
    return from && to ? [{joint, from, to}] : [];
  });
  return {
    links: [...placed.values()], edges,
    width: 2 * BOX.margin + widest * (BOX.width + BOX.across) - BOX.across,
    height: 2 * BOX.margin + rows.length * (BOX.height + BOX.down) - BOX.down,
  };
}

/** Names by level, in the order of their parents. Links in a loop of joints are placed, too. */
function rowsOf(names: string[], joints: Pick<Joint, 'parent'|'child'>[]) {
  const children = new Set(joints.map(({child}) => child));
  const left = new Set(names);
  const rows: string[][] = [];
  let row = names.filter((name) => !children.has(name));
  while (left.size) {
    if (!row.length) row = [...left].slice(0, 1);
    for (const name of row) left.delete(name);
    rows.push(row);
    row = [...new Set(row.flatMap((name) => joints.filter(({parent, child}) => parent === name && left.has(child))
      .map(({child}) => child)))];
  }
  return rows;
}
