/** Moments of inertia as a picture: the solid box that has the same. */

const SWEEPS = 12;

/**
 * Principal moments and axes of a symmetric 3x3 matrix, by Jacobi's rotations.
 * @returns vectors[i]: unit, belongs to values[i];
 * right-handed
 */
export function principal(matrix: number[][]): {values: number[], vectors: number[][]} {
  const a = matrix.map((row) => [...row]);
  const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < SWEEPS; sweep++) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (Math.abs(a[p][q]) < 1e-30) continue;
      const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.hypot(theta, 1));
      const c = 1 / Math.hypot(t, 1);
      turn(a, v, p, q, c, t * c);
    }
  }
  const vectors = [0, 1, 2].map((column) => v.map((row) => row[column]));
  return {values: [a[0][0], a[1][1], a[2][2]], vectors};
}

function turn(a: number[][], v: number[][], p: number, q: number, c: number, s: number) {
  for (let k = 0; k < 3; k++) {
    [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
  }
  for (let k = 0; k < 3; k++) {
    [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
    [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
  }
}

/**
 * The box of even density with a body's mass and moments.
 * @param inertial  kg, kg m^2 about the centre of mass
 * @returns edges in m along the principal axes; null
 * without mass
 */
export function equivalentBox({mass, ixx, ixy, ixz, iyy, iyz, izz}: {mass: number, ixx: number,
    ixy: number, ixz: number, iyy: number, iyz: number,
    izz: number}): {size: number[], vectors: number[][]}|null {
  if (!(mass > 0)) return null;
  const {values: [a, b, c], vectors} =
    principal([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]);
  const edge = (one: number, other: number, own: number) =>
      Math.sqrt(Math.max(6 * (one + other - own) / mass, 0));
  return {size: [edge(b, c, a), edge(a, c, b), edge(a, b, c)], vectors};
}
