"""Stop fast bodies at the surface that they hit, before they penetrate it deeply.

If a body would go deeper than 1.8 mm in a step, it is moved back before the step by the excess; its
velocity is kept (doc/dev/contacts.md, "Floors"). It arrives a fraction of a step later.

A bouncing body is moved back to the surface itself, with the velocity that it had there. Bullet
separates overlaps at 5 m/s per metre, and this lift adds energy: from 5 m, with steps of 1 ms, each
bounce would be 0.2 % higher than the last one.

The speed of a slow body is checked again when gravity can have made it fast. The surroundings of a
fast body are checked again when it can have reached something. Small balls use Bullet's continuous
collision detection (CCD) instead.
"""
from __future__ import annotations

from math import dist, inf
from operator import itemgetter
from typing import Dict, Set, Tuple

import pybullet

from ...geometry import Vec3, add, dot, norm, scale, subtract
from .agenda import Agenda
from .approach import Motions, extent
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .contact_points import DISTANCE, NORMAL, PLACE
from .link_states import AT_REST, Motion
from .step_helper import StepHelper
from .surface_coefficients import of_link, restitution
from .world_parameters import LEAST_BOUNCE

_DEEP = 1.8e-3   # m: allowed penetration in one step of 1 ms or less
_LEAST = 3e-5    # m, for bouncing bodies: below it Bullet may brake by 1e-5 m a step before contact
_DEEPEST = 3.0   # largest factor of the depth for longer steps, else slow rolling counts as fast
_AHEAD_S = 0.016 # s between two checks of a fast body
_AHEAD = 16      # the same in steps, at most
_SELDOM = 256    # steps between two checks of a slow body, at most


