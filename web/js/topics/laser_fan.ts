/** The fan of a laser scan as triangles. */
import type {ScanView} from '../protocol.js';
import type {Numbers} from '../pose.js';

/**
 * The corners of a fan: its origin, then the end of each ray; and the triangles between rays that
 * both met something.
 * @param ranges  NaN where nothing was met
 */
export function fanOf(scan: ScanView, ranges: Numbers) {
  const corners = new Float32Array(3 * (ranges.length + 1));
  const triangles: number[] = [];
  const hits: number[] = [];
  for (let ray = 0; ray < ranges.length; ray++) {
    const range = ranges[ray];
    const seen = Number.isFinite(range);
    const angle = scan.angle_min + ray * scan.angle_increment;
    const reach = seen ? range : 0;
    corners[3 * ray + 3] = reach * Math.cos(angle);
    corners[3 * ray + 4] = reach * Math.sin(angle);
    if (!seen) continue;
    hits.push(corners[3 * ray + 3], corners[3 * ray + 4], 0);
    if (ray > 0 && Number.isFinite(ranges[ray - 1])) triangles.push(0, ray, ray + 1);
  }
  return {corners, triangles, hits};
}
