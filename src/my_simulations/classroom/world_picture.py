"""Draws a small picture of a student's world from what its editor sends: boxes, seen from above."""
from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import cos, fabs, radians, sin
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple

from ..editor.transport.pose_messages import HEAD_BYTES, LIVE, RECORD_STRUCT
from ..geometry import (
    Pose,
    Vec3,
    compose,
    is_finite,
    norm,
    normalised,
    pose_is_finite,
    transform,
)

_MOST_PARTS = 300
_MOST_M = 200.0          # largest coordinate and size that is drawn
_CUT_M = 1.0             # height at which static parts are cut: walls hide no robots
_WIDTH, _HEIGHT, _MARGIN = 320.0, 200.0, 8.0
_UNKNOWN_M = 0.3         # size of a mesh without collisions of a known size
_GREY = (0.7, 0.7, 0.7)
_TURN, _TILT = radians(-30.0), radians(55.0)     # of the camera, which looks north-east and down

Projected = Tuple[float, float, float]
"""Right, up, and distance from the camera."""


@dataclass(frozen=True)
class _Part:
    """A box of a link: its pose in the link, m, half its size, m, and its colour, 0..1."""

    link: int
    pose: Pose
    half: Vec3
    colour: Vec3
    static: bool


class WorldPicture:
    """The models of a world, drawn as SVG.

    The input comes from a student's processes: invalid input raises various exceptions, and what
    is kept of it has a limit.
    """

    def __init__(self) -> None:
        self._parts: Dict[str, List[_Part]] = {}
        self._poses: Dict[int, Pose] = {}

    def clear(self) -> None:
        self._parts, self._poses = {}, {}

    def update_models(self, models: Mapping[str, Optional[Mapping[str, Any]]]) -> None:
        """Add or replace models of the protocol, by name; None removes a model."""
        for name, model in models.items():
            for part in self._parts.pop(name, []):
                self._poses.pop(part.link, None)
            room = _MOST_PARTS - sum(map(len, self._parts.values()))
            if model is None or room <= 0:
                continue
            at = _pose(model["pose"])
            parts: List[_Part] = []
            for link in model["links"]:
                found = _parts_of(link, bool(model["static"]))[:room - len(parts)]
                if found:
                    parts += found
                    self._poses[found[0].link] = compose(at, _pose(link["pose"]))
            if parts:
                self._parts[name] = parts

    def update_poses(self, frame: bytes) -> None:
        """Apply the poses of a binary frame of the editor; other frames are ignored."""
        if int.from_bytes(frame[:4], "little") != LIVE:
            return
        for number, *values in RECORD_STRUCT.iter_unpack(frame[HEAD_BYTES:]):
            if number in self._poses:
                self._poses[number] = _pose(values)

    def svg(self) -> str:
        """Return the picture as SVG; an empty picture without models."""
        boxes = [box for parts in self._parts.values() for part in parts
                 for box in self._box(part)]
        if not boxes:
            return _page([])
        scale, left, top = _window(boxes)

        def place(corner: Projected) -> str:
            return f"{scale * (corner[0] - left):.1f},{scale * (top - corner[1]):.1f}"

        boxes.sort(key=lambda box: -max(corner[2] for corner in box[0]))
        return _page([f'<polygon points="{" ".join(place(corners[n]) for n in face)}"'
                      f' fill="#{_hex(colour, shade)}"/>'
                      for corners, colour in boxes for face, shade in _faces(corners)])

    def _box(self, part: _Part) -> Iterator[Tuple[List[Projected], Vec3]]:
        """The projected corners of a part with its colour; nothing for parts above the cut."""
        link = self._poses.get(part.link)
        if link is None:
            return
        pose = compose(link, part.pose)
        if not pose_is_finite(pose) or norm(pose.position) > _MOST_M:
            return
        x, y, z = part.half
        corners = [transform(pose, (a * x, b * y, c * z))
                   for a, b, c in product((-1, 1), repeat=3)]
        if part.static:
            if min(corner[2] for corner in corners) > _CUT_M:
                return
            corners = [(a, b, min(c, _CUT_M)) for a, b, c in corners]
        yield [_project(corner) for corner in corners], part.colour


# Corners of a box are numbered by the signs of x, y and z: 0 is (-, -, -), 7 is (+, +, +).
_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
_SHADES = (0.72, 0.72, 0.85, 0.85, 1.0, 1.0)


def _faces(corners: Sequence[Projected]) -> Iterator[Tuple[Sequence[int], float]]:
    """The faces that the camera sees, as numbers of corners, with their shades."""
    for face, shade in zip(_FACES, _SHADES):
        (ax, ay, _), (bx, by, _), (cx, cy, _) = (corners[n] for n in face[:3])
        if (bx - ax) * (cy - by) - (by - ay) * (cx - bx) > 0.0:
            yield face, shade


