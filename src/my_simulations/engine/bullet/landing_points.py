"""Find all contact points of landing bodies by tilting them back and forth."""
from __future__ import annotations

from math import atan2, cos, hypot, pi, sin
from typing import Dict, List, NamedTuple, Tuple

import pybullet

from ...geometry import Quat, Vec3, add, cross, dot, multiply, norm, rotate, scale, subtract
from . import collision_groups
from .contact_points import DISTANCE, POINT
from .link_states import Motion

MOST_TILT = 0.15
"""Largest tilt in the search, rad."""

Filters = List[Tuple[int, collision_groups.Filter]]
"""Collision filters of the links of a body, with PyBullet's link indices."""

_TILT = 2e-3       # rad: tilt in the first round
_HINT = 1e-4       # rad: tilt in the landing step, so that the point Bullet adds is a corner
_LOST = 1e-3       # m: Bullet drops points that are farther from the surface
_ACROSS = 0.8      # of a normal along an axis: a smaller part counts as across it
_DIRECTIONS = 4    # a quarter of a turn each
_QUARTER = pi / 2.0
_FIRST = 0.65      # rad: not along the edges of bodies that are aligned with the axes


class Touch(NamedTuple):
    """A contact that a body will make in this step.

    Attributes:
        gap: m, below 0 for an overlap.
        normal: points to the body.
        motion: of the body.
        width, breadth: the least and largest extent of the body across the normal, m.
    """

    uid: int
    other: int
    gap: float
    place: Vec3
    normal: Vec3
    motion: Motion
    width: float
    breadth: float

    @property
    def most(self) -> float:
        """The largest tilt, rad, with which the whole face is inside the other body."""
        return min(MOST_TILT, -self.gap / self.width)

    @property
    def raised(self) -> float:
        """The lift, m, with which Bullet drops no point at the tilt `most`."""
        return -max(0.0, self.most * self.width - _LOST)


class _Trial(NamedTuple):
    """A tilt of a body: direction of the axis and angle, rad, and lift, m."""

    touch: Touch
    angle: float
    tilt: float
    raised: float


class LandingPoints:
    """Makes Bullet find the contact points of landing bodies.

    Args:
        filters: the filters of the bodies, by PyBullet's numbers; setting one drops contact points.
    """

    def __init__(self, filters: Dict[int, Filters]) -> None:
        self._filters = filters

    def find(self, touches: List[Touch]) -> None:
        """Tilt bodies about their contacts, and have Bullet detect the contact points."""
        trials = [_Trial(touch, _FIRST, _TILT, -touch.gap) for touch in touches]
        # The first directions miss corners of long, thin bodies; directions along them do not.
        trials = [trial._replace(angle=_longest(trial.touch, points))
                  for trial, points in zip(trials, self._try(trials))]
        self._try(trials)
        # A tilted body may be so deep that its whole face touches: larger tilts find all corners.
        wide = [_Trial(trial.touch, _lowest(trial.touch), trial.touch.most, trial.touch.raised)
                for trial in _leaning([trial for trial in trials if trial.touch.most > _TILT])]
        self._try(wide)
        # Bodies whose centre of mass is still outside their points land on a corner.
        leaning = {trial.touch.uid for trial in _leaning(wide)}
        self._try([trial for trial in trials if trial.touch.uid in leaning])

    def _try(self, trials: List[_Trial]) -> List[List[Vec3]]:
        """Find up to four contact points of each body; return the positions of all points found.

        Each body is left in a pose in which the point that Bullet adds is the last of these.
        """
        found: List[List[Vec3]] = [[] for _ in trials]
        for trial in trials:
            self._drop_points(trial.touch.uid)
        for number in range(_DIRECTIONS if trials else 0):
            for touch, angle, tilt, raised in trials:
                _tilt(touch, angle + _QUARTER * number, tilt, raised)
            pybullet.performCollisionDetection()
            for trial, places in zip(trials, found):
                places += [point[POINT] for point in pybullet.getContactPoints(trial.touch.uid)]
        for touch, angle, _, _ in trials:
            sunk = max(0.0, touch.gap + _HINT * touch.breadth)  # else points would not touch
            _tilt(touch, angle - _QUARTER, _HINT, -sunk)
            # Setting the pose has reset the velocity.
            pybullet.resetBaseVelocity(touch.uid, touch.motion.linear, touch.motion.angular)
        return found

    def _drop_points(self, uid: int) -> None:
        """Drop the contact points of a body: Bullet keeps four per pair, and selects them badly."""
        for index, collision_filter in self._filters[uid]:
            collision_filter.set(uid, index)


def _longest(touch: Touch, places: List[Vec3]) -> float:
    """Return the direction between the two positions that are farthest apart, rad."""
    side, fore = _sides(touch.normal)
    points = [(dot(place, side), dot(place, fore)) for place in places]
    ways = [(a[0] - b[0], a[1] - b[1]) for at, a in enumerate(points) for b in points[:at]]
    x, y = max(ways, key=lambda way: hypot(*way), default=(0.0, 0.0))
    return atan2(y, x) if x or y else _FIRST


def _sides(normal: Vec3) -> Tuple[Vec3, Vec3]:
    """Return two directions, perpendicular to a normal and to each other."""
    side = cross(normal, (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0))
    side = scale(side, 1.0 / norm(side))
    return side, cross(normal, side)


def _tilt(touch: Touch, angle: float, tilt: float, raised: float) -> None:
    """Tilt a body about its contact, and lift it by `raised`, m."""
    normal, at = touch.normal, touch.motion.position
    side, fore = _sides(normal)
    axis = add(scale(side, cos(angle)), scale(fore, sin(angle)))
    s = sin(tilt / 2.0)
    by: Quat = (axis[0] * s, axis[1] * s, axis[2] * s, cos(tilt / 2.0))
    pivot = subtract(at, scale(normal, dot(subtract(at, touch.place), normal)))
    centre = add(pivot, rotate(by, subtract(at, pivot)))
    pybullet.resetBasePositionAndOrientation(
        touch.uid, add(centre, scale(normal, raised)), multiply(by, touch.motion.orientation))


def _lowest(touch: Touch) -> float:
    """Return the first of four directions, so that the last tilt lowers the lowest point."""
    side, fore = _sides(touch.normal)
    lever = subtract(touch.place, touch.motion.position)
    return atan2(dot(lever, fore), dot(lever, side)) - 2.0 * _QUARTER


def _leaning(trials: List[_Trial]) -> List[_Trial]:
    """Return the trials of bodies whose centre of mass is not above their contact points."""
    if trials:
        pybullet.performCollisionDetection()
    return [trial for trial in trials if not _stands(trial.touch)]


def _stands(touch: Touch) -> bool:
    """Whether the centre of mass is above the polygon of the contact points."""
    side, fore = _sides(touch.normal)
    levers = [subtract(point[POINT], touch.motion.position)
              for point in pybullet.getContactPoints(touch.uid) if point[DISTANCE] <= 0.0]
    angles = sorted(atan2(dot(lever, fore), dot(lever, side)) for lever in levers)
    around = [*angles[1:], angles[0] + 2.0 * pi] if angles else []
    return bool(angles) and max(b - a for a, b in zip(angles, around)) < pi


def extents_across(low: Vec3, high: Vec3, normal: Vec3) -> Tuple[float, float]:
    """Return the smallest and largest extent across a direction, m."""
    extents = [b - a for a, b, along in zip(low, high, normal) if abs(along) < _ACROSS]
    return min(extents), max(extents)
