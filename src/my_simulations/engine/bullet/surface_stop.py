"""Lets what falls fast reach a surface, not go deep into it.

A body of 10 m/s moves 1 cm in a step, and Bullet solves an impact only once bodies overlap: a box
that fell 5 m was 6 mm deep in the floor for a step. So in the step in which a body would go deeper
than 1.8 mm, it is put back by as much of its way beforehand; its velocity stays. It arrives a part
of a step later.

A body that bounces is put back to the surface itself, with the velocity that it had there. Bullet
pushes bodies out of overlaps at 5 m/s for each metre, and a body that is lifted by what it fell too
deep gains energy: each bounce would be 0.2 % higher than the last one, from 5 m with steps of 1 ms.

Bodies are asked for their speed no sooner than gravity can have made them fast, and those that are
fast, what is ahead, no sooner than they can be there. Small balls are swept along their way (CCD).
"""
from __future__ import annotations

from heapq import heappop, heappush
from math import dist, inf
from typing import Dict, List, NamedTuple, Set, Tuple

import pybullet

from ...description.shapes import Plane
from ...geometry import Vec3, add, cross, dot, norm, scale, subtract
from .approach import extent
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .step_helper import FAR, StepHelper
from .surface_coefficients import of_link, restitution
from .world_parameters import LEAST_BOUNCE

_DEEP = 1.8e-3   # m: the depth that a body may reach in one step of 1 ms or less
_LEAST = 3e-5    # m: bodies that overlap less may slow down by 1e-5 m a step before they touch
_DEEPEST = 3.0   # times as deep in longer steps, at most: otherwise slow rolling counts as fast
_AHEAD_S = 0.016 # s for which a fast body looks ahead
_AHEAD = 16      # steps for which it does, at most
_SELDOM = 256    # steps between two looks at a slow one, at most


class _Motion(NamedTuple):
    """Of a body: its centre of mass, velocity (m/s) and angular velocity (rad/s)."""

    centre: Vec3
    linear: Vec3
    angular: Vec3

    @classmethod
    def of(cls, uid: int) -> "_Motion":
        return cls(pybullet.getBasePositionAndOrientation(uid)[0], *pybullet.getBaseVelocity(uid))

    def radius(self, low: Vec3, high: Vec3) -> float:
        """The most that a point between two corners is away from the centre, m."""
        x, y, z = self.centre
        return norm((max(high[0] - x, x - low[0]), max(high[1] - y, y - low[1]),
                     max(high[2] - z, z - low[2])))

    def nearing(self, other: "_Motion", radius: float) -> float:
        """The most by which points of both near each other, m/s, within `radius` of this one."""
        return norm(subtract(self.linear, other.linear)) + norm(self.angular) * radius + (
            norm(other.angular) * (dist(self.centre, other.centre) + radius))

    def at(self, place: Vec3) -> Vec3:
        """The velocity of a point, as if joints stood still, m/s."""
        return add(self.linear, cross(self.angular, subtract(place, self.centre)))


