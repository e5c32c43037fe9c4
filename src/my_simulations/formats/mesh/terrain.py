"""Makes collision meshes of heightmaps, map images and extruded polygons."""
from __future__ import annotations

import functools
import os
from typing import Any, Dict, List, Sequence, Tuple, Union

from ...description.shapes import Heightmap, ImageMap, MeshData, Polyline
from ...errors import InputError, error
from ...geometry import Vec3
from ..image.levels import Elevations, grey_levels, read_elevations
from .polygons import Point, convex_pieces, orient_loops, signed_area, triangulate

Solid = Union[Heightmap, ImageMap, Polyline]

_MOST_POINTS = 2000
_MOST_BOXES = 20000
_WIDEST = 1025
"""Most vertices along a side of a terrain; larger images are sampled."""


def solid_mesh(solid: Solid) -> MeshData:
    """The triangles of a heightmap, a map image or a polyline.

    In metres, in the frame of the collision; the arrays are shared between calls and read-only. A
    heightmap is a surface, so it can only be static. Polylines and map images have convex parts.
    Raises InputError: with one issue: `image-not-found`, `image-unreadable`, `solid-complex` (too
    many points or boxes), `solid-empty` (nothing that could collide).
    """
    if isinstance(solid, Polyline):
        return _extrude_polyline(solid)
    try:
        changed = os.stat(solid.path).st_mtime_ns
    except OSError:
        raise _fault("image-not-found", f"the image {solid.uri!r} was not found",
                     solid.path) from None
    if isinstance(solid, Heightmap):
        return _terrain(solid.path, changed, solid.size, solid.position, solid.sampling)
    return _plan(solid.path, changed, solid.scale, solid.threshold, solid.height, solid.granularity)


def _fault(code: str, message: str, path: str = "", hint: str = "") -> InputError:
    return InputError([error(code, message, file=path, hint=hint)])


def _data(vertices: Any, triangles: Any) -> MeshData:
    import numpy as np

    vertices = np.ascontiguousarray(vertices, dtype=np.float64)
    triangles = np.ascontiguousarray(triangles, dtype=np.int32)
    vertices.flags.writeable = triangles.flags.writeable = False
    return MeshData(vertices, triangles)


@functools.lru_cache(maxsize=8)
def _terrain(path: str, changed: int, size: Tuple[float, float, float],
             position: Tuple[float, float, float], sampling: int) -> MeshData:
    """Black is at `position`, white `size[2]` above it; the image's top row is at +y.

    A negative height inverts the levels. The lowest point of an elevation model is at its height
    in the file above `position`, the highest `size[2]` above that; without a size, extent and
    heights are those of the file. Source: SDF spec, heightmap, and Gazebo behaviour.
    """
    import numpy as np

    model = read_elevations(path, _WIDEST)
    if model is not None:
        levels, size = _to_scale(model, size)
    else:
        grey = grey_levels(path, _WIDEST)
        levels = grey.values / grey.white
        levels = 1.0 - levels if size[2] < 0 else levels
    if min(levels.shape) < 2:
        raise _fault("solid-empty", "a terrain needs an image of at least 2 by 2 pixels", path)
    levels = _refine_levels(levels, sampling)[::-1]
    rows, columns = levels.shape
    x = np.linspace(-size[0] / 2, size[0] / 2, columns)
    y = np.linspace(-size[1] / 2, size[1] / 2, rows)
    grid = np.stack([np.broadcast_to(x, (rows, columns)),
                     np.broadcast_to(y[:, None], (rows, columns)), levels * abs(size[2])], axis=-1)
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    triangles = np.concatenate([np.stack(corner, axis=-1).reshape(-1, 3)
                                for corner in ((a, b, d), (a, d, c))])
    return _data(grid.reshape(-1, 3) + np.array(position), triangles)


def _to_scale(model: Elevations, size: Vec3) -> Tuple[Any, Vec3]:
    """Heights scaled for the collision (m), and its extent with height 1."""
    low, high = model.lowest, model.highest
    if size == Heightmap().size:
        x, y = model.extent or (float(model.shape[1]), float(model.shape[0]))
        return model.heights, (x, y, 1.0)
    factor = abs(size[2]) / (high - low) if high > low else 1.0
    heights = low + (model.heights - low) * factor
    return (-heights if size[2] < 0 else heights), (size[0], size[1], 1.0)


