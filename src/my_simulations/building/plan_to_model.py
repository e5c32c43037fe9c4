"""Creates the model of a plan: one link for each item, with boxes around the openings.

Names, poses and shapes are those of Gazebo's building editor. Extensions: floors of any outline,
and roofs.
"""
from __future__ import annotations

import math
from typing import Any, Dict, List, Optional, Sequence, Tuple

from ..description.compare import BUILT_IN
from ..description.model import Link, Model
from ..description.picture_size import picture_size_xml
from ..description.shapes import Box, Collision, Geometry, Material, Polyline, Visual
from ..errors import InputError, errors_of
from ..geometry import IDENTITY, IDENTITY_QUAT, Pose, Vec3, quat_from_rpy
from .building_plan import Floor, Level, Opening, Plan, Point, Roof, Stairs, Wall
from .plan_check import check_plan
from .rectangles import Rectangle, is_rectilinear, loop_of, rectangles

Part = Tuple[Geometry, Pose]
"""A solid and its pose in the link frame."""

GREY = "Gazebo/Grey"
_PICTURE = 1.0
"""Edge of a texture, m: a brick is 25 cm long."""


def model_name(name: str) -> str:
    """The model name of a plan: spaces become `_` (Gazebo behaviour)."""
    return "_".join(name.split())


def building_model(plan: Plan) -> Model:
    """The static model of a plan.

    The model frame is at the centre of the plan's bounding box on the ground. Raises InputError:
    the plan has errors (see `check_plan`) or is empty.
    """
    faults = errors_of(check_plan(plan))
    if faults:
        raise InputError(faults)
    centre = centre_of(plan)
    links: List[Link] = []
    below: Optional[Level] = None
    for number, (level, base) in enumerate(zip(plan.levels, plan.bases())):
        maker = _Links(number, centre, base)
        openings = _by_wall(level)
        for wall in level.walls:
            maker.wall(wall, openings.get(wall.id, []))
        for kind, opening in level.openings():
            if opening.wall is None:
                maker.free_opening(kind, opening)
        for stairs in level.stairs:
            maker.stairs(stairs)
        for floor in level.floors:
            maker.floor(floor, below.stairs if below is not None else [])
        links += maker.links
        below = level
    if plan.roof is not None:
        maker = _Links(len(plan.levels) - 1, centre, 0.0)
        maker.roof(plan)
        links += maker.links
    return Model(model_name(plan.name), Pose((centre[0], centre[1], 0.0)), static=True,
                 links=links)


def centre_of(plan: Plan) -> Point:
    """The centre of the bounding box of all items; the origin for an empty plan."""
    points: List[Point] = []
    for level in plan.levels:
        for wall in level.walls:
            half = wall.thickness / 2
            for x, y in (wall.start, wall.end):
                points += [(x - half, y - half), (x + half, y + half)]
        points += [corner for stairs in level.stairs for corner in stairs.corners()]
        points += [corner for floor in level.floors for corner in floor.outline]
        points += [opening.position for _, opening in level.openings() if opening.wall is None]
    if not points:
        return (0.0, 0.0)
    xs, ys = zip(*points)
    return (_tidy((min(xs) + max(xs)) / 2), _tidy((min(ys) + max(ys)) / 2))


def wall_parts(wall: Wall, openings: Sequence[Opening]) -> List[Rectangle]:
    """The wall's vertical face without its openings, as rectangles.

    x is along the wall from its centre, y up from its base. The face is longer than the centre line
    by the thickness, so that walls overlap at corners without a gap.
    """
    half = (wall.length + wall.thickness) / 2
    holes = []
    for opening in openings:
        middle = opening.along - wall.length / 2
        holes.append((middle - opening.width / 2, opening.elevation, middle + opening.width / 2,
                      min(opening.elevation + opening.height, wall.height)))
    return rectangles(loop_of((-half, 0.0, half, wall.height)), [loop_of(h) for h in holes])


def floor_pieces(floor: Floor, stairs: Sequence[Stairs]) -> List[Tuple[List[Point],
                                                                       List[List[Point]]]]:
    """A floor without the footprints of the stairs from below, as outlines with holes."""
    from shapely.geometry import Polygon
    from shapely.geometry.polygon import orient

    shape: Any = Polygon(floor.outline, floor.holes)
    for flight in stairs:
        shape = shape.difference(Polygon(flight.corners()))
    found = [part for part in getattr(shape, "geoms", [shape])
             if part.geom_type == "Polygon" and part.area > 1e-6]
    return [([*_ring(part.exterior)], [_ring(hole) for hole in part.interiors])
            for part in map(orient, found)]


def _ring(ring: Any) -> List[Point]:
    return [(_tidy(x), _tidy(y)) for x, y in list(ring.coords)[:-1]]


def _tidy(value: float) -> float:
    """Round off errors of the last digits, and -0 to 0."""
    return round(value, 9) + 0.0


def _by_wall(level: Level) -> Dict[int, List[Opening]]:
    found: Dict[int, List[Opening]] = {}
    for _, opening in level.openings():
        if opening.wall is not None:
            found.setdefault(opening.wall, []).append(opening)
    return found