class SurfaceStop(StepHelper):
    """Moves bodies back before the step in which they would penetrate a surface."""

    events = COMMANDED

    def __init__(self) -> None:
        self._bodies: Dict[int, Body] = {}
        self._moving: Set[int] = set()
        self._bouncing: Set[int] = set()
        self._radii: Dict[int, float] = {}        # of bounding spheres of rigid bodies, m
        self._floors: Set[int] = set()            # boxes below planes
        self._agenda: Agenda[int] = Agenda()
        self._motions = Motions(self._moving)
        self.body_tables = (self._bodies, self._radii, self._agenda, self._moving, self._bouncing,
                            self._floors)

    def add(self, body: Body) -> None:
        if not body.moves:
            self._floors |= body.with_role("floor")
            return
        self._moving.add(body.uid)
        if body.base is not None and not (body.swept and body.is_ball):
            self._bodies[body.uid] = body
            self._agenda.plan(body.uid, 0)
            if any(restitution(of_link(part.link)) > 0.0 for part in body.colliders):
                self._bouncing.add(body.uid)
        if body.rigid:
            # `radius` reaches the corners of the bounding box; that of a ball is smaller.
            self._radii[body.uid] = body.radius * (3.0 ** -0.5 if body.is_ball else 1.0)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Check a body that a command changed: it may be fast from the next step on."""
        if body.uid in self._bodies:
            self._agenda.plan(body.uid, 0)

    def due(self, step: int) -> int:
        return max(step, self._agenda.next)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Check the bodies that are due; move back those that would go deep in this step."""
        self._motions.clear()
        for uid in self._agenda.take(step):
            self._agenda.plan(uid, step + self._check_body(self._bodies[uid], dt, gravity))

    def _check_body(self, body: Body, dt: float, gravity: Vec3) -> int:
        """Move a body back if it would go deep. Returns the steps until its next check."""
        here = self._motions.of(body.uid)
        linear, angular = here.linear, here.angular
        bounces = body.uid in self._bouncing
        deep = _LEAST if bounces else _DEEP * min(_DEEPEST, max(1.0, dt / 1e-3))
        speed, fall = norm(linear), norm(gravity) * dt
        fast = max(deep / dt, LEAST_BOUNCE) if bounces else deep / dt
        ahead = max(1, min(_AHEAD, round(_AHEAD_S / dt)))
        if speed + fall < fast:
            return min(_SELDOM, max(ahead, int((fast - speed) / max(fall, 1e-9))))
        ahead, late = self._steps_to_contact(body, here, ahead, deep, dt, gravity)
        if late > 0.0 or bounces and late > -1.0:
            end = add(here.position, scale(add(linear, scale(gravity, dt)), (1.0 - late) * dt))
            if bounces:
                # Restitution of an articulated body includes what gravity adds in the next step.
                linear = subtract(linear, scale(gravity, late * dt + (0.0 if body.rigid else dt)))
            start = subtract(end, scale(add(linear, scale(gravity, dt)), dt))
            pybullet.resetBasePositionAndOrientation(body.uid, start, here.orientation)
            pybullet.resetBaseVelocity(body.uid, linear, angular)  # setting the pose resets it
            self._motions.forget(body.uid)
        return ahead

    def _steps_to_contact(self, body: Body, here: Motion, ahead: int, deep: float, dt: float,
                          gravity: Vec3) -> Tuple[int, float]:
        """Return the steps (at most `ahead`) until contact, and the share of this step to undo.

        `deep`: the allowed penetration, m. The share is below 0 if the body penetrates less, and
        -inf if it does not reach a surface in this step.
        """
        uid, late, fall = body.uid, -inf, norm(gravity) * dt
        speed = norm(here.linear) + ahead * fall   # largest speed until then
        reach, radius = speed * dt * (ahead + 2), self._radii.get(uid, 0.0)
        (x, y, z), around = here.position, radius + reach
        low, high = (x - around, y - around, z - around), (x + around, y + around, z + around)
        if not body.is_ball:
            low, high = extent(body)
            radius = _radius(here.position, low, high)
            low = (low[0] - reach, low[1] - reach, low[2] - reach)
            high = (high[0] + reach, high[1] + reach, high[2] + reach)
        near = pybullet.getOverlappingObjects(low, high) or ()
        for other in sorted({pair[0] for pair in near} - {uid} - self._floors):
            there = self._motions.of(other)
            nearing = (_nearing(here, there, radius) + fall) * dt
            # Bodies that move together do not collide, and their closest points are expensive.
            if nearing <= deep:
                continue
            towards = speed + norm(there.linear)
            apart = dist(here.position, there.position) - radius - self._radii.get(other, inf)
            if apart > nearing:   # not in this step: a lower bound of the time is enough
                ahead = min(ahead, max(1, int(apart / (towards * dt))))
                continue
            points = pybullet.getClosestPoints(uid, other, towards * dt * (ahead + 2))
            if not points:
                continue
            nearest = min(points, key=itemgetter(DISTANCE))
            gap, normal = nearest[DISTANCE], nearest[NORMAL]
            if gap <= 0.0 or gap > ahead * towards * dt:
                continue
            at = nearest[PLACE]
            inward = dot(subtract(there.velocity_at(at), here.velocity_at(at)), normal)
            if there is AT_REST or other not in self._bodies:
                inward -= dot(gravity, normal) * dt
            if inward * dt > deep:
                ahead = min(ahead, max(1, int(gap / (towards * dt))))
                if gap < inward * dt:
                    late = max(late, 1.0 - (gap + deep) / (inward * dt))
        return ahead, late


def _radius(centre: Vec3, low: Vec3, high: Vec3) -> float:
    """Return the largest distance of a point in a box from a point in it, m."""
    x, y, z = (max(b - c, c - a) for a, b, c in zip(low, high, centre))
    return norm((x, y, z))


def _nearing(one: Motion, other: Motion, radius: float) -> float:
    """Return an upper bound, m/s, of the approach speed of points within `radius`, m."""
    return norm(subtract(one.linear, other.linear)) + norm(one.angular) * radius + (
        norm(other.angular) * (dist(one.position, other.position) + radius))