def _project(point: Vec3) -> Projected:
    x, y, z = point
    right, ahead = x * cos(_TURN) - y * sin(_TURN), x * sin(_TURN) + y * cos(_TURN)
    return (right, z * cos(_TILT) + ahead * sin(_TILT), ahead * cos(_TILT) - z * sin(_TILT))


def _window(boxes: Sequence[Tuple[List[Projected], Vec3]]) -> Tuple[float, float, float]:
    """Pixels for a metre, and the left and upper end of what is shown.

    An object that has fallen out of the world does not shrink the rest: the outer tenths on each
    side extend the window by its size at most.
    """
    ends = []
    for axis in (0, 1):
        values = sorted(corner[axis] for corners, _ in boxes for corner in corners)
        tenth = len(values) // 10
        low, high = values[tenth], values[-1 - tenth]
        room = max(high - low, 1.0)
        ends.append((max(values[0], low - room), min(values[-1], high + room)))
    (left, right), (bottom, top) = ends
    scale = min((_WIDTH - 2 * _MARGIN) / max(right - left, 0.5),
                (_HEIGHT - 2 * _MARGIN) / max(top - bottom, 0.5))
    return (scale, (left + right - _WIDTH / scale) / 2, (top + bottom + _HEIGHT / scale) / 2)


def _parts_of(link: Mapping[str, Any], static: bool) -> List[_Part]:
    """Boxes of a link: of its visuals, or if one of them has no known size, of its collisions."""
    number = int(link["id"])
    found: List[_Part] = []
    unknown = False
    for shape in link["visuals"]:
        if shape["geometry"]["type"] in ("mesh", "heightmap"):
            unknown = True
            continue
        found += _shape(number, shape, _colour(shape.get("material")), static)
    if unknown:
        found = [part for shape in link["collisions"]
                 for part in _shape(number, shape, _GREY, static)] or found
        half = _UNKNOWN_M / 2
        found = found or [_Part(number, _pose(link["inertial"]["pose"]), (half, half, half), _GREY,
                                static)]
    return found


def _shape(link: int, shape: Mapping[str, Any], colour: Vec3, static: bool) -> List[_Part]:
    bounds = _bounds(shape["geometry"])
    if len(bounds) != 3:
        return []
    (xs, ys, zs), pose = bounds, _pose(shape["pose"])
    half = ((xs[1] - xs[0]) / 2, (ys[1] - ys[0]) / 2, (zs[1] - zs[0]) / 2)
    if not is_finite(*half) or max(map(fabs, half)) > _MOST_M:
        return []
    centre = (xs[0] + half[0], ys[0] + half[1], zs[0] + half[2])
    return [_Part(link, Pose(transform(pose, centre), pose.orientation), half, colour, static)]


def _bounds(geometry: Mapping[str, Any]) -> List[Tuple[float, float]]:
    """Least and greatest x, y and z of a geometry, m; empty if they are unknown or not drawn."""
    if geometry["type"] == "polyline":
        points = [(float(x), float(y)) for loop in geometry["loops"] for x, y in loop]
        return [*((min(values), max(values)) for values in zip(*points)),
                (0.0, float(geometry["height"]))]
    return [(-half, half) for half in _half_size(geometry)]


def _half_size(geometry: Mapping[str, Any]) -> List[float]:
    """Half the size of a geometry about its origin, m; empty if it is unknown or not drawn."""
    kind = geometry["type"]
    if kind == "box":
        return [float(value) / 2 for value in geometry["size"]]
    if kind == "ellipsoid":
        return [float(value) for value in geometry["radii"]]
    if kind not in ("sphere", "cylinder", "capsule", "cone"):
        return []
    radius = float(geometry["radius"])
    length = float(geometry.get("length", 0.0)) / 2
    return [radius, radius, radius if kind == "sphere" else
            length + (radius if kind == "capsule" else 0.0)]


def _pose(values: Sequence[Any]) -> Pose:
    x, y, z, qx, qy, qz, qw = map(float, values)
    return Pose((x, y, z), normalised((qx, qy, qz, qw)))


def _colour(material: Optional[Mapping[str, Any]]) -> Vec3:
    red, green, blue = ((material or {}).get("diffuse") or _GREY)[:3]
    return float(red), float(green), float(blue)


def _hex(colour: Vec3, shade: float) -> str:
    """Of a colour in a shade; NaN becomes black."""
    return "".join(f"{int(255 * shade * min(1.0, value)) if value > 0.0 else 0:02x}"
                   for value in colour)


def _page(polygons: Sequence[str]) -> str:
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}"'
            ' stroke="#333" stroke-width="0.3" stroke-linejoin="round">'
            + "".join(polygons) + "</svg>\n")
