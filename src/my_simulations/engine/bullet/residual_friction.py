"""Remove friction that Bullet leaves at contacts without load.

Bullet's solver for rigid bodies solves the friction of a contact only while its normal impulse is
above zero (btSequentialImpulseConstraintSolver::solveSingleIteration). If a contact has a load in
an early iteration and none in the last one, the friction impulse of the early one remains. After
the step this module reads such impulses, and removes their effect on the velocities (figures:
doc/dev/contacts.md, "Friction").

Bullet starts each step with the impulses of the one before, including these. The friction of a body
at rest is corrected only if it is more than mu N. If such a body has no velocity that friction
could act against, its contact points are dropped: the next step starts without impulses.

Only sliding bodies are checked: those that move and do not tumble, fly, roll on one line, or lie in
a pile. The selection depends on the step count and their state only, so runs repeat bit for bit.
"""
from __future__ import annotations

from math import inf
from operator import itemgetter
from typing import Callable, Dict, List, Sequence, Set

import pybullet

from ...geometry import ZERO3, Vec3, add, conjugate, cross, dot, norm, rotate, scale, subtract
from ..body_plan import BASE
from . import collision_groups
from .agenda import Agenda
from .approach import tumbles
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .contact_points import (
    BODY,
    DIRECTION,
    DISTANCE,
    FRICTION,
    LOAD,
    OTHER_BODY,
    OTHER_LINK,
    OTHER_POINT,
    POINT,
    ContactPoint,
    LinkKey,
    friction_force,
)
from .friction_across import FrictionAcross
from .link_states import Motion, motion
from .step_helper import StepHelper, next_multiple
from .surface_coefficients import is_direction_dependent, of_link

_EVERY = 8            # checks are at multiples of this number of steps
_FAST_EVERY = 16      # steps between two checks of a body that slides fast
_EACH_EVERY = 16      # the same for a body that is corrected in each step, as it may come to rest
_SELDOM_AFTER = 8     # such checks without a correction: then a fast body is checked seldom
_SLOW_EVERY = 128     # steps between two checks of all other bodies that move
_REST_EVERY = 512     # the same for a body at rest
_FAST = 2e-3          # m/s, or rad/s: slower bodies may be at rest
_MAY_STOP = 0.5       # m/s: slower bodies are checked in each step, as such friction may stop them
_STUCK = 2e-5         # m/s: a smaller slip has no direction
_ABOVE_LIMIT = 1.001  # of mu N: more friction violates Coulomb's law
_TUMBLES = 1.5        # rad/s across gravity: the slip of a body that turns over is not predictable
_MOST_CONTACTS = 8    # a body with more that touches a moving body, or two bodies, is in a pile
_OTHER_BODY = itemgetter(OTHER_BODY)

# Classes of bodies by their contacts:
_FLIES, _PILED, _SLIDES, _CORRECTED = range(4)


