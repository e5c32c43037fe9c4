"""Derives a plan from a building's model, as written by Gazebo's building editor.

Walls, stairs, floors and free-standing openings are identified by their link names; openings in
walls by the gaps between the boxes of a wall. Source: Gazebo behaviour, building editor.
"""
from __future__ import annotations

import math
import re
from bisect import bisect_right
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

from ..description.model import Link, Model
from ..description.shapes import Box, Material, Polyline
from ..errors import InputError, Issue, error, warning
from ..geometry import Pose, Vec3, compose, rotate, rpy_from_quat, transform
from .building_plan import WHITE, Floor, Level, Opening, Plan, Point, Stairs, Wall
from .plan_json import COUNTERS
from .plan_to_model import GREY

_NAME = re.compile(r"(Wall|Window|Door|Stairs|Floor|Roof)_(\d+)\Z")

_OPENINGS = ("Window", "Door")

ROUGH = 1e-3
"""Tolerance of coinciding edges, m: Gazebo writes six digits."""


class _Block(NamedTuple):
    """A box in the link frame, by two opposite corners."""

    low: Vec3
    high: Vec3

    @property
    def middle(self) -> Vec3:
        a, b = self.low, self.high
        return ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2)

    @property
    def size(self) -> Vec3:
        a, b = self.low, self.high
        return (b[0] - a[0], b[1] - a[1], b[2] - a[2])


class _Item(NamedTuple):
    """A link of a building, with its parsed name and shapes."""

    kind: str
    id: int
    pose: Pose
    blocks: List[_Block]
    polygons: List[Polyline]
    color: str
    texture: str
    layer: Optional[int]

    @property
    def yaw(self) -> float:
        return rpy_from_quat(self.pose.orientation)[2]

    def at(self, x: float, y: float) -> Point:
        """A point of the link frame's x-y plane, in the plan frame."""
        placed = transform(self.pose, (x, y, 0.0))
        return (_round(placed[0]), _round(placed[1]))


def plan_from_model(model: Model, file: str = "") -> Tuple[Plan, List[Issue]]:
    """The plan of a building's model, and issues about parts that could not be derived.

    Positions are those in the world at the model pose of the file. Raises InputError: the model is
    not a building.
    """
    issues: List[Issue] = []
    items: List[_Item] = []
    for link in model.links:
        item = _item(link, model.pose)
        if item is None or item.kind == "Roof" or not (item.blocks or item.polygons):
            issues.append(warning("building-link-left-out", f"link {link.name!r} cannot be"
                                  " converted to the plan", file=file))
        else:
            items.append(item)
    if not items:
        raise InputError([error("building-unknown", f"model {model.name!r} has no links such as"
                                " Wall_0, Floor_0 or Stairs_0, from which a plan can be made",
                                file=file)])
    plan = Plan(model.name, _levels(items))
    _number(plan, items)
    return plan, issues


def _item(link: Link, model: Pose) -> Optional[_Item]:
    found = _NAME.match(link.name)
    if found is None:
        return None
    shapes = link.visuals or link.collisions
    visual = link.visuals[0] if link.visuals else None
    color, texture = _color_and_texture(visual.material if visual is not None else None)
    return _Item(found.group(1), int(found.group(2)), compose(model, link.pose),
                 [_block(shape.geometry, shape.pose) for shape in shapes
                  if isinstance(shape.geometry, Box)],
                 [shape.geometry for shape in shapes if isinstance(shape.geometry, Polyline)],
                 color, texture, visual.layer if visual is not None else None)


