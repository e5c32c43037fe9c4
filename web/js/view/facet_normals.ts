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
    const [x, y, z] = [position[at], position[at + 1], position[at + 2]];
    const [ax, ay, az] = [position[at + 3] - x, position[at + 4] - y, position[at + 5] - z];
    const [bx, by, bz] = [position[at + 6] - x, position[at + 7] - y, position[at + 8] - z];
    const [nx, ny, nz] = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    const size = Math.sqrt(nx * nx + ny * ny + nz * nz) || 1;
    for (let corner = at; corner < at + 9; corner += 3) {
      normal[corner] = nx / size;
      normal[corner + 1] = ny / size;
      normal[corner + 2] = nz / size;
    }
  }
}