class ResidualFriction(StepHelper):
    """Corrects the velocities of sliding rigid bodies after each step.

    Args:
        rolls: returns whether a rigid body is a cylinder that rolls on its side.
    """

    events = COMMANDED | {BodyEvent.STATE_SET}

    def __init__(self, rolls: Callable[[int], bool]) -> None:
        self._rolls = rolls
        self._across = FrictionAcross()
        self._bodies: Dict[int, Body] = {}
        self._trees: Set[int] = set()
        self._moving: Set[int] = set()
        self._agenda: Agenda[int] = Agenda()
        self._fast: Dict[int, None] = {}
        self._each_step: Dict[int, int] = {}   # checks since the last correction
        self._new: Set[int] = set()            # changed by a command since the last step
        self._mu: Dict[LinkKey, float] = {}    # of surfaces with one coefficient
        self.body_tables = (self._bodies, self._trees, self._moving, self._agenda, self._fast,
                            self._each_step, self._new, self._mu, self._across.forces,
                            self._across.last)

    def add(self, body: Body) -> None:
        """Register a new body; only rigid ones that move and can have several contacts matter."""
        self._mu.update({(uid, part.index): part.mu for uid, part in body.surfaces
                         if not is_direction_dependent(of_link(part.link))})
        if not body.moves:
            return
        self._moving.add(body.uid)
        if not body.rigid:
            self._trees.add(body.uid)
            return
        self._bodies[body.uid] = body
        if not body.is_sphere:
            self._new.add(body.uid)
            self._agenda.plan(body.uid, 0)

    @property
    def fast(self) -> List[int]:
        """The bodies that slide now, as of their last check."""
        return list(self._fast)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Check a body in each step after a command changed its pose or velocity."""
        uid = body.uid
        if event is BodyEvent.STATE_SET:
            self._across.forces.pop(uid, None)
        elif uid in self._bodies and not body.is_sphere:
            self._fast[uid], self._each_step[uid] = None, 1
            self._new.add(uid)
            self._agenda.plan(uid, 0)

    def due(self, step: int) -> int:
        """Each step while bodies are corrected, otherwise the step of the next check."""
        if self._each_step or self._across.forces:
            return step
        return max(step, self._agenda.next)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Apply the forces that compensate friction across the slip."""
        if self._across.forces or self._across.last:
            self._across.apply()

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Correct bodies after the step that began at count `step`; periodically check others."""
        seen: Set[int] = set()
        for uid in list(self._each_step):
            found = self._correct(uid, seen, dt)
            if found == _CORRECTED:
                self._each_step[uid] = 0
            elif found != _SLIDES or uid not in self._new and self._rolls(uid):
                del self._each_step[uid]
                if found == _FLIES:
                    self._fast[uid] = None
                else:
                    self._fast.pop(uid, None)
                if found != _PILED:
                    self._agenda.plan(uid, next_multiple(step + _FAST_EVERY, _EVERY))
        for uid in self._agenda.take(step):
            wait = self._check_interval(uid, seen, dt, gravity)
            self._agenda.plan(uid, next_multiple(step + wait, _EVERY))
        self._new.clear()

    # -- selection -------------------------------------------------------------------------------

    def _check_interval(self, uid: int, seen: Set[int], dt: float, gravity: Vec3) -> int:
        """Decide how often to check a body. Returns the steps until the next check.

        Bodies that slide slowly, or were corrected in the last 128 steps, are checked in each step.
        """
        if uid in self._new:
            return _SLOW_EVERY
        if self._rolls(uid):
            self._fast.pop(uid, None)
            self._each_step.pop(uid, None)
            return _FAST_EVERY
        linear, angular = pybullet.getBaseVelocity(uid)
        speed = max(dot(linear, linear), dot(angular, angular))
        checks = self._each_step.get(uid, _SELDOM_AFTER if uid in self._fast else 0)
        corrected = self._each_step.get(uid) == 0
        rests = speed <= _FAST * _FAST and not corrected and (
            speed == 0.0 or not self._is_held(uid))
        if rests or tumbles(angular, gravity, _TUMBLES):
            self._fast.pop(uid, None)
            soon = self._each_step.pop(uid, None) is not None
            return _REST_EVERY if speed == 0.0 else _FAST_EVERY if soon else _SLOW_EVERY
        if checks < _SELDOM_AFTER or speed < _MAY_STOP * _MAY_STOP:
            self._fast[uid], self._each_step[uid] = None, checks + 1
            return _EACH_EVERY
        if self._each_step.pop(uid, None) is not None:
            return _FAST_EVERY
        found = self._correct(uid, seen, dt)
        if found == _CORRECTED:
            self._each_step[uid] = 0
        elif found == _PILED:
            del self._fast[uid]
        return _FAST_EVERY if found in (_FLIES, _SLIDES) else _SLOW_EVERY

    # -- correction ------------------------------------------------------------------------------

    def _is_held(self, uid: int) -> bool:
        """Whether residual friction holds a slow body against Coulomb's law."""
        contacts = pybullet.getContactPoints(bodyA=uid)
        return (len(contacts) <= _MOST_CONTACTS and any(map(_is_residual, contacts))
                and self._is_beyond_mu(uid, contacts))

    def _is_beyond_mu(self, uid: int, contacts: Sequence[ContactPoint]) -> bool:
        """Whether the friction of any surface on a body exceeds mu N."""
        loads: Dict[LinkKey, float] = {}
        frictions: Dict[LinkKey, Vec3] = {}
        for contact in contacts:
            if contact[DISTANCE] > 0.0:
                continue
            node = (contact[OTHER_BODY], contact[OTHER_LINK])
            loads[node] = loads.get(node, 0.0) + contact[LOAD]
            frictions[node] = add(frictions.get(node, ZERO3), friction_force(contact))
        mu = self._mu.get((uid, BASE), inf)
        return any(norm(frictions[node]) > _ABOVE_LIMIT * load * min(mu, self._mu[node])
                   for node, load in loads.items() if node in self._mu)

    def _correct(self, uid: int, seen: Set[int], dt: float) -> int:
        """Undo the residual friction at the contacts of a body. Returns the class of the body."""
        contacts = pybullet.getContactPoints(uid)
        if not contacts:
            return _FLIES
        neighbours = self._moving.intersection(map(_OTHER_BODY, contacts))
        if len(neighbours) > 1:
            return _PILED
        pushed = bool(neighbours) and not neighbours.isdisjoint(self._trees) and (
            self._across.update(uid, contacts, neighbours, dt))
        if neighbours and len(contacts) > _MOST_CONTACTS:
            return _CORRECTED if pushed else _PILED
        residual = [each for each in contacts if each[LOAD] <= 0.0 and _is_residual(each)]
        if not residual or len(contacts) > _MOST_CONTACTS:
            return _CORRECTED if pushed else _SLIDES
        # Bodies with joints use another solver, which leaves no such friction.
        if not neighbours.isdisjoint(seen | self._trees):
            residual = [each for each in residual if each[OTHER_BODY] not in neighbours]
        if residual:
            linear, angular = pybullet.getBaseVelocity(uid)
            if max(dot(linear, linear), dot(angular, angular)) <= _FAST * _FAST:
                if not self._is_beyond_mu(uid, contacts):
                    return _CORRECTED if pushed else _SLIDES
                if norm(linear) < _STUCK:
                    collision_groups.moving(self._bodies[uid].parts[0].link).set(uid, BASE)
                    return _CORRECTED
        for contact in residual:
            self._undo_friction(contact, dt)
        seen.add(uid)
        return _CORRECTED if residual or pushed else _SLIDES

    def _undo_friction(self, contact: ContactPoint, dt: float) -> None:
        """Undo the friction impulses of one contact; the first direction opposes the slip."""
        uid, other = contact[BODY], contact[OTHER_BODY]
        along: Vec3 = contact[DIRECTION]
        ours = motion(uid, BASE)
        theirs = motion(other, BASE) if other in self._bodies else None
        velocity = ours.velocity_at(contact[POINT])
        if theirs is not None:
            velocity = subtract(velocity, theirs.velocity_at(contact[OTHER_POINT]))
        sign = dt if (dot(velocity, along) > 0.0) == (contact[FRICTION] > 0.0) else -dt
        impulse = scale(friction_force(contact), sign)
        _push(self._bodies[uid], ours, impulse, contact[POINT])
        if theirs is not None:
            _push(self._bodies[other], theirs, scale(impulse, -1.0), contact[OTHER_POINT])


def _push(body: Body, before: Motion, impulse: Vec3, at: Vec3) -> None:
    """Apply an impulse, N s, to a rigid body at a point."""
    part = body.parts[0]
    own = rotate(conjugate(before.orientation), cross(subtract(at, before.position), impulse))
    gained = rotate(before.orientation, (own[0] / part.moments[0], own[1] / part.moments[1],
                                         own[2] / part.moments[2]))
    pybullet.resetBaseVelocity(body.uid, (
        before.linear[0] + impulse[0] / part.mass, before.linear[1] + impulse[1] / part.mass,
        before.linear[2] + impulse[2] / part.mass), add(before.angular, gained))


def _is_residual(contact: ContactPoint) -> bool:
    """Whether a contact without load has friction.

    Contacts of separated surfaces are excluded: their forces are of an older step.
    """
    return contact[LOAD] <= 0.0 and contact[FRICTION] != 0.0 and contact[DISTANCE] <= 0.0
