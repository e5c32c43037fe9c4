"""Closed paths on the ground along which an object is moved."""
from __future__ import annotations

import ast
import math
from typing import Any, List, NamedTuple, Sequence, Tuple

from ..errors import InputError, error

Point = Tuple[float, float]


class Waypoint(NamedTuple):
    """A pose on a path in the world frame: x, y (m), yaw (rad)."""

    x: float
    y: float
    yaw: float


class Polygon:
    """A closed path of straight edges."""

    def __init__(self, corners: Sequence[Point]) -> None:
        """Create a path through at least two corners (m); equal neighbours are skipped.

        Raises InputError: the length of the path is zero.
        """
        edges = []
        for start, end in zip(corners, [*corners[1:], *corners[:1]]):
            length = math.hypot(end[0] - start[0], end[1] - start[1])
            if length > 0.0:
                edges.append((start, end, length))
        if not edges:
            raise InputError([error("polygon", "a polygon needs at least two different corners")])
        self._edges = edges
        self.length = sum(edge[2] for edge in edges)

    def at(self, distance: float) -> Waypoint:
        """The pose at `distance` (m) along the path, over any number of rounds."""
        start, end, length, into = self._edge(distance)
        part = into / length
        return Waypoint(start[0] + part * (end[0] - start[0]),
                        start[1] + part * (end[1] - start[1]),
                        math.atan2(end[1] - start[1], end[0] - start[0]))

    def restart(self, distance: float) -> float:
        """Distance from which to restart when blocked: the start of the current edge."""
        return distance - self._edge(distance)[3]

    def _edge(self, distance: float) -> Tuple[Point, Point, float, float]:
        left = distance % self.length
        for start, end, length in self._edges:
            if left < length:
                return start, end, length, left
            left -= length
        start, end, length = self._edges[-1]
        return start, end, length, length


class Circle:
    """A clockwise circle (seen from above) from its point of greatest y, heading along the path."""

    def __init__(self, centre: Point, radius: float) -> None:
        """Create a circle; centre and radius in m.

        Raises InputError: the radius is not a positive number.
        """
        if not (math.isfinite(radius) and radius > 0.0):
            raise InputError([error("circle", f"the radius must be greater than 0, is {radius}")])
        self._centre = centre
        self._radius = radius
        self.length = 2.0 * math.pi * radius

    def at(self, distance: float) -> Waypoint:
        """The pose at `distance` (m) along the path; its yaw is minus the angle."""
        angle = math.remainder(distance / self._radius, 2.0 * math.pi)
        return Waypoint(self._centre[0] + self._radius * math.sin(angle),
                        self._centre[1] + self._radius * math.cos(angle), -angle)

    def restart(self, distance: float) -> float:
        """Distance from which to restart when blocked: angle 0 of the same round."""
        return distance - distance % self.length


def parse_numbers(text: str, count: int, what: str) -> List[float]:
    """Parse a list such as `[1, 2.5]` of a command line.

    Raises InputError: it is not a list of `count` finite numbers.
    """
    return _numbers(_literal(text, what), count, what, text)


def parse_points(text: str, what: str) -> List[Point]:
    """Parse a list of points such as `[[0, 0], [1, 0]]` of a command line.

    Raises InputError: it is not a list of pairs of finite numbers.
    """
    value = _literal(text, what)
    if not isinstance(value, (list, tuple)) or not value:
        raise _not(what, "a list of [x, y] points", text)
    points = [_numbers(item, 2, what, text) for item in value]
    return [(x, y) for x, y in points]


def _literal(text: str, what: str) -> Any:
    try:
        return ast.literal_eval(text.strip())
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        raise _not(what, "a list of numbers", text) from None


def _numbers(value: Any, count: int, what: str, text: str) -> List[float]:
    if not isinstance(value, (list, tuple)) or len(value) != count:
        raise _not(what, f"a list of {count} numbers", text)
    numbers = []
    for item in value:
        if isinstance(item, bool) or not isinstance(item, (int, float)) \
                or abs(item) > 1e12 or not math.isfinite(item):
            raise _not(what, f"a list of {count} finite numbers", text)
        numbers.append(float(item))
    return numbers


def _not(what: str, wanted: str, text: str) -> InputError:
    return InputError([error("argument", f"{what} must be {wanted}, is {text!r}")])