def _refine_levels(levels: Any, sampling: int) -> Any:
    """Insert linearly interpolated points, up to the largest terrain size."""
    import numpy as np

    while sampling > 1 and (max(levels.shape) - 1) * sampling > _WIDEST // 2:
        sampling //= 2
    if sampling <= 1:
        return levels
    for _ in range(2):
        count = len(levels)
        at = np.arange(count * sampling - sampling + 1) / sampling
        low = np.minimum(at.astype(int), count - 2)
        part = (at - low)[:, None]
        levels = (levels[low] * (1 - part) + levels[low + 1] * part).T
    return levels


@functools.lru_cache(maxsize=8)
def _plan(path: str, changed: int, scale: float, threshold: int, height: float,
          granularity: int) -> MeshData:
    """Boxes on z = 0 for dark pixels, centred on the origin; the image's top row is at +y."""
    grey = grey_levels(path, step=granularity)
    dark = grey.values[::-1] < threshold * (grey.white / 255.0)
    boxes = _rectangles(dark)
    if not boxes:
        raise _fault("solid-empty", f"no pixel of the map is darker than {threshold}", path)
    if len(boxes) > _MOST_BOXES:
        raise _fault("solid-complex", f"the map becomes {len(boxes)} boxes; {_MOST_BOXES} are"
                     " possible", path, "use a larger granularity")
    cell = scale * granularity
    middle_x, middle_y = dark.shape[1] * cell / 2, dark.shape[0] * cell / 2
    prisms = []
    for left, bottom, right, top in boxes:
        west, east = left * cell - middle_x, right * cell - middle_x
        south, north = bottom * cell - middle_y, top * cell - middle_y
        corners = [(west, south), (east, south), (east, north), (west, north)]
        prisms.append(_prism(corners, [(0, 1, 2), (0, 2, 3)], [corners], height))
    return _together(prisms)


def _rectangles(dark: Any) -> List[Tuple[int, int, int, int]]:
    """Rectangles (left, bottom, right, top) in cells: runs of each row, merged over equal rows."""
    import numpy as np

    found: List[Tuple[int, int, int, int]] = []
    growing: Dict[Tuple[int, int], int] = {}
    for row in range(dark.shape[0] + 1):
        runs = set()
        if row < dark.shape[0]:
            edges = np.flatnonzero(np.diff(np.concatenate([[0], dark[row].astype(np.int8), [0]])))
            runs = {(int(a), int(b)) for a, b in edges.reshape(-1, 2)}
        for run in [run for run in growing if run not in runs]:
            found.append((run[0], growing.pop(run), run[1], row))
        for run in runs:
            growing.setdefault(run, row)
    return sorted(found)


def _extrude_polyline(polyline: Polyline) -> MeshData:
    if sum(len(loop) for loop in polyline.loops) > _MOST_POINTS:
        raise _fault("solid-complex", f"a polyline may have {_MOST_POINTS} points in all")
    loops = orient_loops([loop for loop in map(_distinct, polyline.loops) if len(loop) >= 3])
    if not loops or abs(signed_area(loops[0])) < 1e-12:
        raise _fault("solid-empty", "the polyline encloses no area")
    points, triangles = triangulate(loops)
    if not triangles:
        raise _fault("solid-empty", "the polyline encloses no area")
    whole = _prism(points, triangles, loops, polyline.height)
    parts = []
    for piece in convex_pieces(points, triangles):
        corners = [points[i] for i in piece]
        fan = [(0, k, k + 1) for k in range(1, len(corners) - 1)]
        parts.append(_prism(corners, fan, [corners], polyline.height))
    whole.parts = parts
    return whole


def _distinct(loop: Sequence[Point]) -> List[Point]:
    return [point for k, point in enumerate(loop) if point != loop[k - 1]]


def _prism(points: Sequence[Point], triangles: Sequence[Tuple[int, int, int]],
           loops: Sequence[Sequence[Point]], height: float) -> MeshData:
    """Extrude a flat shape from z = 0 to `height`; `loops` are its borders, interior left."""
    count = len(points)
    vertices = [(x, y, z) for z in (0.0, height) for x, y in points]
    faces = [(a, c, b) for a, b, c in triangles]
    faces += [(a + count, b + count, c + count) for a, b, c in triangles]
    first = 0
    for loop in loops:
        ring = range(first, first + len(loop))
        for a, b in zip(ring, [*ring[1:], ring[0]]):
            faces += [(a, b, b + count), (a, b + count, a + count)]
        first += len(loop)
    return _data(vertices, faces)


def _together(parts: List[MeshData]) -> MeshData:
    import numpy as np

    first = np.cumsum([0] + [len(part.vertices) for part in parts[:-1]])
    whole = _data(np.concatenate([part.vertices for part in parts]),
                  np.concatenate([part.triangles + at for part, at in zip(parts, first)]))
    whole.parts = parts
    return whole
