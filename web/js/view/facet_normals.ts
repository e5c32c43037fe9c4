/** Normals of facets that a file leaves out. Pure. */

/**
 * Fills normals of zero length from the corners of their triangle, counter-clockwise as seen from
 * outside; such triangles would be black. The STL format allows zero normals.
 * @param position  nine numbers a triangle, m
 * @param normal  as many, changed in place
 */
export function fillNormals(position: ArrayLike<number>, normal: {[index: number]: number}) {
  for (let at = 0; at + 8 < position.length; at += 9) {
    if (normal[at] || normal[at + 1] || normal[at + 2]) continue;
    const [ax, ay, az, bx, by, bz] = [0, 1, 2, 3, 4, 5].map((part) =>
      position[at + 3 + part] - position[at + part % 3]);
    const found = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    const size = Math.hypot(...found) || 1;
    for (let part = 0; part < 9; part += 1) normal[at + part] = found[part % 3] / size;
  }
}
