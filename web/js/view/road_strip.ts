/**
 * Roads as triangles. Cameras see the same strip: src/my_simulations/sensing/scenery.py; a test
 * compares both with test/data/road_strips.json. Pure.
 */
import type {Road} from '../protocol.js';

/** m by which a road lies above its points, so that a ground at their height does not hide it. */
const LIFT = 0.01;

/**
 * A flat strip along the points. Its sides run half the width to the left and to the right of the
 * points, level, at right angles to the line from the point before to the next.
 * @returns corners x, y, z in the world
 * frame, a left and a right one for each point; u is 0 on the left and 1 on the right, v grows by
 * 1 in each width of the way; three corners a triangle
 */
export function roadStrip({points, width}: Pick<Road, 'points'|'width'>): {corners: number[],
    uvs: number[], triangles: number[]} {
  const corners: number[] = [];
  const uvs: number[] = [];
  const triangles: number[] = [];
  let along = 0;
  points.forEach((point, index) => {
    const before = points[Math.max(index - 1, 0)];
    const after = points[Math.min(index + 1, points.length - 1)];
    const [dx, dy] = [after[0] - before[0], after[1] - before[1]];
    const norm = Math.hypot(dx, dy) || 1;
    const side = [(-dy / norm) * width / 2, (dx / norm) * width / 2];
    along += index ? Math.hypot(point[0] - before[0], point[1] - before[1]) / width : 0;
    for (const [sign, u] of [[1, 0], [-1, 1]]) {
      corners.push(point[0] + sign * side[0], point[1] + sign * side[1], point[2] + LIFT);
      uvs.push(u, along);
    }
    if (index) {
      const at = 2 * index;
      triangles.push(at - 2, at - 1, at, at, at - 1, at + 1);
    }
  });
  return {corners, uvs, triangles};
}
