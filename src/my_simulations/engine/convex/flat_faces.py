"""Find the flat faces of a mesh that consist of rectangles.

A body that slides over a flat face of triangles collides with each inner edge as if it were free.
It loses speed and is lifted. A box in place of the triangles has no such edges.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, NamedTuple, Optional, Tuple

import numpy as np

from ...description.shapes import MeshData

Array = Any  # a NumPy array; its shape is documented at each use

_SAME_PLACE = 1e-6    # of the extent: corners that are nearer are one
_SAME_NORMAL = 1e-5   # 1 - cosine between the normals of neighbours in one plane
_BENT = 0.94          # cosine of 20 degrees: what bends less is a round surface, or a terrain
_WIDE = 0.5           # m: a face in such a surface must be that wide
_OFF_PLANE = 1e-4     # m: how uneven a flat face may be, and how far its edges may bend
_SAME_AREA = 1e-4     # share by which the triangles may miss or overlap the rectangles
_ONE_PLANE = 1.1e-3   # m between two faces that may be both sides of one
_NARROW = 0.01        # m: a face with a narrower rectangle stays as it is
_SMALL = 0.03         # m: the edge of a square; smaller ones are left out
_MOST_CELLS = 400     # of the grid that the edges of one face span
_MOST_TESTS = 2e6     # of cells against triangles
_MOST = 256           # faces of a mesh, the largest ones
_PER_EDGE = 4         # faces that may share an edge


class Rectangle(NamedTuple):
    """A flat rectangle, in the frame of the mesh.

    Attributes:
        centre: of its middle, m.
        axes: rows: along its first edge, along the second, outward normal.
        size: length of both edges, m.
        from_both: faces in its plane have opposite normals, so that its own is arbitrary.
    """

    centre: Array
    axes: Array
    size: Tuple[float, float]
    from_both: bool = False


@dataclass(frozen=True)
class FlatFaces:
    """The flat faces of a mesh, and the rest of it.

    Attributes:
        rectangles: the rectangles of its flat faces.
        rest: its other triangles; None if there are none.
    """

    rectangles: List[Rectangle]
    rest: Optional[MeshData]


def flat_faces(mesh: MeshData) -> FlatFaces:
    """Take the flat faces that are rectangles, or made of such, from a mesh.

    Faces count by the side that their triangles' order of corners tells, so that a sheet with two
    sides has two. Where some in a plane look to one side and some to the other, as exporters leave
    them, all say so. A triangle alone is never a face: it has no inner edges.
    """
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    triangles = np.asarray(mesh.triangles)
    if not len(triangles):
        return FlatFaces([], mesh)
    points, faces = _merge_corners(vertices, triangles)
    corners = points[faces]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(crosses, axis=1) / 2.0
    faced: List[List[Rectangle]] = []
    taken = np.zeros(len(faces), dtype=bool)
    groups, bent = _candidates(points, faces, crosses, areas)
    for members in groups:
        found = _as_rectangles(points, faces[members], crosses[members])
        least = min((min(each.size) for each in found), default=0.0)
        if least >= (_WIDE if bent[members].any() else _NARROW):
            faced.append(found)
            taken[members] = True
    rectangles = [one._replace(from_both=both) for found, both in zip(faced, _from_both(faced))
                  for one in found]
    if not rectangles:
        return FlatFaces([], mesh)
    left = triangles[~taken & (areas > 0.0)]
    if not len(left):
        return FlatFaces(rectangles, None)
    used, numbers = np.unique(left, return_inverse=True)
    return FlatFaces(rectangles, MeshData(
        vertices[used], numbers.reshape(-1, 3).astype(np.int32)))


def _merge_corners(vertices: Array, triangles: Array) -> Tuple[Array, Array]:
    """Points and triangles in which corners at one place are one."""
    extent = float(np.ptp(vertices, axis=0).max()) or 1.0
    _, first, same = np.unique(np.round(vertices / (_SAME_PLACE * extent)), axis=0,
                               return_index=True, return_inverse=True)
    return vertices[first], same.reshape(-1)[triangles]


def _candidates(points: Array, faces: Array, crosses: Array,
                areas: Array) -> Tuple[List[Array], Array]:
    """Groups of triangles that share edges and lie in one plane, the largest first.

    Also returns which triangles have a neighbour that is bent a little against them.
    """
    solid = areas > 1e-12 * max(float(areas.max()), 1e-300)
    normals = crosses / np.where(solid, 2.0 * areas, 1.0)[:, None]
    one, other = _neighbours(faces)
    cosines = np.einsum("ij,ij->i", normals[one], normals[other])
    level = solid[one] & solid[other] & (cosines > 1.0 - _SAME_NORMAL)
    bent = np.zeros(len(faces), dtype=bool)
    little = ~level & (cosines > _BENT)
    bent[one[little]] = bent[other[little]] = True
    one, other = one[level], other[level]
    away = np.einsum("ijk,ik->ij", points[faces[other]] - points[faces[one, 0]][:, None],
                     normals[one])
    level = np.abs(away).max(axis=1, initial=0.0) <= _OFF_PLANE
    groups = _label_groups(len(faces), one[level], other[level])
    order = np.argsort(groups, kind="stable")
    starts = np.flatnonzero(np.diff(groups[order], prepend=-1))
    sizes = np.diff(np.append(starts, len(order)))
    sums = np.add.reduceat(areas[order], starts)
    least = np.where(np.logical_or.reduceat(bent[order], starts), _WIDE, _SMALL)
    wanted = np.flatnonzero((sizes > 1) & (sums >= least * least))
    wanted = wanted[np.argsort(-sums[wanted], kind="stable")][:_MOST]
    return [order[starts[n]:starts[n] + sizes[n]] for n in wanted.tolist()], bent


def _neighbours(faces: Array) -> Tuple[Array, Array]:
    """The numbers of triangles that share an edge, in pairs."""
    edges, owners = _edges(faces)
    keys = _keys(edges)
    order = np.argsort(keys, kind="stable")
    keys, owners = keys[order], owners[order]
    pairs = []
    for step in range(1, _PER_EDGE):
        at = np.flatnonzero(keys[step:] == keys[:-step])
        pairs.append((owners[at], owners[at + step]))
    return np.concatenate([a for a, _ in pairs]), np.concatenate([b for _, b in pairs])


def _keys(edges: Array) -> Array:
    """Numbers that are equal for equal edges."""
    found: Array = edges[:, 0].astype(np.int64) * (int(edges.max()) + 1) + edges[:, 1]
    return found


def _edges(faces: Array) -> Tuple[Array, Array]:
    """The edges of triangles as sorted pairs of corners, and the triangles they belong to."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return edges, np.tile(np.arange(len(faces)), 3)