class _Links:
    """Creates the links of one level."""

    def __init__(self, layer: int, centre: Point, base: float) -> None:
        self.links: List[Link] = []
        self._layer = layer
        self._centre = centre
        self._base = base

    def wall(self, wall: Wall, openings: Sequence[Opening]) -> None:
        middle = ((wall.start[0] + wall.end[0]) / 2, (wall.start[1] + wall.end[1]) / 2)
        pieces = wall_parts(wall, openings)
        parts = [_upright(piece, wall.thickness) for piece in pieces]
        self._add(f"Wall_{wall.id}", self._pose(middle, self._base, wall.yaw), parts, wall.color,
                  wall.texture, numbered=bool(openings))

    def free_opening(self, kind: str, opening: Opening) -> None:
        size = (opening.width, opening.depth, opening.height)
        pose = self._pose(opening.position, self._base + opening.elevation, opening.yaw)
        self._add(f"{kind}_{opening.id}", pose, [(Box(size), Pose((0.0, 0.0, size[2] / 2)))],
                  "#ffffff", "")

    def stairs(self, stairs: Stairs) -> None:
        run, rise = stairs.depth / stairs.steps, stairs.height / stairs.steps
        parts: List[Part] = [
            (Box((stairs.width, _tidy(run), _tidy(rise))),
             Pose((0.0, _tidy(run * (step + 0.5)), _tidy(rise * (step + 0.5)))))
            for step in range(stairs.steps)]
        self._add(f"Stairs_{stairs.id}", self._pose(stairs.foot, self._base, stairs.yaw), parts,
                  stairs.color, stairs.texture, numbered=True)

    def floor(self, floor: Floor, stairs: Sequence[Stairs]) -> None:
        pieces = floor_pieces(floor, stairs)
        xs, ys = zip(*floor.outline)
        middle = (_tidy((min(xs) + max(xs)) / 2), _tidy((min(ys) + max(ys)) / 2))
        parts: List[Part] = []
        for outline, holes in pieces:
            loops = [[(_tidy(x - middle[0]), _tidy(y - middle[1])) for x, y in loop]
                     for loop in (outline, *holes)]
            parts += _slab(loops, floor.thickness)
        if parts:
            self._add(f"Floor_{floor.id}", self._pose(middle, self._base, 0.0), parts, floor.color,
                      floor.texture, numbered=len(parts) > 1)

    def roof(self, plan: Plan) -> None:
        assert plan.roof is not None
        found = roof_parts(plan)
        if found is not None:
            position, yaw, parts = found
            self._add("Roof_0", self._pose(position[:2], position[2], yaw), parts,
                      plan.roof.color, plan.roof.texture, numbered=len(parts) > 1)

    def _pose(self, at: Sequence[float], z: float, yaw: float) -> Pose:
        turn = quat_from_rpy(0.0, 0.0, yaw) if abs(yaw) > 1e-12 else IDENTITY_QUAT
        return Pose((_tidy(at[0] - self._centre[0]), _tidy(at[1] - self._centre[1]), _tidy(z)),
                    turn)

    def _add(self, name: str, pose: Pose, parts: Sequence[Part], color: str, texture: str,
             numbered: bool = False) -> None:
        link = Link(name, pose)
        for number, (geometry, at) in enumerate(parts):
            ending = f"_{number}" if numbered else ""
            link.collisions.append(Collision(f"{name}_Collision{ending}", geometry, at))
            link.visuals.append(Visual(f"{name}_Visual{ending}", geometry, at,
                                       _material(color, texture), layer=self._layer,
                                       extra=[picture_size_xml(_PICTURE)] if texture else []))
        self.links.append(link)


def _material(color: str, texture: str) -> Material:
    red, green, blue = (round(int(color[at:at + 2], 16) / 255, 6) for at in (1, 3, 5))
    shade = (red, green, blue, 1.0)
    return Material(ambient=shade, diffuse=None if texture or color == "#ffffff" else shade,
                    script_uris=[BUILT_IN], script_name=texture or GREY)


def _upright(piece: Rectangle, thickness: float) -> Part:
    x0, z0, x1, z1 = piece
    size: Vec3 = (_tidy(x1 - x0), thickness, _tidy(z1 - z0))
    return Box(size), Pose((_tidy((x0 + x1) / 2), 0.0, _tidy((z0 + z1) / 2)))


def _slab(loops: List[List[Point]], thickness: float) -> List[Part]:
    """Boxes for outlines with axis-aligned edges, else one extruded polygon."""
    if not all(map(is_rectilinear, loops)):
        return [(Polyline(loops, thickness), IDENTITY)]
    return [(Box((_tidy(x1 - x0), _tidy(y1 - y0), thickness)),
             Pose((_tidy((x0 + x1) / 2), _tidy((y0 + y1) / 2), thickness / 2)))
            for x0, y0, x1, y1 in rectangles(loops[0], loops[1:])]


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
    covered = _compute_floor_area(level)
    if plan.roof.kind == "gable":
        return _gable(covered, plan.roof, top, max(wall.thickness for wall in level.walls))
    return _flat(covered, plan.roof, top)


def _compute_floor_area(level: Level) -> Any:
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
