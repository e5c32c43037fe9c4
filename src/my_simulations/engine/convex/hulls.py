"""Convex hulls of meshes; tests for convex and flat meshes."""
from __future__ import annotations

import itertools
from typing import Any, List, NamedTuple, Optional

import numpy as np

MOST_VERTICES = 256
"""Most corners of a convex mesh; the parts of several share them, down to `PART_VERTICES` each.

In contacts each takes time. 60 ball meshes in a heap take 3.0, 5.1, 7.7 and 17 ms a step with 64,
128, 256 and 512 corners, ten that roll 18, 19, 20 and 24 us (measured once).
"""

PART_VERTICES = 64
"""Corners that each of several parts may keep."""

_SAME_VOLUME = 0.02  # missing share of its hull: V-HACD's own error
_SAME_AREA = 0.02    # share of the hull's area that may be open
_ON_HULL = 1e-4      # tolerance to lie on a face of the hull, per metre of extent
_MOST_PAIRS = 4e6    # of faces and hull planes that are compared
_FLAT = 1e-4         # thickness per metre of extent below which a mesh has no volume
_PROJECTIONS = 50    # onto one face of a hull after the other
_SHORT = 0.03        # of the extent
_VOXEL = 0.02        # of the longest extent, about V-HACD's at this resolution
_MOST_PIECES = 64    # more separate pieces are merged


def clean_mesh(vertices: Any, triangles: Any) -> Any:
    """A `trimesh.Trimesh` with merged equal vertices, without degenerate triangles."""
    import trimesh

    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.merge_vertices()
    mesh.update_faces(mesh.nondegenerate_faces(height=1e-9))
    mesh.update_faces(mesh.unique_faces())
    mesh.remove_unreferenced_vertices()
    return mesh


class Hull(NamedTuple):
    """A convex solid.

    Attributes:
        vertices: float64 (n, 3).
        faces: int32 (m, 3), counter-clockwise from outside.
        planes: float64 (m, 4): outward normal and offset of each face.
        volume: cubic units of the vertices.
    """

    vertices: Any
    faces: Any
    planes: Any
    volume: float