def _label_groups(count: int, one: Array, other: Array) -> Array:
    """For each of `count` things the lowest number among those that pairs connect it with."""
    labels = np.arange(count)
    while True:
        lowest = np.minimum(labels[one], labels[other])
        before = labels.copy()
        np.minimum.at(labels, before[one], lowest)
        np.minimum.at(labels, before[other], lowest)
        np.minimum.at(labels, one, lowest)
        np.minimum.at(labels, other, lowest)
        labels = labels[labels]
        if np.array_equal(labels, before):
            return labels


def _as_rectangles(points: Array, faces: Array, crosses: Array) -> List[Rectangle]:
    """The rectangles that make up a flat face; none if its edges are not all square."""
    normal = crosses.sum(axis=0)
    normal = normal / np.linalg.norm(normal)
    heights = points[faces] @ normal
    if heights.max() - heights.min() > 2.0 * _OFF_PLANE:
        return []
    rim = _rim(faces)
    if not len(rim):
        return []
    ways = points[rim[:, 1]] - points[rim[:, 0]]
    along = ways[(ways * ways).sum(axis=1).argmax()]
    along = along - normal * (along @ normal)
    along = along / np.linalg.norm(along)
    axes = np.stack([along, np.cross(normal, along), normal])
    ends = points[rim] @ axes[:2].T
    ways = np.abs(ends[:, 1] - ends[:, 0])
    if ways.min(axis=1).max() > _OFF_PLANE:
        return []
    height, area = float(heights.mean()), float(np.linalg.norm(crosses, axis=1).sum()) / 2.0
    low, high = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
    if abs(float((high - low).prod()) - area) <= _SAME_AREA * area:
        return [_rectangle(low, high, axes, height)]
    turns = np.intersect1d(rim[ways[:, 0] > ways[:, 1]], rim[ways[:, 0] <= ways[:, 1]])
    lines = [_lines(points[turns] @ axis) for axis in axes[:2]]
    cells = (len(lines[0]) - 1) * (len(lines[1]) - 1)
    if not 0 < cells <= _MOST_CELLS or cells * len(faces) > _MOST_TESTS:
        return []
    filled = _rasterise_triangles(points[faces] @ axes[:2].T, lines)
    sizes = np.outer(np.diff(lines[0]), np.diff(lines[1]))
    if abs(float(sizes[filled].sum()) - area) > _SAME_AREA * area:
        return []
    return [_rectangle(np.array([lines[0][top], lines[1][left]]),
                       np.array([lines[0][bottom], lines[1][right]]), axes, height)
            for top, bottom, left, right in _blocks(filled)]