_STILL = _Motion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class SurfaceStop(StepHelper):
    """Takes back a part of the last step of what lands on something."""

    events = COMMANDED

    def __init__(self) -> None:
        self._bodies: Dict[int, Body] = {}
        self._moving: Set[int] = set()
        self._bouncing: Set[int] = set()
        self._radii: Dict[int, float] = {}        # of spheres that hold rigid bodies, m
        self._floors: Set[int] = set()            # the boxes below planes
        self._next: Dict[int, int] = {}           # the step of the next look, by body
        self._seen: Dict[int, _Motion] = {}       # of other bodies, in this step
        self._looks: List[Tuple[int, int]] = []   # a heap of them; those that are not next are old

    def add(self, body: Body) -> None:
        """Know a new body."""
        if not body.moves:
            planes = [one for part in body.parts for one in part.link.collisions
                      if isinstance(one.geometry, Plane)]
            self._floors.update(body.uids[1:2 * len(planes):2])
            return
        self._moving.add(body.uid)
        if body.base is not None and not (body.swept and body.is_ball):
            self._bodies[body.uid] = body
            self._plan(body.uid, 0)
            if any(restitution(of_link(part.link)) > 0.0 for part in body.colliders):
                self._bouncing.add(body.uid)
        if body.rigid:
            # The radius holds the corners of the box about a body: a ball's is shorter.
            self._radii[body.uid] = body.radius * (3.0 ** -0.5 if body.is_ball else 1.0)

    def forget(self, body: Body) -> None:
        """A body is gone."""
        self._bodies.pop(body.uid, None)
        self._radii.pop(body.uid, None)
        self._next.pop(body.uid, None)
        self._moving.discard(body.uid)
        self._bouncing.discard(body.uid)
        self._floors.difference_update(body.uids)

    def clear(self) -> None:
        """All bodies are gone."""
        for table in (self._bodies, self._next, self._radii):
            table.clear()
        for group in (self._moving, self._bouncing, self._floors):
            group.clear()
        self._looks.clear()

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """A command reached a body: it may be fast from now on."""
        if body.uid in self._bodies:
            self._plan(body.uid, 0)

    def due(self, step: int) -> int:
        """The next look."""
        while self._looks and self._is_old(*self._looks[0]):
            heappop(self._looks)
        return max(step, self._looks[0][0]) if self._looks else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Look at those whose turn it is, and put back what would go deep in this step."""
        now: List[int] = []
        while self._looks and self._looks[0][0] <= step:
            look = heappop(self._looks)
            if not self._is_old(*look):
                now.append(look[1])
                del self._next[look[1]]
        self._seen.clear()
        for uid in sorted(now):
            self._plan(uid, step + self._look(self._bodies[uid], dt, gravity))

    def _plan(self, uid: int, step: int) -> None:
        if self._next.get(uid) != step:
            self._next[uid] = step
            heappush(self._looks, (step, uid))

    def _is_old(self, step: int, uid: int) -> bool:
        return self._next.get(uid) != step

    def _look(self, body: Body, dt: float, gravity: Vec3) -> int:
        """Put a body back if need be. Returns how many steps later to look again."""
        linear, angular = pybullet.getBaseVelocity(body.uid)
        bounces = body.uid in self._bouncing
        deep = _LEAST if bounces else _DEEP * min(_DEEPEST, max(1.0, dt / 1e-3))
        speed, fall = norm(linear), norm(gravity) * dt
        fast = max(deep / dt, LEAST_BOUNCE) if bounces else deep / dt
        ahead = max(1, min(_AHEAD, round(_AHEAD_S / dt)))
        if speed + fall < fast:
            return min(_SELDOM, max(ahead, int((fast - speed) / max(fall, 1e-9))))
        here = _Motion(pybullet.getBasePositionAndOrientation(body.uid)[0], linear, angular)
        ahead, late = self._way(body, here, ahead, deep, dt, gravity)
        if late > 0.0 or bounces and late > -1.0:
            at, turn = pybullet.getBasePositionAndOrientation(body.uid)
            end = add(at, scale(add(linear, scale(gravity, dt)), (1.0 - late) * dt))
            if bounces:
                # Restitution of an articulated body includes what gravity adds in the next step.
                linear = subtract(linear, scale(gravity, late * dt + (0.0 if body.rigid else dt)))
            start = subtract(end, scale(add(linear, scale(gravity, dt)), dt))
            pybullet.resetBasePositionAndOrientation(body.uid, start, turn)
            pybullet.resetBaseVelocity(body.uid, linear, angular)  # placing a body stops it
            self._seen.pop(body.uid, None)
        return ahead

    def _way(self, body: Body, here: _Motion, ahead: int, deep: float, dt: float, gravity: Vec3,
             ) -> Tuple[int, float]:
        """Steps (at most `ahead`) for which nothing is reached, and the share of this one to undo.

        `deep`: the depth to arrive at, m. The share is below 0 for a body that arrives less deep,
        -inf for one that does not arrive in this step.
        """
        uid, late, fall = body.uid, -inf, norm(gravity) * dt
        speed = norm(here.linear) + ahead * fall   # the most that it has meanwhile
        reach, radius = speed * dt * (ahead + 2), self._radii.get(uid, 0.0)
        (x, y, z), around = here.centre, radius + reach
        low, high = (x - around, y - around, z - around), (x + around, y + around, z + around)
        if not body.is_ball:
            low, high = extent(body)
            radius = here.radius(low, high)
            low = (low[0] - reach, low[1] - reach, low[2] - reach)
            high = (high[0] + reach, high[1] + reach, high[2] + reach)
        near = pybullet.getOverlappingObjects(low, high) or ()
        for other in sorted({pair[0] for pair in near} - {uid} - self._floors):
            there = self._motion(other) if other in self._moving else _STILL
            nearing = (here.nearing(there, radius) + fall) * dt
            # What falls or slides together is no danger, and finding its nearest points is dear.
            if nearing <= deep:
                continue
            towards = speed + norm(there.linear)
            apart = dist(here.centre, there.centre) - radius - self._radii.get(other, inf)
            if apart > nearing:   # not in this step: when it may be there is enough to know
                ahead = min(ahead, max(1, int(apart / (towards * dt))))
                continue
            points = pybullet.getClosestPoints(uid, other, towards * dt * (ahead + 2))
            if not points:
                continue
            nearest = min(points, key=_depth)
            gap, normal = nearest[8], nearest[7]
            if gap <= 0.0 or gap > ahead * towards * dt:
                continue
            inward = dot(subtract(there.at(nearest[5]), here.at(nearest[5])), normal)
            if there is _STILL or other not in self._bodies:
                inward -= dot(gravity, normal) * dt
            if inward * dt > deep:
                ahead = min(ahead, max(1, int(gap / (towards * dt))))
                if gap < inward * dt:
                    late = max(late, 1.0 - (gap + deep) / (inward * dt))
        return ahead, late

    def _motion(self, uid: int) -> _Motion:
        """The motion of a body in this step."""
        found = self._seen.get(uid)
        if found is None:
            found = self._seen[uid] = _Motion.of(uid)
        return found


def _depth(point: Tuple[float, ...]) -> float:
    """The distance at a closest point, m, below 0 for an overlap."""
    return point[8]
