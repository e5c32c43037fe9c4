"""Prepare impacts: stop fast bodies at surfaces, and find all contact points of landing bodies.

A body that would go deeper than 1.8 mm in a step is moved back before the step by the excess; its
velocity is kept (doc/dev/contacts.md, "Floors"). It arrives a fraction of a step later. A bouncing
body is moved back to the surface itself, with the velocity that it had there. Bullet separates
overlaps at 5 m/s per metre, and this lift adds energy: from 5 m, with steps of 1 ms, each bounce
would be 0.2 % higher than the last one. Small balls use Bullet's continuous collision detection
(CCD) instead.

Bullet finds one contact point per step and pair, and four at once only for two boxes (reasons and
figures: doc/dev/contacts.md, "Landings"). So in the step in which a flying body touches a surface,
`LandingPoints` tilts it back and forth by 2 mrad about the contact, and Bullet detects contacts
after each tilt. The body stays tilted by 0.1 mrad: then the point that the step adds is a corner
too, and does not replace a better one. A body that turns over fast is not checked for landings, and
a box or a cylinder that is too tilted to land flat not before it can have turned that far.

Each body has one plan. A slow body on the ground is checked again when gravity can have made it
fast, and periodically for whether it flies. For a fast or flying body, a search finds the bodies in
reach of the next 16 steps, and the distance to each of these gives the step of the next check. If
two bodies fly side by side, one is checked again once the other has landed.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from math import dist, inf
from operator import attrgetter, itemgetter
from typing import Callable, Dict, List, NamedTuple, Optional, Set, Tuple

import pybullet

from ...description.shapes import Box, Empty, Plane, Sphere
from ...geometry import ZERO3, Vec3, add, dot, norm, scale, subtract
from . import collision_groups
from .agenda import Agenda
from .approach import Motions, extent, flies, tumbles
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .contact_points import DISTANCE, LOAD, NORMAL, OTHER_POINT, POINT
from .flat_landings import flat_axes, tilt_beyond_flat
from .landing_points import Filters, LandingPoints, Touch, extents_across
from .link_states import AT_REST, Motion
from .step_helper import StepHelper
from .surface_coefficients import of_link, restitution
from .world_parameters import LEAST_BOUNCE, Accuracy, WorldParameters

_DEPTH = 1.8e-3         # m: allowed penetration in one step of 1 ms or less
_BOUNCING_DEPTH = 3e-5  # m, for bouncing bodies: below it Bullet may brake by 1e-5 m before contact
_MOST_GROWTH = 3.0      # of the depth for longer steps; without it slow rolling counts as fast
_AHEAD_S = 0.016        # s between two checks of a fast or flying body
_AHEAD = 16             # the same in steps, at most
_MOVES_EVERY = 16       # steps between two checks of whether a body that moves flies
_RESTS_EVERY = 64       # the same for a body at rest
_SELDOM = 256           # steps between two checks of any other body, at most
_REST_SPEED = 0.03      # m/s: a body in free fall is faster after 3 ms
_TOUCHING_EVERY = 8     # steps between two checks of a pair of bodies that touch
_SOFT_SPEED = 2e-3      # m/s: a slower impact does not tilt the body
_FREE_FALL_STEPS = 2.5  # steps of free fall: a body placed at rest on a surface gains less speed
_TUMBLING_RATE = 5.0    # rad/s across gravity: what turns over so fast lands on a corner or an edge
_FOR_IMPACTS = Accuracy(10, 1e-15)
"""With 50 iterations, a block ten times as high as wide keeps turning after it lands at 10 m/s."""


@dataclass
class _Watched:
    """A body that may hit something.

    Attributes:
        arrives: the step before which it can touch only bodies that fly beside it.
        grounded: whether it touched something at its last check.
        last_flight: step of the last check at which it flew, and its velocity then, m/s.
        pairs: by other bodies near it, the step of the next check with that body, and the step
            before which they cannot touch.
    """

    body: Body
    arrives: int = 0
    grounded: bool = False
    last_flight: Optional[Tuple[int, Vec3]] = None
    pairs: Dict[int, Tuple[int, int]] = field(default_factory=dict)


class _Step(NamedTuple):
    """A step of `dt` s.

    Attributes:
        number: the count at which it begins.
        fall: speed that gravity adds in it, m/s.
        ahead: steps between two checks of a body, at most.
        depth: allowed penetration in it of bodies that do not bounce, m.
    """

    number: int
    dt: float
    gravity: Vec3
    fall: float
    ahead: int
    depth: float


@dataclass
class _Path:
    """A body before a step.

    Attributes:
        depth: its allowed penetration in the step, m; inf for a slow body.
        low, high: corners of its bounding box, m.
        radius: of a sphere about its centre of mass that contains it, m.
        speed: upper bound of the speed of its points until the next check, m/s.
        undone: the share of this step to undo; below 0 if the body penetrates less than `depth`.
        touches: the contacts in this step with which it lands.
    """

    motion: Motion
    depth: float
    low: Vec3
    high: Vec3
    radius: float
    speed: float
    undone: float = -inf
    touches: List[Touch] = field(default_factory=list)


class ImpactWatch(StepHelper):
    """Moves bodies back before they go deep, and finds the contact points of landing bodies.

    Args:
        landed: called with the numbers of a landing body and the other one, and the normal.
        parameters: solver parameters of the world.
    """

    events = COMMANDED

    def __init__(self, landed: Callable[[int, int, Vec3], None],
                 parameters: WorldParameters) -> None:
        self._landed = landed
        self._parameters = parameters
        self._watched: Dict[int, _Watched] = {}
        self._agenda: Agenda[int] = Agenda()
        self._filters: Dict[int, Filters] = {}
        self._points = LandingPoints(self._filters)
        self._moving: Set[int] = set()
        self._motions = Motions(self._moving)
        self._bouncing: Set[int] = set()
        self._radii: Dict[int, float] = {}        # of bounding spheres of rigid bodies, m
        self._uneven: Set[int] = set()            # with other shapes than boxes, balls and planes
        self._flat: Dict[int, Tuple[Vec3, ...]] = {}   # normals of flat faces
        self._floors: Set[int] = set()      # boxes below planes: they touch what the planes do
        # By body: the step of the next search for bodies in reach, and those found last.
        self._near: Dict[int, Tuple[int, List[int]]] = {}
        self.body_tables = (self._watched, self._agenda, self._filters, self._moving,
                            self._bouncing, self._radii, self._uneven, self._flat, self._floors)

    def add(self, body: Body) -> None:
        self._near.clear()
        self._floors |= body.with_role("floor")
        known = (Box, Sphere, Empty) if body.moves else (Box, Sphere, Empty, Plane)
        if not all(isinstance(collision.geometry, known) for part in body.colliders
                   for collision in part.link.collisions):
            self._uneven.add(body.uid)
        if not body.moves:
            return
        self._moving.add(body.uid)
        if body.rigid:
            # `radius` reaches the corners of the bounding box; that of a ball is smaller.
            self._radii[body.uid] = body.radius * (3.0 ** -0.5 if body.is_sphere else 1.0)
        if body.base is None or body.uses_ccd and body.is_sphere:
            return
        self._watched[body.uid] = _Watched(body)
        self._agenda.plan(body.uid, 0)
        self._flat[body.uid] = flat_axes(body)
        self._filters[body.uid] = [(part.index, collision_groups.moving(part.link))
                                 for part in body.colliders]
        if any(restitution(of_link(part.link)) > 0.0 for part in body.colliders):
            self._bouncing.add(body.uid)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Check a body that a command changed: it may fly or be fast from the next step on."""
        self._near.clear()
        if body.uid in self._watched:
            self._watched[body.uid] = _Watched(body)
            self._agenda.plan(body.uid, 0)

    def forget(self, body: Body) -> None:
        super().forget(body)
        self._near.clear()

    def due(self, step: int) -> int:
        return max(step, self._agenda.next)

    def flies(self, uid: int, step: int) -> bool:
        """Whether a body certainly touches nothing in this step."""
        watched = self._watched.get(uid)
        return watched is not None and step < watched.arrives

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Check the bodies that are due; prepare the impacts of this step."""
        touches: List[Touch] = []
        self._motions.clear()
        now = _Step(step, dt, gravity, norm(gravity) * dt,
                    max(1, min(_AHEAD, round(_AHEAD_S / dt))),
                    _DEPTH * min(_MOST_GROWTH, max(1.0, dt / 1e-3)))
        for uid in self._agenda.take(step):
            touches += self._check_body(self._watched[uid], now)
        if touches:
            self._parameters.request_step_accuracy(_FOR_IMPACTS)
            self._parameters.restore_spacing()
        while touches:
            # Two bodies that land on each other must not be tilted at the same time.
            free: Dict[int, Touch] = {}
            for touch in touches:
                if touch.other not in free:
                    free.setdefault(touch.uid, touch)
            self._points.find(list(free.values()))
            touches = [touch for touch in touches if touch.uid not in free]

    def _check_body(self, watched: _Watched, now: _Step) -> List[Touch]:
        """Move a body back if it would go deep, and plan its next check.

        Returns its deepest contact in this step if it lands.
        """
        body, uid = watched.body, watched.body.uid
        here = self._motions.of(uid)
        bounces = uid in self._bouncing
        depth = _BOUNCING_DEPTH if bounces else now.depth
        speed, fast = norm(here.linear), depth / now.dt
        if bounces:
            fast = max(fast, LEAST_BOUNCE)
        if speed + now.fall < fast:
            depth = inf
        # Bullet finds all points of two boxes by itself.
        wait = _SELDOM if body.is_sphere or not self._uneven else (
            self._steps_on_ground(watched, here, speed, now))
        if wait and depth == inf:
            gains = max(now.ahead, int((fast - speed) / max(now.fall, 1e-9)))
            check = now.number + min(wait, gains)
            # Checks of many bodies in the same steps cost less.
            together = check - check % _AHEAD
            self._agenda.plan(uid, together if together > now.number else check)
            return []
        low, high = extent(body)
        radius = self._radii.get(uid) or _radius(here.position, low, high)
        path = _Path(here, depth, low, high, radius, speed + now.ahead * now.fall
                     + (0.0 if wait else norm(here.angular) * radius))
        self._agenda.plan(uid, self._check_pairs(watched, path, now, not wait))
        if path.undone > 0.0 or bounces and path.undone > -1.0:
            self._move_back(body, path, now)
        elif path.touches:
            touch = min(path.touches, key=attrgetter("gap"))
            self._landed(uid, touch.other, touch.normal)
            self._recheck_neighbours(uid, now.number)
            return [touch]
        return []

    def _steps_on_ground(self, watched: _Watched, here: Motion, speed: float, now: _Step) -> int:
        """Return the steps until the next check of a body on the ground; 0 if it may land flat."""
        uid, slow = watched.body.uid, speed <= _REST_SPEED
        if slow and watched.grounded:
            return _SELDOM if here.linear == ZERO3 else _RESTS_EVERY
        flew = watched.last_flight is not None and flies(
            watched.body, watched.last_flight[1], here.linear,
            scale(now.gravity, now.dt * (now.number - watched.last_flight[0])))
        if not flew and any(contact[LOAD] > 0.0
                            for contact in pybullet.getContactPoints(bodyA=uid)):
            if watched.last_flight is not None:
                self._recheck_neighbours(uid, now.number)
            self._watched[uid] = _Watched(watched.body, grounded=True)
            return _MOVES_EVERY
        watched.grounded = False
        watched.last_flight = (now.number, here.linear) if watched.body.rigid else None
        if tumbles(here.angular, now.gravity, _TUMBLING_RATE):
            watched.pairs, watched.arrives = {}, now.number
            return _AHEAD
        return 0

    def _recheck_neighbours(self, uid: int, step: int) -> None:
        """Check the bodies near a landed one: they may hit it."""
        for other, watched in self._watched.items():
            if watched.pairs.pop(uid, None):
                self._agenda.plan(other, min(self._agenda.at(other), step + 1))

    def _check_pairs(self, watched: _Watched, path: _Path, now: _Step, lands: bool) -> int:
        """Check a fast or flying body against bodies in reach. Returns the step of the next check.

        `lands`: whether it may land flat.
        """
        uid, later = watched.body.uid, now.number + now.ahead
        until, near = self._near.get(uid, (now.number, []))
        if until <= now.number:
            near = self._within(watched, path, path.speed * now.dt * (now.ahead + 2))
            self._near[uid] = later, near
        pairs: Dict[int, Tuple[int, int]] = {}
        for other in near:
            flat = lands and (uid in self._uneven or other in self._uneven)
            if flat and other in self._watched and self._watched[other].last_flight is not None:
                pairs[other] = later, later   # checked again once the other body has landed
                flat = False
            # Bodies that move together do not collide, and their closest points are expensive.
            stops = path.depth < inf and path.depth < now.dt * (
                now.fall + _nearing(path.motion, self._motions.of(other), path.radius))
            if flat and watched.pairs.get(other, (0, 0))[0] > now.number:
                pairs[other] = watched.pairs[other]
            elif flat or stops:
                pairs[other] = self._check_pair(watched, other, path, now, flat)
        if lands:
            watched.pairs = pairs
            watched.arrives = min([free for _, free in pairs.values()], default=later)
        return min([look for look, _ in pairs.values()], default=later)

    def _within(self, watched: _Watched, path: _Path, reach: float) -> List[int]:
        """Return the bodies in reach, m, with which a body may collide, by number."""
        margin = (reach, reach, reach)
        found = pybullet.getOverlappingObjects(
            subtract(path.low, margin), add(path.high, margin)) or ()
        return sorted({other for other, _ in found} - {watched.body.uid} - self._floors)

    def _check_pair(self, watched: _Watched, other: int, path: _Path, now: _Step, flat: bool,
                    ) -> Tuple[int, int]:
        """Return an entry of `_Watched.pairs`; store in `path` what happens in this step."""
        uid, here, there = watched.body.uid, path.motion, self._motions.of(other)
        step, dt, ahead = now.number, now.dt, now.ahead
        way = dt * (path.speed + norm(there.linear))   # in one step, at most
        apart = dist(here.position, there.position) - path.radius - self._radii.get(other, inf)
        if apart > way:   # a lower bound of the time is enough
            check = step + int(min(ahead, apart / max(way, 1e-9)))
            return check, check
        points = pybullet.getClosestPoints(uid, other, way * (ahead + 2))
        if not points or way == 0.0:   # without gravity a body at rest stays there
            return step + ahead, step + ahead
        nearest = min(points, key=itemgetter(DISTANCE))
        gap: float = nearest[DISTANCE]
        at: Vec3 = nearest[POINT]
        normal: Vec3 = nearest[NORMAL]
        there_in = dot(there.velocity_at(at), normal)
        speed_in = there_in - dot(here.velocity_at(at), normal)
        inward = speed_in - (dot(now.gravity, normal) * dt
                             if there is AT_REST or other not in self._watched else 0.0)
        steps = float(ahead)
        if gap > 0.0 and inward * dt > path.depth:
            steps = gap / way
            if gap < inward * dt:
                path.undone = max(path.undone, 1.0 - (gap + path.depth) / (inward * dt))
        if not flat:
            return step + max(1, int(min(ahead, steps))), step + ahead
        nearing = there_in - dot(here.linear, normal) + norm(here.angular) * path.radius
        free = max(0.0, gap) / max(1e-9, dt * (nearing + ahead * now.fall))
        tilt = tilt_beyond_flat(self._flat[uid], here.orientation, normal)
        turning = tilt / max(dt * norm(here.angular), tilt / ahead) if tilt > 0.0 else 0.0
        if gap > 0.0:
            steps = min(steps, max(free, turning))
        elif speed_in <= max(_SOFT_SPEED, _FREE_FALL_STEPS * now.fall):   # it rests, or moves away
            steps = min(ahead, max(_TOUCHING_EVERY, turning))
        elif tilt > 0.0:   # it lands on a corner, for which one point is enough
            steps = turning
        else:
            steps = 1.0
            path.touches.append(Touch(uid, other, gap, nearest[OTHER_POINT], normal, here,
                                      *extents_across(path.low, path.high, normal)))
        return step + max(1, int(steps)), step + int(min(ahead, free))

    def _move_back(self, body: Body, path: _Path, now: _Step) -> None:
        """Undo the share `path.undone` of the step that follows."""
        here, dt, undone = path.motion, now.dt, path.undone
        linear = here.linear
        gain = scale(now.gravity, dt)
        end = add(here.position, scale(add(linear, gain), (1.0 - undone) * dt))
        if body.uid in self._bouncing:
            # Restitution of an articulated body includes what gravity adds in the next step.
            linear = subtract(linear, scale(gain, undone + (0.0 if body.rigid else 1.0)))
        start = subtract(end, scale(add(linear, gain), dt))
        pybullet.resetBasePositionAndOrientation(body.uid, start, here.orientation)
        pybullet.resetBaseVelocity(body.uid, linear, here.angular)  # setting the pose resets it
        self._motions.forget(body.uid)


def _nearing(one: Motion, other: Motion, radius: float) -> float:
    """Return an upper bound, m/s, of the approach speed of points within `radius`, m."""
    return norm(subtract(one.linear, other.linear)) + norm(one.angular) * radius + (
        norm(other.angular) * (dist(one.position, other.position) + radius))


def _radius(centre: Vec3, low: Vec3, high: Vec3) -> float:
    """Return the largest distance of a point in a box from a point in it, m."""
    x, y, z = (max(b - c, c - a) for a, b, c in zip(low, high, centre))
    return norm((x, y, z))