def _rim(faces: Array) -> Array:
    """The edges that only one of the triangles has."""
    edges, _ = _edges(faces)
    _, first, counts = np.unique(_keys(edges), return_index=True, return_counts=True)
    found: Array = edges[first[counts == 1]]
    return found


def _from_both(faced: List[List[Rectangle]]) -> List[bool]:
    """For each face whether another one in its plane looks to the other side."""
    normals = np.array([found[0].axes[2] for found in faced]).reshape(-1, 3)
    heights = np.array([found[0].axes[2] @ found[0].centre for found in faced])
    against = normals @ normals.T < _SAME_NORMAL - 1.0
    both: List[bool] = (against & (np.abs(heights[:, None] + heights) < _ONE_PLANE)
                        ).any(axis=1).tolist()
    return both


def _lines(values: Array) -> Array:
    """The places of the lines of a grid through all values."""
    values = np.sort(values)
    found: Array = values[np.diff(values, prepend=-np.inf) > 2.0 * _OFF_PLANE]
    return found


def _rasterise_triangles(corners: Array, lines: List[Array]) -> Array:
    """Which cells of a grid triangles (n, 3, 2) cover, by their middles."""
    middles = [(line[1:] + line[:-1]) / 2.0 for line in lines]
    x, y = (each.reshape(-1)[:, None] for each in np.meshgrid(*middles, indexing="ij"))
    inside = np.ones((len(x), len(corners)), dtype=bool)
    for n in range(3):
        start, end = corners[:, n], corners[:, (n + 1) % 3]
        inside &= ((end[:, 0] - start[:, 0]) * (y - start[:, 1])
                   - (end[:, 1] - start[:, 1]) * (x - start[:, 0])) >= 0.0
    covered: Array = inside.any(axis=1).reshape(len(middles[0]), len(middles[1]))
    return covered


def _blocks(filled: Array) -> List[Tuple[int, int, int, int]]:
    """Rectangles of filled cells as (first, last + 1) of rows and columns, few and large ones."""
    left = filled.copy()
    found = []
    while left.any():
        row, column = (int(one) for one in np.argwhere(left)[0])
        options = []
        for turned in (False, True):
            cells = left[row:, column:].T if turned else left[row:, column:]
            width = int(np.argmin(np.append(cells[0], False)))
            height = int(np.argmin(np.append(cells[:, :width].all(axis=1), False)))
            options.append((width, height) if turned else (height, width))
        rows, columns = max(options, key=lambda size: size[0] * size[1])
        left[row:row + rows, column:column + columns] = False
        found.append((row, row + rows, column, column + columns))
    return found


def _rectangle(low: Array, high: Array, axes: Array, height: float) -> Rectangle:
    x, y = ((low + high) / 2.0).tolist()
    width, length = (high - low).tolist()
    return Rectangle(x * axes[0] + y * axes[1] + height * axes[2], axes, (width, length))