def full_hull(points: Any) -> Hull:
    """The convex hull of points (n, 3) that are not coplanar."""
    # Not trimesh's, which orients faces with networkx; Qhull gives their orientation.
    from scipy.spatial import ConvexHull

    points = np.asarray(points, dtype=np.float64)
    try:
        found = ConvexHull(points, qhull_options="Pp Qt")
    except RuntimeError:  # nearly flat: let Qhull joggle the points by its rounding error
        found = ConvexHull(points, qhull_options="Pp QJ")
    corners = found.points[found.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", normals, found.equations[:, :3]) < 0
    simplices = np.where(inward[:, None], found.simplices[:, ::-1], found.simplices)
    kept, faces = np.unique(simplices, return_inverse=True)
    return Hull(found.points[kept], faces.reshape(-1, 3).astype(np.int32), found.equations,
                float(found.volume))


def hull_of(points: Any, most: int = MOST_VERTICES) -> Hull:
    """The convex hull of points (n, 3), reduced to at most `most` corners.

    A larger hull begins with its extreme points along the axes, and gets the corners that are
    farthest outside of what it has, so that it is inside the exact one, has the same bounding box,
    and the rims of round shapes keep their corners first.
    """
    hull = full_hull(points)
    if len(hull.vertices) <= most:
        return hull
    corners = hull.vertices
    diagonals = list(itertools.product((-1.0, 1.0), repeat=3))
    directions = np.concatenate([np.eye(3), -np.eye(3), diagonals])
    kept = np.unique((corners @ directions.T).argmax(axis=0))
    while len(kept) < most:
        # The farthest beyond each face, as Quickhull does; the worst of them while there is room.
        planes = full_hull(corners[kept]).planes
        beyond = corners @ planes[:, :3].T + planes[:, 3]
        found = np.unique(beyond.argmax(axis=0))
        found = found[~np.isin(found, kept)]
        if not len(found):
            break
        found = found[np.argsort(-beyond[found].max(axis=1), kind="stable")]
        kept = np.concatenate([kept, found[:most - len(kept)]])
    return full_hull(corners[np.sort(kept)])


def is_flat(points: Any) -> bool:
    """Whether points are coplanar, collinear or equal."""
    _, spans = _principal(points)
    return bool(spans[-1] <= _FLAT * max(spans[0], 1e-12))


def thicken_points(points: Any, thickness: float) -> Hull:
    """The hull of flat points, extended to a thickness of at least `thickness` m."""
    points = np.asarray(points, dtype=np.float64)
    axes, spans = _principal(points)
    for axis, span in zip(axes, spans):
        if span < thickness:
            shift = axis * ((thickness - span) / 2)
            points = np.concatenate([points - shift, points + shift])
    return hull_of(points)


def _principal(points: Any) -> Any:
    """(principal axes as rows, extents along them), longest first."""
    points = np.asarray(points, dtype=np.float64)
    centred = points - points.mean(axis=0)
    axes = np.linalg.eigh(centred.T @ centred)[1].T
    along = centred @ axes.T
    spans = along.max(axis=0) - along.min(axis=0)
    order = np.argsort(-spans)
    return axes[order], spans[order]


def is_convex(mesh: Any) -> bool:
    """Whether a mesh fills its convex hull except for 2 % of the volume.

    A mesh with openings is convex if it covers every face of its hull, such as a box whose faces do
    not exactly share their corners.
    """
    if is_flat(mesh.vertices):
        return False
    hull = full_hull(mesh.vertices)
    if mesh.is_watertight:
        return abs(hull.volume - abs(float(mesh.volume))) <= _SAME_VOLUME * hull.volume
    return _covers(mesh, hull)


def _covers(mesh: Any, hull: Hull) -> bool:
    """Whether the triangles of a mesh on a hull cover nearly all of it."""
    planes, face_of = np.unique(np.round(hull.planes, 6), axis=0, return_inverse=True)
    if len(planes) * len(mesh.faces) > _MOST_PAIRS:
        return False
    hull_areas = np.bincount(face_of.reshape(-1), _areas(hull.vertices[hull.faces]), len(planes))
    reach = float(np.ptp(mesh.vertices, axis=0).max())
    is_on = np.abs(mesh.vertices @ planes[:, :3].T + planes[:, 3]) <= _ON_HULL * reach
    faces = mesh.faces[is_on.any(axis=1)[mesh.faces].all(axis=1)]
    covered = is_on[faces].all(axis=1).T @ _areas(mesh.vertices[faces])
    open_area = np.maximum(hull_areas - covered, 0.0).sum()
    return bool(open_area <= _SAME_AREA * hull_areas.sum())


def _areas(corners: Any) -> Any:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.linalg.norm(normals, axis=1) / 2.0


def convex_pieces(mesh: Any) -> Optional[List[Hull]]:
    """The hulls of a mesh's separate pieces, if all are convex, such as a table of boxes.

    Those inside of another one are left out, such as the inner side of a closed shell: V-HACD fills
    closed shells, too, and no body can get inside.
    """
    from trimesh.graph import connected_components

    groups = connected_components(mesh.face_adjacency, nodes=np.arange(len(mesh.faces)))
    if not 1 < len(groups) <= _MOST_PIECES:
        return None
    found = {}
    for n in sorted(range(len(groups)), key=lambda n: len(groups[n])):  # cheap tests come first
        found[n] = clean_mesh(mesh.vertices, mesh.faces[groups[n]])
        if not is_convex(found[n]):
            return None
    outer = _not_inside([full_hull(found[n].vertices) for n in sorted(found)])
    most = max(PART_VERTICES, MOST_VERTICES // len(outer))
    return [hull_of(hull.vertices, most) for hull in outer]


def _not_inside(hulls: List[Hull]) -> List[Hull]:
    """Hulls without those that lie in a larger one, in their order."""
    kept: List[int] = []
    for n in sorted(range(len(hulls)), key=lambda n: -hulls[n].volume):
        points = hulls[n].vertices
        if not any((points @ hulls[k].planes[:, :3].T + hulls[k].planes[:, 3]).max() <= 0.0
                   for k in kept):
            kept.append(n)
    return [hulls[n] for n in sorted(kept)]


def moved_onto_hull(points: Any, hull: Hull) -> Any:
    """Move points outside of a hull onto it: V-HACD's parts protrude by half a voxel."""
    normals, offsets = hull.planes[:, :3], hull.planes[:, 3]
    moved = np.array(points, dtype=np.float64)
    for _ in range(_PROJECTIONS):
        outside = moved @ normals.T + offsets
        worst = outside.argmax(axis=1)
        excess = np.maximum(outside[np.arange(len(moved)), worst], 0.0)
        moved -= normals[worst] * excess[:, None]
        if excess.max() < 1e-9:
            break
    return moved


def stretch_parts(parts: List[Any], points: Any) -> List[Any]:
    """Scale parts so that their common bounding box is that of `points`.

    V-HACD's parts are also slightly smaller than the mesh, so bodies on them would sink in. Along
    an axis where they are much smaller, a part is missing, and nothing is changed.
    """
    together = np.concatenate(parts)
    low, high = together.min(axis=0), together.max(axis=0)
    true_low, true_high = points.min(axis=0), points.max(axis=0)
    reach = true_high - true_low
    allowed = np.maximum(_SHORT * reach, _VOXEL * reach.max())
    short = np.maximum(abs(low - true_low), abs(high - true_high)) > allowed
    factor = np.where(short, 1.0, reach / np.where(high > low, high - low, 1.0))
    return [np.where(short, part, true_low + (part - low) * factor) for part in parts]
