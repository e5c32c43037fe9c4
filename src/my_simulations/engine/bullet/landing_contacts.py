"""Find all contact points of a landing body before its impact, so that it lands flat.

Bullet finds one contact point per step and pair, and four at once only for two boxes (reasons and
figures: doc/dev/contacts.md, "Landings"). So in the step in which a flying body will touch a
surface, `LandingPoints` tilts it back and forth by 2 mrad about the contact, and Bullet detects
contacts after each tilt. The body stays tilted by 0.1 mrad: then the point that the step adds is a
corner too, and does not replace a better one.

A periodic check finds flying bodies. For each, a search finds the bodies in reach of the next 16
steps, and the distance to each of these gives the step of the next check. If two bodies fly side by
side, one is checked again once the other has landed. A box or a can with a tilt beyond the limit of
`LandingPoints` lands on a corner; it is checked again when it can have turned that far. A body that
turns over fast is not searched for bodies in reach. Bodies that stand or sleep cost almost nothing.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from math import acos, asin
from operator import attrgetter, itemgetter
from typing import Callable, Dict, List, NamedTuple, Optional, Set, Tuple

import pybullet

from ...description.shapes import Box, Cylinder, Empty, Plane, Sphere
from ...geometry import (
    Quat,
    Vec3,
    add,
    conjugate,
    dot,
    multiply,
    norm,
    rotate,
    scale,
    subtract,
)
from . import collision_groups
from .agenda import Agenda
from .approach import Motions, extent, flies, tumbles
from .bodies import Body, Part
from .body_events import COMMANDED, BodyEvent
from .contact_points import DISTANCE, LOAD, NORMAL, OTHER_PLACE, PLACE
from .landing_points import MOST_TILT, Filters, LandingPoints, Touch, extents_across
from .link_states import Motion
from .step_helper import FAR, StepHelper, next_multiple
from .world_parameters import Accuracy, WorldParameters

_EVERY = 16          # checks for flying bodies are at multiples of this number of steps
_MOVES_EVERY = 32    # steps between two such checks of a body that moves
_RESTS_EVERY = 64    # the same for a body at rest
_SLEEPS_EVERY = 256  # the same for a sleeping body
_RESTS = 0.03      # m/s: a body in free fall is faster after 3 ms
_BOUNCE = 8        # steps until a landed body is checked again
_BOUNCES = 4       # such checks until only the periodic check applies
_SOFT = 2e-3       # m/s: a slower impact does not tilt the body
_SETTLES = 2.5     # steps of free fall: a body placed at rest on a surface gains less speed
_AHEAD = 16        # steps, at most, until the next check of a flying body
_TUMBLES = 5.0     # rad/s across gravity: what turns over so fast lands on a corner or an edge
_NONE = (0.0, 0.0, 0.0)
_FOR_IMPACTS = Accuracy(10, 1e-15)
"""With 50 iterations, a block ten times as high as wide keeps turning after it lands at 10 m/s."""


@dataclass
class _Flight:
    """One body that flies, or has just landed.

    Attributes:
        arrives: step before which it can touch only bodies that fly beside it.
        on_ground: consecutive checks at which it touched something.
        seen: step of the last check at which it flew, and its velocity then, m/s.
        beside: flying bodies near it at the last check.
        pairs: by other bodies near it, the step of the next check with that body, and the step
            before which they cannot touch.
        through: bodies with which it does not collide.
        tried: bodies that it overlapped when contact points were searched.
    """

    body: Body
    arrives: int = 0
    on_ground: int = 0
    seen: Optional[Tuple[int, Vec3]] = None
    beside: Set[int] = field(default_factory=set)
    pairs: Dict[int, Tuple[int, int]] = field(default_factory=dict)
    through: Set[int] = field(default_factory=set)
    tried: Set[int] = field(default_factory=set)


class _Path(NamedTuple):
    """A body before a step.

    Attributes:
        low, high: corners of its bounding box, m.
        fall: speed that gravity adds in a step, m/s.
        spin, speed: upper bounds of the speed of its points until the next check, m/s: by
            rotation, and in all.
    """

    step: int
    dt: float
    motion: Motion
    low: Vec3
    high: Vec3
    fall: float
    spin: float
    speed: float


class LandingContacts(StepHelper):
    """Finds the contact points of landing bodies before Bullet solves the impact.

    Args:
        landed: called with the numbers of a landing body and the other one, and the normal.
        parameters: solver parameters of the world.
    """

    events = COMMANDED

    def __init__(self, landed: Callable[[int, int, Vec3], None],
                 parameters: WorldParameters) -> None:
        self._landed = landed
        self._parameters = parameters
        self._bodies: Dict[int, Body] = {}
        self._meets: Dict[int, Filters] = {}
        self._points = LandingPoints(self._meets)
        self._alone: Dict[int, Tuple[Vec3, ...]] = {}   # axes of single boxes or cylinders
        self._moving: Set[int] = set()
        self._motions = Motions(self._moving)
        self._uneven: Dict[int, None] = {}  # with other shapes than boxes, spheres and planes
        self._floors: Set[int] = set()      # boxes below planes: they touch what the planes do
        self._flights: Dict[int, _Flight] = {}
        self._agenda: Agenda[int] = Agenda()
        # By flying body: the step of the next search for bodies in reach, and those found last.
        self._near: Dict[int, Tuple[int, List[int]]] = {}
        self.body_tables = (self._bodies, self._meets, self._alone, self._moving, self._uneven,
                            self._floors, self._flights, self._agenda)

    def add(self, body: Body) -> None:
        """Register a new body; only bodies that can tilt as they land matter."""
        self._near.clear()
        self._floors |= body.with_role("floor")
        known = (Box, Sphere, Empty) if body.moves else (Box, Sphere, Empty, Plane)
        if not all(isinstance(collision.geometry, known) for part in body.colliders
                   for collision in part.link.collisions):
            self._uneven[body.uid] = None
        if body.moves:
            self._moving.add(body.uid)
            if not body.is_ball and body.base is not None:
                self._bodies[body.uid] = body
                axes = _axes_of(body.parts[0]) if body.rigid else ()
                if axes:
                    self._alone[body.uid] = axes
                self._flights[body.uid] = _Flight(body)
                self._agenda.plan(body.uid, 0)
                self._meets[body.uid] = [(part.index, collision_groups.moving(part.link))
                                         for part in body.colliders]

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Check a body that a command changed: it may fly from the next step on."""
        self._near.clear()
        if body.uid in self._bodies:
            self._flights[body.uid] = _Flight(body)
            self._agenda.plan(body.uid, 0)

    def forget(self, body: Body) -> None:
        super().forget(body)
        self._near.clear()

    def due(self, step: int) -> int:
        """The step of the next check; none if all bodies consist of boxes, spheres and planes.

        Bullet finds all points of two boxes by itself.
        """
        return max(step, self._agenda.next) if self._uneven else FAR

    def flies(self, uid: int, step: int) -> bool:
        """Whether a body certainly touches nothing in this step."""
        flight = self._flights.get(uid)
        return flight is not None and step < flight.arrives

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Find flights periodically, and the contact points of those that end in this step."""
        touches: List[Touch] = []
        self._motions.clear()
        for uid in self._agenda.take(step):
            flight = self._flights.get(uid) or self._find_flight(uid, step)
            if flight is not None:
                touches += self._check_flight(flight, step, dt, gravity)
        if touches:
            self._parameters.request_step_accuracy(_FOR_IMPACTS)
            self._parameters.restore_spacing()
        while touches:
            # Two bodies that land on each other must not be tilted at the same time.
            now: Dict[int, Touch] = {}
            for touch in touches:
                if touch.other not in now:
                    now.setdefault(touch.uid, touch)
            self._points.find(list(now.values()))
            touches = [touch for touch in touches if touch.uid not in now]

    def _find_flight(self, uid: int, step: int) -> Optional[_Flight]:
        """Return a new flight of a body that may fly; a body at rest is checked less often."""
        linear = pybullet.getBaseVelocity(uid)[0]
        if norm(linear) <= _RESTS:
            wait = _SLEEPS_EVERY if linear == _NONE else _RESTS_EVERY
            self._agenda.plan(uid, next_multiple(step + wait, _EVERY))
            return None
        flight = self._flights[uid] = _Flight(self._bodies[uid], on_ground=_BOUNCES)
        return flight

    def _is_on_ground(self, flight: _Flight, step: int) -> bool:
        """Whether a body touches something; then its next check is some steps later."""
        uid = flight.body.uid
        if not any(contact[LOAD] > 0.0 for contact in pybullet.getContactPoints(bodyA=uid)):
            return False
        if flight.on_ground >= _BOUNCES or norm(pybullet.getBaseVelocity(uid)[0]) <= _RESTS:
            del self._flights[uid]
            self._agenda.plan(uid, next_multiple(step + _MOVES_EVERY, _EVERY))
        else:
            self._flights[uid] = _Flight(flight.body, on_ground=flight.on_ground + 1)
            self._agenda.plan(uid, step + _BOUNCE)
        if flight.seen is not None:
            self._recheck_neighbours(uid, step)
        return True

    def _recheck_neighbours(self, uid: int, step: int) -> None:
        """Check the bodies that flew beside a landed one: they may hit it."""
        for other, flight in self._flights.items():
            if uid in flight.beside:
                self._agenda.plan(other, min(self._agenda.at(other), step + 1))
                flight.pairs.pop(uid, None)

    def _check_flight(self, flight: _Flight, step: int, dt: float, gravity: Vec3) -> List[Touch]:
        """Return the deepest contact of a body in this step, if any, and plan its next check."""
        body, uid = flight.body, flight.body.uid
        flew = flight.seen is not None and flies(
            body, flight.seen[1], self._motions.of(uid).linear,
            scale(gravity, dt * (step - flight.seen[0])))
        if not flew and self._is_on_ground(flight, step):
            return []
        here = self._motions.of(uid)
        linear = here.linear
        flight.on_ground = 0
        flight.seen = (step, linear) if body.rigid else None
        flight.beside.clear()
        later = step + _AHEAD
        if tumbles(here.angular, gravity, _TUMBLES):
            flight.pairs, flight.arrives = {}, step
            self._agenda.plan(uid, later)
            return []
        low, high = extent(flight.body)
        fall = norm(gravity) * dt
        spin = norm(here.angular) * norm(subtract(high, low))
        path = _Path(step, dt, here, low, high, fall, spin,
                     norm(linear) + spin + _AHEAD * fall)
        touches: List[Touch] = []
        pairs: Dict[int, Tuple[int, int]] = {}
        until, near = self._near.get(uid, (step, []))
        if until <= step:
            near = self._within(flight, path)
            self._near[uid] = later, near
        for other in near:
            if other in self._moving and other in self._flights and (
                    self._flights[other].seen is not None):
                flight.beside.add(other)   # checked again once the other body has landed
            elif flight.pairs.get(other, (0, 0))[0] > step:
                pairs[other] = flight.pairs[other]
            else:
                pairs[other] = self._check_pair(flight, other, path, touches) or (later, later)
        flight.pairs = pairs
        self._agenda.plan(uid, min([look for look, _ in pairs.values()], default=later))
        flight.arrives = min([free for _, free in pairs.values()], default=later)
        if touches:
            touch = min(touches, key=attrgetter("gap"))
            self._landed(uid, touch.other, touch.normal)
            self._recheck_neighbours(uid, step)
            return [touch]
        return []

    def _check_pair(self, flight: _Flight, other: int, path: _Path, touches: List[Touch],
                    ) -> Optional[Tuple[int, int]]:
        """Return an entry of `_Flight.pairs`, or None; add a contact in this step to `touches`."""
        uid, (step, dt, here, low, high, fall, spin, speed) = flight.body.uid, path
        there = self._motions.of(other)
        way = dt * (speed + norm(there.linear))   # in one step, at most
        points = pybullet.getClosestPoints(uid, other, way * (_AHEAD + 2))
        if not points or way == 0.0:   # without gravity a body at rest stays there
            return None
        nearest = min(points, key=itemgetter(DISTANCE))
        gap: float = nearest[DISTANCE]
        at: Vec3 = nearest[PLACE]
        normal: Vec3 = nearest[NORMAL]
        there_in = dot(there.velocity_at(at), normal)
        speed_in = there_in - dot(here.velocity_at(at), normal)
        nearing = speed_in + spin
        if flight.body.rigid:   # the smaller of two upper bounds for all points of the body
            nearing = min(nearing, there_in - dot(here.linear, normal)
                          + norm(here.angular) * flight.body.radius)
        steps = max(0.0, gap) / max(1e-9, dt * (nearing + _AHEAD * fall))
        free = step + int(min(_AHEAD, steps))
        tilt = self._tilt_beyond_flat(uid, here.orientation, normal)
        if tilt > 0.0:   # it lands on a corner, for which one point is enough
            steps = max(steps, tilt / max(dt * norm(here.angular), tilt / _AHEAD))
        lands = speed_in > max(_SOFT, _SETTLES * fall)
        if gap <= 0.0 and not lands:   # it rests there, or moves away
            steps = max(steps, _BOUNCE)
        if gap <= 0.0 and tilt <= 0.0 and lands and not self._lies_in(flight, other):
            touches.append(Touch(uid, other, gap, nearest[OTHER_PLACE], normal, here,
                                 *extents_across(low, high, normal)))
        return step + max(1, int(min(_AHEAD, steps))), free

    def _tilt_beyond_flat(self, uid: int, turn: Quat, normal: Vec3) -> float:
        """Return the turn, rad, until a body can land on a face or its side; 0 if it can now."""
        axes = self._alone.get(uid)
        if axes is None:
            return 0.0
        own = rotate(conjugate(turn), normal)
        along = min(1.0, max([abs(dot(own, axis)) for axis in axes]))
        tilt = acos(along)
        return max(0.0, (tilt if len(axes) > 1 else min(tilt, asin(along))) - MOST_TILT)

    def _within(self, flight: _Flight, path: _Path) -> List[int]:
        """Return the bodies in reach with which a body may collide, by number."""
        uid, reach = flight.body.uid, path.speed * path.dt * (_AHEAD + 2)
        margin = (reach, reach, reach)
        found = pybullet.getOverlappingObjects(
            subtract(path.low, margin), add(path.high, margin)) or ()
        return sorted({other for other, _ in found if other != uid
                       and other not in self._floors and other not in flight.through
                       and (uid in self._uneven or other in self._uneven)})

    def _lies_in(self, flight: _Flight, other: int) -> bool:
        """Whether an earlier search found a body inside another: the two do not collide."""
        if other in flight.tried:
            flight.through.add(other)
        flight.tried.add(other)
        return other in flight.through


def _axes_of(part: Part) -> Tuple[Vec3, ...]:
    """Return the face normals of a rigid box or cylinder, in the frame of its principal axes."""
    if len(part.link.collisions) != 1:
        return ()
    only = part.link.collisions[0]
    shape = only.geometry
    own = multiply(conjugate(part.link_from_com.orientation), only.pose.orientation)
    if isinstance(shape, Cylinder):
        return (rotate(own, (0.0, 0.0, 1.0)),)
    if isinstance(shape, Box):
        return (rotate(own, (1.0, 0.0, 0.0)), rotate(own, (0.0, 1.0, 0.0)),
                rotate(own, (0.0, 0.0, 1.0)))
    return ()
