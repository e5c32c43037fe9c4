"""Creates roofs over the walls of the top level."""
from __future__ import annotations

import math
from typing import Any, List, Optional, Sequence, Tuple

from ..description.shapes import Box, Geometry, Polyline
from ..geometry import IDENTITY, Pose, Vec3, quat_from_rpy
from .building_plan import Level, Plan, Roof
from .rectangles import is_rectilinear, rectangles

Parts = List[Tuple[Geometry, Pose]]


def roof_parts(plan: Plan) -> Optional[Tuple[Vec3, float, Parts]]:
    """The roof's position and yaw in the plan frame, and its solids; None without walls.

    A flat roof is a slab over the outer outline of the walls. A gable roof has two slopes over the
    smallest rectangle around it, and walls in the gables. Both are on top of the highest wall.
    """
    level, base = next(((level, base) for level, base in
                        reversed(list(zip(plan.levels, plan.bases()))) if level.walls),
                       (None, 0.0))
    if plan.roof is None or level is None:
        return None
    top = base + max(wall.height for wall in level.walls)
    covered = _covered(level)
    if plan.roof.kind == "gable":
        return _gable(covered, plan.roof, top, max(wall.thickness for wall in level.walls))
    return _flat(covered, plan.roof, top)


def _covered(level: Level) -> Any:
    """The area below and between the walls (a shapely polygon or several)."""
    import shapely
    from shapely.geometry import LineString, Polygon

    walls = [LineString([wall.start, wall.end]).buffer(wall.thickness / 2, cap_style="square",
                                                       join_style="mitre")
             for wall in level.walls]
    union = shapely.union_all(walls, grid_size=1e-6)
    parts = getattr(union, "geoms", [union])
    return shapely.union_all([Polygon(part.exterior) for part in parts])


def _flat(covered: Any, roof: Roof, top: float) -> Tuple[Vec3, float, Parts]:
    shape = covered.buffer(roof.overhang, join_style="mitre") if roof.overhang else covered
    x0, y0, x1, y1 = shape.bounds
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    parts: Parts = []
    for part in getattr(shape, "geoms", [shape]):
        loop = [(round(x - middle[0], 6), round(y - middle[1], 6))
                for x, y in list(part.simplify(1e-6).exterior.coords)[:-1]]
        if is_rectilinear(loop):
            parts += [(Box((_mm(c - a), _mm(d - b), roof.thickness)),
                       Pose((_mm((a + c) / 2), _mm((b + d) / 2), roof.thickness / 2)))
                      for a, b, c, d in rectangles(loop, [])]
        else:
            parts.append((Polyline([loop], roof.thickness), IDENTITY))
    return (middle[0], middle[1], top), 0.0, parts


def _gable(covered: Any, roof: Roof, top: float, thickness: float) -> Tuple[Vec3, float, Parts]:
    """In the roof frame the ridge is along x, and z = 0 is the top of the walls."""
    corners = list(covered.minimum_rotated_rectangle.exterior.coords)
    first, second = _edge(corners, 0), _edge(corners, 1)
    long, short = (first, second) if _length(first) >= _length(second) else (second, first)
    yaw = math.remainder(math.atan2(long[1], long[0]), math.pi)
    length, half = _length(long), _length(short) / 2
    rise = half * math.tan(roof.pitch)
    cos, sin = math.cos(roof.pitch), math.sin(roof.pitch)
    # The lower face of a slope contains the upper edge of the walls and the ridge.
    slope = (half + roof.overhang) / cos
    parts: Parts = []
    for side in (-1.0, 1.0):
        across = side * ((half + roof.overhang) / 2 + sin * roof.thickness / 2)
        height = rise / 2 - roof.overhang * math.tan(roof.pitch) / 2 + cos * roof.thickness / 2
        parts.append((Box((_mm(length + 2 * roof.overhang), _mm(slope), roof.thickness)),
                      Pose((0.0, _mm(across), _mm(height)),
                           quat_from_rpy(-side * roof.pitch, 0.0, 0.0))))
    # Extruded along the gable wall's own z, which is rotated to the direction of the ridge.
    triangle = [(_mm(-half), 0.0), (_mm(half), 0.0), (0.0, _mm(rise))]
    for x in (-length / 2, length / 2 - thickness):
        parts.append((Polyline([triangle], thickness),
                      Pose((_mm(x), 0.0, 0.0), quat_from_rpy(math.pi / 2, 0.0, math.pi / 2))))
    middle = covered.minimum_rotated_rectangle.centroid
    return (middle.x, middle.y, top), yaw, parts


def _edge(corners: Sequence[Tuple[float, float]], at: int) -> Tuple[float, float]:
    return (corners[at + 1][0] - corners[at][0], corners[at + 1][1] - corners[at][1])


def _length(edge: Tuple[float, float]) -> float:
    return math.hypot(*edge)


def _mm(value: float) -> float:
    """Round to 0.001 mm, the accuracy of the geometry library."""
    return round(value, 6) + 0.0
