"""Finds all points at which bodies that land will touch, by tilting them back and forth."""
from __future__ import annotations

from math import atan2, cos, hypot, pi, sin
from typing import Dict, List, NamedTuple, Tuple

import pybullet

from ...geometry import Quat, Vec3, add, cross, dot, multiply, norm, rotate, scale, subtract
from . import collision_groups

MOST_TILT = 0.15
"""How far a flat body is tilted at most, rad: one that lands more tilted lands on a corner."""

Filters = List[Tuple[int, collision_groups.Filter]]
"""What the links of a body meet, with PyBullet's link indices."""

_TILT = 2e-3       # rad: of the first round
_HINT = 1e-4       # rad: of the landing step, in which Bullet finds one more point: a corner too
_LOST = 1e-3       # m above a surface points are lost
_ACROSS = 0.8      # of a normal along an axis: less is across it
_DIRECTIONS = 4    # a quarter of a turn each
_QUARTER = pi / 2.0
_FIRST = 0.65      # rad: not along the edges of what stands square to the axes


class Touch(NamedTuple):
    """Where a body will touch another in this step.

    Attributes:
        gap: m, below 0 for an overlap.
        normal: points at the body.
        at, turn: where the body is.
        width, breadth: the least and largest extent of the body across the normal, m.
    """

    uid: int
    other: int
    gap: float
    place: Vec3
    normal: Vec3
    at: Vec3
    turn: Quat
    velocity: Tuple[Vec3, Vec3]
    width: float
    breadth: float

    @property
    def most(self) -> float:
        """The largest tilt of a flat body with which all of it is in the other, rad."""
        return min(MOST_TILT, -self.gap / self.width)

    @property
    def raised(self) -> float:
        """By how much to raise it, m, so that no point is lost when it is tilted so far."""
        return -max(0.0, self.most * self.width - _LOST)


class _Trial(NamedTuple):
    """How to tilt a body, about which axis and how far, rad, and by how much to raise it, m."""

    touch: Touch
    angle: float
    tilt: float
    raised: float


class LandingPoints:
    """Lets Bullet find the points of bodies that land.

    Args:
        meets: the filters of the bodies, by PyBullet's numbers.
    """

    def __init__(self, meets: Dict[int, Filters]) -> None:
        self._meets = meets

    def find(self, touches: List[Touch]) -> None:
        """Tilt bodies about where they will touch, and let Bullet look for points."""
        trials = [_Trial(touch, _FIRST, _TILT, -touch.gap) for touch in touches]
        # What is long and thin has corners that no four directions find, but these do.
        trials = [trial._replace(angle=_longest(trial.touch, points))
                  for trial, points in zip(trials, self._try(trials))]
        self._try(trials)
        # What lands tilted, and is so deep already that all of it touches, touches everywhere.
        wide = [_Trial(trial.touch, _lowest(trial.touch), trial.touch.most, trial.touch.raised)
                for trial in _leaning([trial for trial in trials if trial.touch.most > _TILT])]
        self._try(wide)
        # And what leans none the less lands on its corner.
        leaning = {trial.touch.uid for trial in _leaning(wide)}
        self._try([trial for trial in trials if trial.touch.uid in leaning])

    def _try(self, trials: List[_Trial]) -> List[List[Vec3]]:
        """Have four points found for each body; gives all places that were seen.

        Each is left in such a pose that Bullet's own point will be the last of them.
        """
        found: List[List[Vec3]] = [[] for _ in trials]
        for trial in trials:
            self._drop_points(trial.touch.uid)
        for number in range(_DIRECTIONS if trials else 0):
            for touch, angle, tilt, raised in trials:
                _tilt(touch, angle + _QUARTER * number, tilt, raised)
            pybullet.performCollisionDetection()
            for trial, places in zip(trials, found):
                places += [point[5] for point in pybullet.getContactPoints(trial.touch.uid)]
        for touch, angle, _, _ in trials:
            sunk = max(0.0, touch.gap + _HINT * touch.breadth)  # or points would not touch
            _tilt(touch, angle - _QUARTER, _HINT, -sunk)
            pybullet.resetBaseVelocity(touch.uid, *touch.velocity)  # placing a body stops it
        return found

    def _drop_points(self, uid: int) -> None:
        """Let a body have four new points on each surface: Bullet does not choose well of more."""
        for index, meets in self._meets[uid]:
            meets.set(uid, index)


def _longest(touch: Touch, places: List[Vec3]) -> float:
    """The angle of the way between the two places that are farthest apart, rad."""
    side, fore = _sides(touch.normal)
    points = [(dot(place, side), dot(place, fore)) for place in places]
    ways = [(a[0] - b[0], a[1] - b[1]) for at, a in enumerate(points) for b in points[:at]]
    x, y = max(ways, key=lambda way: hypot(*way), default=(0.0, 0.0))
    return atan2(y, x) if x or y else _FIRST


def _sides(normal: Vec3) -> Tuple[Vec3, Vec3]:
    """Two directions across a normal, and across each other."""
    side = cross(normal, (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0))
    side = scale(side, 1.0 / norm(side))
    return side, cross(normal, side)


def _tilt(touch: Touch, angle: float, tilt: float, raised: float) -> None:
    """Tilt a body about the place that it will touch, and raise it by `raised`, m."""
    normal = touch.normal
    side, fore = _sides(normal)
    axis = add(scale(side, cos(angle)), scale(fore, sin(angle)))
    s = sin(tilt / 2.0)
    by: Quat = (axis[0] * s, axis[1] * s, axis[2] * s, cos(tilt / 2.0))
    pivot = subtract(touch.at, scale(normal, dot(subtract(touch.at, touch.place), normal)))
    centre = add(pivot, rotate(by, subtract(touch.at, pivot)))
    pybullet.resetBasePositionAndOrientation(
        touch.uid, add(centre, scale(normal, raised)), multiply(by, touch.turn))


def _lowest(touch: Touch) -> float:
    """The angle of four turns whose last one lowers what is lowest already."""
    side, fore = _sides(touch.normal)
    lever = subtract(touch.place, touch.at)
    return atan2(dot(lever, fore), dot(lever, side)) - 2.0 * _QUARTER


def _leaning(trials: List[_Trial]) -> List[_Trial]:
    """Those of bodies whose centre of mass does not lie over the points that touch."""
    if trials:
        pybullet.performCollisionDetection()
    return [trial for trial in trials if not _stands(trial.touch)]


def _stands(touch: Touch) -> bool:
    """Whether the centre of mass lies over the points that touch."""
    side, fore = _sides(touch.normal)
    levers = [subtract(point[5], touch.at) for point in pybullet.getContactPoints(touch.uid)
              if point[8] <= 0.0]
    angles = sorted(atan2(dot(lever, fore), dot(lever, side)) for lever in levers)
    around = [*angles[1:], angles[0] + 2.0 * pi] if angles else []
    return bool(angles) and max(b - a for a, b in zip(angles, around)) < pi


def extents_across(low: Vec3, high: Vec3, normal: Vec3) -> Tuple[float, float]:
    """The least and largest extent across a direction, m."""
    extents = [b - a for a, b, along in zip(low, high, normal) if abs(along) < _ACROSS]
    return min(extents), max(extents)