def _block(box: Box, pose: Pose) -> _Block:
    axes = [rotate(pose.orientation, axis)
            for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    half = [sum(abs(axis[k]) * size / 2 for axis, size in zip(axes, box.size)) for k in range(3)]
    x, y, z = pose.position
    return _Block((x - half[0], y - half[1], z - half[2]), (x + half[0], y + half[1], z + half[2]))


def _color_and_texture(material: Optional[Material]) -> Tuple[str, str]:
    if material is None:
        return WHITE, ""
    shade = material.ambient or (1.0, 1.0, 1.0, 1.0)
    color = "#" + "".join(f"{min(max(round(part * 255), 0), 255):02x}" for part in shade[:3])
    texture = material.script_name if material.script_name != GREY else ""
    return color, texture


def _levels(items: List[_Item]) -> List[Level]:
    """The items by level; a level's height is the distance to the base of the next one."""
    groups = _groups(items)
    levels: List[Level] = []
    for number, group in enumerate(groups):
        level = Level(f"Level {number + 1}")
        for item in group:
            _READERS[item.kind](level, item, _base(group))
        tallest = max((wall.height for wall in level.walls), default=level.height)
        above = _base(groups[number + 1]) - _base(group) if number + 1 < len(groups) else tallest
        level.height = _round(above)
        if levels:
            _fill_stair_holes(level, levels[-1].stairs)
        levels.append(level)
    return levels


def _groups(items: List[_Item]) -> List[List[_Item]]:
    """The items of each level, from the lowest; without a layer their heights tell them apart."""
    by_layer: Dict[Tuple[int, float], List[_Item]] = {}
    floating: List[_Item] = []
    for item in items:
        if item.layer is not None:
            by_layer.setdefault((item.layer, 0.0), []).append(item)
        elif item.kind in _OPENINGS:
            floating.append(item)
        else:
            by_layer.setdefault((0, round(item.pose.position[2], 2)), []).append(item)
    if not by_layer:
        return [floating]
    groups = sorted(by_layer.values(), key=_base)
    bases = [_base(group) for group in groups]
    for item in floating:  # its height is that of its level, and its own above it
        below = bisect_right(bases, item.pose.position[2] + ROUGH)
        groups[max(below - 1, 0)].append(item)
    return groups


def _base(group: List[_Item]) -> float:
    standing = [item for item in group if item.kind not in _OPENINGS]
    return min(item.pose.position[2] + (min((block.low[2] for block in item.blocks), default=0.0)
                                        if item.kind == "Wall" else 0.0)
               for item in standing or group)


def _wall(level: Level, item: _Item, base: float) -> None:
    x0, x1 = _span(item.blocks, 0)
    y0, y1 = _span(item.blocks, 1)
    thickness = _round(y1 - y0)
    half = (x1 - x0 - thickness) / 2
    if half <= 0:
        return
    middle, y = (x0 + x1) / 2, (y0 + y1) / 2
    height = _round(_span(item.blocks, 2)[1])
    wall = Wall(item.id, item.at(middle - half, y), item.at(middle + half, y), thickness, height,
                item.color, item.texture)
    level.walls.append(wall)
    for left, low, right, high in _gaps(item.blocks, height):
        width = _round(right - left)
        along = _round((left + right) / 2 - (middle - half))
        opening = Opening(-1, width, _round(high - low), _round(low), wall=wall.id, along=along)
        (level.doors if low < ROUGH else level.windows).append(opening)


def _gaps(blocks: List[_Block], height: float) -> Iterator[Tuple[float, float, float, float]]:
    """Gaps between the boxes of a wall, as rectangles of its face."""
    from shapely import set_precision, union_all
    from shapely.geometry import box

    from .rectangles import rectangles

    x0, x1 = _span(blocks, 0)
    there = union_all([box(b.low[0], b.low[2], b.high[0], b.high[2]) for b in blocks])
    face = box(x0, 0.0, x1, height)
    left = face.difference(there.buffer(ROUGH, join_style="mitre"))
    for part in getattr(left, "geoms", [left]):
        if part.is_empty:
            continue
        grown = set_precision(part.buffer(ROUGH, join_style="mitre").intersection(face),
                              ROUGH / 10)
        for gap in rectangles(list(grown.exterior.coords)[:-1],
                              [list(ring.coords)[:-1] for ring in grown.interiors]):
            if min(gap[2] - gap[0], gap[3] - gap[1]) > 2 * ROUGH:
                yield gap


def _free_opening(level: Level, item: _Item, base: float) -> None:
    block = item.blocks[0]
    low = item.pose.position[2] + block.low[2] - base
    made = Opening(item.id, _round(block.size[0]), _round(block.size[2]), max(_round(low), 0.0),
                   _round(block.size[1]), position=item.at(block.middle[0], block.middle[1]),
                   yaw=_angle(item.yaw))
    (level.doors if item.kind == "Door" else level.windows).append(made)


def _stairs(level: Level, item: _Item, base: float) -> None:
    steps = sorted(item.blocks, key=lambda block: block.middle[2])
    first, last = steps[0], steps[-1]
    dx, dy = last.middle[0] - first.middle[0], last.middle[1] - first.middle[1]
    sideways = abs(dx) > abs(dy)
    run, width = (first.size[0], first.size[1]) if sideways else (first.size[1], first.size[0])
    up = math.atan2(dy, dx) if len(steps) > 1 else math.pi / 2
    depth = _round(math.hypot(dx, dy) + run)
    height = _round(last.high[2] - min(first.low[2], 0.0))
    level.stairs.append(Stairs(
        item.id, item.at((first.middle[0] + last.middle[0]) / 2,
                         (first.middle[1] + last.middle[1]) / 2),
        _angle(item.yaw + up - math.pi / 2), _round(width), depth, height, len(steps), item.color,
        item.texture))


def _floor(level: Level, item: _Item, base: float) -> None:
    from shapely import set_precision, union_all
    from shapely.geometry import Polygon

    shapes: List[Any] = []
    thickness = 0.0
    for block in item.blocks:
        (x0, y0, _), (x1, y1, _) = block.low, block.high
        shapes.append(Polygon([item.at(x, y) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]))
        thickness = max(thickness, block.size[2])
    for polygon in item.polygons:
        loops = [[item.at(x, y) for x, y in loop] for loop in polygon.loops]
        shapes.append(Polygon(loops[0], loops[1:]))
        thickness = max(thickness, polygon.height)
    closed = union_all(shapes).buffer(ROUGH, join_style="mitre").buffer(-ROUGH, join_style="mitre")
    whole = set_precision(closed, 1e-6).simplify(ROUGH / 10)
    for number, part in enumerate(getattr(whole, "geoms", [whole])):
        level.floors.append(Floor(item.id if number == 0 else -1, _corners(part.exterior),
                                  [_corners(ring) for ring in part.interiors], _round(thickness),
                                  item.color, item.texture))


def _corners(ring: Any) -> List[Point]:
    return [(_round(x), _round(y)) for x, y in list(ring.coords)[:-1]]


def _fill_stair_holes(level: Level, below: List[Stairs]) -> None:
    """Remove holes of stairs from floors: the stairs create them again."""
    from shapely.geometry import Polygon

    footprints = [Polygon(flight.corners()).buffer(10 * ROUGH) for flight in below]
    for floor in level.floors:
        floor.holes = [hole for hole in floor.holes
                       if not any(shape.contains(Polygon(hole)) for shape in footprints)]


_READERS = {"Wall": _wall, "Window": _free_opening, "Door": _free_opening, "Stairs": _stairs,
            "Floor": _floor}


def _number(plan: Plan, items: List[_Item]) -> None:
    """Assign ids to items without a link of their own, above all existing ones."""
    for name, kind in COUNTERS.items():
        at = max((item.id + 1 for item in items if item.kind.lower() == kind), default=0)
        for level in plan.levels:
            for thing in getattr(level, name):
                if thing.id < 0:
                    thing.id, at = at, at + 1
        plan.next[kind] = at


def _span(blocks: List[_Block], axis: int) -> Tuple[float, float]:
    return (min(block.low[axis] for block in blocks), max(block.high[axis] for block in blocks))


def _round(value: float) -> float:
    """Round to 0.01 mm, slightly finer than Gazebo's precision."""
    return round(value, 5) + 0.0


def _angle(value: float) -> float:
    return round(math.remainder(value, 2 * math.pi), 6) + 0.0
