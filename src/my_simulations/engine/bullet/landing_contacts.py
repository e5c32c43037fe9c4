"""Lets what lands flat land flat: finds all points at which it will touch, before the impact.

Bullet finds one point a step where shapes meet, and four at once for two boxes only. The first
impact of a can or a mesh that lands upright would so be taken by one point of its rim: from 5 cm
it tilts by 6 degrees, from 0.3 m it falls over (measured). Bullet keeps points from step to step,
though, and solves all that it has. So in the step in which a flying body will touch something, it
is tilted to and fro by 2 mrad about the place where it touches, Bullet looks for contacts each
time, and the body is put back: the points lie on the corners, or around the rim. It stays tilted
by 0.1 mrad, so that the one point that the step adds is a corner too, not one in between that takes
the place of another. Points that do not touch yet, as of a body that lands on a corner, carry
nothing.

Who flies is asked now and then; of what flies, how far it is from what it could reach, and then not
again before it can be there. What stands, or sleeps, costs next to nothing.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from math import atan2, cos, hypot, pi, sin
from typing import AbstractSet, Callable, Dict, List, NamedTuple, Optional, Set, Tuple

import pybullet

from ...description.model import Link
from ...description.shapes import Box, Empty, Plane, Sphere
from ...geometry import Quat, Vec3, add, cross, dot, multiply, norm, rotate, scale, subtract
from . import collision_groups
from .approach import approach, extent, speed_of
from .bodies import Body, Part
from .step_helper import FAR, looks_until_turn, turn_of

EVERY = 16
"""Steps between two looks for bodies that fly."""

_ROUNDS = 2        # looks until every body was asked
_RESTS = 0.03      # m/s: what flies is faster 3 ms after it left the ground
_BOUNCE = 8        # steps until one that has landed is looked at again
_BOUNCES = 4       # such looks until it is one of those that are asked now and then
_PATIENCE = 7      # turns that one that sleeps is left out; one that rests: 1
_SOFT = 2e-3       # m/s: what comes slower tilts nothing
_SETTLES = 2.5     # steps of falling: what was put down at rest falls no longer
_AHEAD = 16        # steps for which a flying body looks ahead, at most
_TILT = 2e-3       # rad: of the first round
_HINT = 1e-4       # rad: of the landing step, in which Bullet finds one more point: a corner too
_MOST_TILT = 0.15  # rad: of the second
_LOST = 1e-3       # m above a surface points are lost
_ACROSS = 0.8      # of a normal along an axis: less is across it
_NONE = (0.0, 0.0, 0.0)
_DIRECTIONS = 4    # a quarter of a turn each
_QUARTER = pi / 2.0
_FIRST = 0.65      # rad: not along the edges of what stands square to the axes


@dataclass
class _Flight:
    """One body that flies, or has just landed. `through`: bodies that it does not meet."""

    body: Body
    look: int = 0
    on_ground: int = 0   # looks in a row
    through: Set[int] = field(default_factory=set)
    tried: Set[int] = field(default_factory=set)   # what it lay in when points were sought


_Filters = List[Tuple[int, collision_groups.Filter]]   # by PyBullet's link index


class _Touch(NamedTuple):
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
        return min(_MOST_TILT, -self.gap / self.width)

    @property
    def raised(self) -> float:
        """By how much to raise it, m, so that no point is lost when it is tilted so far."""
        return -max(0.0, self.most * self.width - _LOST)


class _Trial(NamedTuple):
    """How to tilt a body, about which axis and how far, rad, and by how much to raise it, m."""

    touch: _Touch
    angle: float
    tilt: float
    raised: float


class LandingContacts:
    """Finds the contact points of what lands before Bullet solves its impact.

    Args:
        landed: is told which body lands, and the normal of what it lands on.
        solve_impact: is told whether the next step solves landings.
    """

    def __init__(self, landed: Callable[[int, Vec3], None],
                 solve_impact: Callable[[bool], None]) -> None:
        self._landed = landed
        self._solve_impact = solve_impact
        self._impact = False
        self._bodies: Dict[int, Body] = {}
        self._meets: Dict[int, _Filters] = {}
        self._order: Optional[List[int]] = None
        self._moving: Set[int] = set()
        self._uneven: Dict[int, None] = {}  # not made of boxes, balls and planes alone
        self._asleep: Dict[int, int] = {}   # turns that are left out
        self._flights: Dict[int, _Flight] = {}
        self._next = FAR                    # the first step at which a flight is looked at

    def add(self, body: Body, part: Part, link: Link) -> None:
        """Know one link of a body; only bodies that can tilt as they land matter."""
        known = (Box, Sphere, Empty) if body.moves else (Box, Sphere, Empty, Plane)
        if not all(isinstance(collision.geometry, known) for collision in link.collisions):
            self._uneven[body.uid] = None
        if body.moves:
            self._moving.add(body.uid)
            if not body.is_ball and body.base is not None:
                self._bodies[body.uid] = body
                self._flights[body.uid] = _Flight(body)
                self._next = 0
                self._meets.setdefault(body.uid, []).append(
                    (part.index, collision_groups.moving(link)))
        self._order = None

    def forget(self, body: Body) -> None:
        """A body is gone."""
        for table in (self._bodies, self._meets, self._uneven, self._asleep, self._flights):
            table.pop(body.uid, None)
        self._moving.discard(body.uid)
        self._order = None

    def clear(self) -> None:
        """All bodies are gone."""
        for table in (self._bodies, self._meets, self._uneven, self._asleep, self._flights):
            table.clear()
        self._moving.clear()
        self._order = None
        self._next = FAR

    def touched(self, body: Body) -> None:
        """A command reached a body: it may fly from now on."""
        self._asleep.pop(body.uid, None)
        if body.uid in self._bodies and self._watched():
            self._flights[body.uid] = _Flight(body)
            self._next = 0

    def due(self, step: int) -> int:
        """The next look at a flight, or for new ones."""
        watched = self._watched()
        if not watched:
            return FAR
        look = -(-step // EVERY)
        turn = EVERY * (look + looks_until_turn(len(watched), look, _ROUNDS))
        return max(step, min(turn, self._next))

    def see_rolling(self, links: AbstractSet[Tuple[int, int]], step: int) -> None:
        """Contact points of links that roll are dropped for this step: their bodies do not fly."""
        if self._next > step:
            return
        uids = {uid for uid, _ in links}
        for flight in list(self._flights.values()):
            if flight.look <= step and flight.body.uid in uids:
                self._is_on_ground(flight, step)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Look for flights now and then, and find the points of those that end in this step."""
        if step % EVERY == 0:
            self._ask(turn_of(self._watched(), step // EVERY, _ROUNDS))
        touches: List[_Touch] = []
        for flight in list(self._flights.values()):
            if flight.look <= step:
                touches += self._look(flight, step, dt, gravity)
        self._plan()
        if touches:
            self._impact = True
            self._solve_impact(True)
        while touches:
            # Two that land on each other would tilt together; so one after the other.
            now: Dict[int, _Touch] = {}
            for touch in touches:
                if touch.other not in now:
                    now.setdefault(touch.uid, touch)
            self._find_points(list(now.values()))
            touches = [touch for touch in touches if touch.uid not in now]

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Solve the next steps as is usual."""
        if self._impact:
            self._impact = False
            self._solve_impact(False)

    def _ask(self, uids: List[int]) -> None:
        """Find out which bodies may fly; what rests is asked less often."""
        for uid in uids:
            if self._asleep.get(uid):
                self._asleep[uid] -= 1
                continue
            linear = pybullet.getBaseVelocity(uid)[0]
            if norm(linear) <= _RESTS:
                self._asleep[uid] = _PATIENCE if linear == _NONE else 1
            elif uid not in self._flights:
                self._flights[uid] = _Flight(self._bodies[uid], on_ground=_BOUNCES)

    def _watched(self) -> List[int]:
        """The bodies that can land on something, one of both not made of boxes.

        Bullet finds all points of two boxes by itself.
        """
        if self._order is None:
            self._order = list(self._bodies) if self._uneven else []
        return self._order

    def _plan(self) -> None:
        self._next = min((flight.look for flight in self._flights.values()), default=FAR)

    def _is_on_ground(self, flight: _Flight, step: int) -> bool:
        """Whether a body touches something; then it is not looked at for some steps."""
        uid = flight.body.uid
        if not any(contact[9] > 0.0 for contact in pybullet.getContactPoints(bodyA=uid)):
            return False
        flight.on_ground += 1
        if flight.on_ground > _BOUNCES or norm(pybullet.getBaseVelocity(uid)[0]) <= _RESTS:
            del self._flights[uid]
        flight.look = step + _BOUNCE
        flight.through.clear()
        flight.tried.clear()
        return True

    def _look(self, flight: _Flight, step: int, dt: float, gravity: Vec3) -> List[_Touch]:
        """What a body will touch in this step, deepest first; finds out when to look again."""
        uid = flight.body.uid
        if self._is_on_ground(flight, step):
            return []
        flight.on_ground = 0
        linear, angular = pybullet.getBaseVelocity(uid)
        low, high = extent(flight.body)
        fall = norm(gravity) * dt
        speed = norm(linear) + norm(angular) * norm(subtract(high, low)) + _AHEAD * fall
        reach = speed * dt * (_AHEAD + 2)
        ahead = _AHEAD
        touches: List[_Touch] = []
        for other in self._within(flight, low, high, reach):
            moves = other in self._moving
            way = dt * (speed + (speed_of(other) if moves else 0.0))   # of a step, at most
            points = pybullet.getClosestPoints(uid, other, way * (_AHEAD + 2))
            if not points or way == 0.0:   # without gravity what is at rest meets nothing
                continue
            nearest = min(points, key=lambda point: point[8])
            gap: float = nearest[8]
            if gap < ahead * way:
                ahead = int(max(0.0, gap) / way)
            if gap > 0.0:
                continue
            normal: Vec3 = nearest[7]
            speed_in = approach(uid, other if moves else None, nearest[5], normal)
            if speed_in > max(_SOFT, _SETTLES * fall) and not self._lies_in(flight, other):
                at, turn = pybullet.getBasePositionAndOrientation(uid)
                width, breadth = _across(low, high, normal)
                touches.append(_Touch(uid, other, gap, nearest[6], normal, at, turn,
                                      (linear, angular), width, breadth))
        flight.look = step + max(1, ahead)
        touches.sort(key=lambda touch: touch.gap)
        if touches:
            self._landed(uid, touches[0].normal)
        return touches[:1]

    def _within(self, flight: _Flight, low: Vec3, high: Vec3, reach: float) -> List[int]:
        """What a body may meet within `reach`, m, in the order of numbers."""
        uid, margin = flight.body.uid, (reach, reach, reach)
        found = pybullet.getOverlappingObjects(subtract(low, margin), add(high, margin)) or ()
        return sorted({other for other, _ in found if other != uid
                       and other not in flight.through
                       and (uid in self._uneven or other in self._uneven)})

    def _lies_in(self, flight: _Flight, other: int) -> bool:
        """Whether a body is in another that it did not touch a step before: they do not meet."""
        if other in flight.tried:
            flight.through.add(other)
        flight.tried.add(other)
        return other in flight.through

    def _find_points(self, touches: List[_Touch]) -> None:
        """Tilt bodies to and fro about where they will touch, and let Bullet look for points."""
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


def _longest(touch: _Touch, places: List[Vec3]) -> float:
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


def _tilt(touch: _Touch, angle: float, tilt: float, raised: float) -> None:
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


def _lowest(touch: _Touch) -> float:
    """The angle of four turns whose last one lowers what is lowest already."""
    side, fore = _sides(touch.normal)
    lever = subtract(touch.place, touch.at)
    return atan2(dot(lever, fore), dot(lever, side)) - 2.0 * _QUARTER


def _leaning(trials: List[_Trial]) -> List[_Trial]:
    """Those of bodies whose centre of mass does not lie over the points that touch."""
    if trials:
        pybullet.performCollisionDetection()
    return [trial for trial in trials if not _stands(trial.touch)]


def _stands(touch: _Touch) -> bool:
    """Whether the centre of mass lies over the points that touch."""
    side, fore = _sides(touch.normal)
    levers = [subtract(point[5], touch.at) for point in pybullet.getContactPoints(touch.uid)
              if point[8] <= 0.0]
    angles = sorted(atan2(dot(lever, fore), dot(lever, side)) for lever in levers)
    around = [*angles[1:], angles[0] + 2.0 * pi] if angles else []
    return bool(angles) and max(b - a for a, b in zip(angles, around)) < pi


def _across(low: Vec3, high: Vec3, normal: Vec3) -> Tuple[float, float]:
    """The least and largest extent across a direction, m."""
    extents = [b - a for a, b, along in zip(low, high, normal) if abs(along) < _ACROSS]
    return min(extents), max(extents)
