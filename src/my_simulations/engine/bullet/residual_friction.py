"""Remove friction that Bullet leaves at contacts without load.

Bullet's solver for rigid bodies solves the friction of a contact only while its normal impulse is
above zero (btSequentialImpulseConstraintSolver::solveSingleIteration). If a contact has a load in
an early iteration and none in the last one, the friction impulse of the early one remains: a unit
cube that slides on a box stops 18 % too early with mu 0.8, and 26 % with mu 1. After the step this
module reads such impulses, and removes their effect on the velocities; an error of 1 % remains.

Bullet starts each step with the impulses of the one before, including these: a cube that is pushed
with 1.15 mu N does not move. The friction of a body at rest is corrected only if it is
more than mu N. If such a body has no velocity that friction could act against, its contact points
are dropped: the next step starts without impulses.

Only sliding bodies are checked: those that move and do not tumble, fly, roll on one line, or lie in
a pile. The selection depends on the step count and their state only, so runs repeat bit for bit.
"""
from __future__ import annotations

from math import inf
from typing import Callable, Dict, List, Optional, Sequence, Set, Tuple

import pybullet

from ...geometry import Vec3, add, conjugate, cross, dot, norm, rotate, scale, subtract
from ..body_plan import BASE
from . import collision_groups
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
    OTHER_PLACE,
    PLACE,
    ContactPoint,
    LinkKey,
    friction_force,
)
from .link_states import Motion, motion
from .step_helper import FAR, StepHelper, looks_until_turn, turn_of
from .surface_coefficients import directed, of_link

EVERY = 8
"""Steps between two checks of the fast bodies."""

_FAST_ROUNDS = 2   # checks until the contacts of each fast body were read
_ROUNDS = 16       # checks until the speed of each moving body was read
_SLOW_ROUNDS = 64  # the same for those found at rest
_FAST = 2e-3       # m/s, or rad/s: slower bodies may be at rest
_MAY_STOP = 0.5    # m/s: slower bodies are checked in each step, as such friction may stop them
_STUCK = 2e-5      # m/s: a smaller slip has no direction
_BEYOND = 1.001    # of mu N: more friction violates Coulomb's law
_TUMBLES = 1.5     # rad/s across gravity: the slip of a body that turns over is not predictable
_CLEAR = 24        # checks for which a body that flies far from others is left out
_REACH = 0.02      # m: contacts exist a little before surfaces meet
_KEPT = 16         # checks for which a body is read in each step, once it slides or was corrected
_MOST_CONTACTS = 8 # a body with more that touches a moving body, or two bodies, is in a pile
_SOON = -1         # instead of a check number: the next check is not known yet
_NONE = (0.0, 0.0, 0.0)

# Classes of bodies by their contacts:
_FLIES, _PILED, _SLIDES, _MENDED = range(4)


class ResidualFriction(StepHelper):
    """Corrects the velocities of sliding rigid bodies after each step.

    Args:
        rolls: returns whether a rigid body is a cylinder that rolls on its side.
    """

    events = COMMANDED

    def __init__(self, rolls: Callable[[int], bool]) -> None:
        self._rolls = rolls
        self._bodies: Dict[int, Body] = {}
        self._trees: Set[int] = set()
        self._moving: Set[int] = set()
        self._watched: Dict[int, None] = {}
        self._fast: Dict[int, None] = {}
        self._mended: Dict[int, int] = {}   # until which check
        self._asleep: Set[int] = set()
        self._clear: Dict[int, int] = {}    # until which check
        self._planes: Set[int] = set()
        self._mu: Dict[LinkKey, float] = {}    # of surfaces with one coefficient
        self._rounds: Optional[Tuple[List[int], List[int]]] = None

    def add(self, body: Body) -> None:
        """Register a new body; only rigid ones that move and can have several contacts matter."""
        self._mu.update({(uid, part.index): part.mu for uid, part in body.surfaces
                         if not directed(of_link(part.link))})
        if not body.moves:
            self._planes |= body.with_role("plane")  # infinite; a box below has the same contacts
            return
        self._moving.add(body.uid)
        if not body.rigid:
            self._trees.add(body.uid)
            return
        self._bodies[body.uid] = body
        if not body.is_ball:
            self._watched[body.uid] = None
            self._rounds = None

    @property
    def fast(self) -> List[int]:
        """The bodies that slide now, as of their last check."""
        return list(self._fast)

    def forget(self, body: Body) -> None:
        """Discard the data of a removed body."""
        for table in (self._bodies, self._watched, self._fast, self._mended, self._clear):
            table.pop(body.uid, None)
        for group in (self._moving, self._trees, self._asleep, self._planes):
            group.difference_update(body.uids)
        for uid, part in body.surfaces:
            self._mu.pop((uid, part.index), None)
        self._rounds = None

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Check a body soon after a command changed its pose or velocity."""
        if body.uid in self._watched:
            self._fast[body.uid] = None
            self._mended[body.uid] = _SOON
            self._clear.pop(body.uid, None)
            if body.uid in self._asleep:
                self._asleep.discard(body.uid)
                self._rounds = None

    def due(self, step: int) -> int:
        """Each step while bodies are corrected, otherwise the step of the next check."""
        if not self._watched:
            return FAR
        if self._mended:
            return step
        look = -(-step // EVERY)
        awake, asleep = self._lists()
        return EVERY * (look + min(looks_until_turn(len(awake), look, _ROUNDS),
                                   looks_until_turn(len(asleep), look, _SLOW_ROUNDS),
                                   looks_until_turn(len(self._fast), look, _FAST_ROUNDS)))

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Correct bodies after the step that began at count `step`; periodically check others."""
        look = step // EVERY
        seen: Set[int] = set()
        flying = [uid for uid in list(self._mended)
                  if not self._keep_on(uid, self._mend(uid, seen, dt), look)]
        if step % EVERY == 0:
            flying += self._look(look, seen, dt, gravity)
        for uid in flying:
            self._look_ahead(uid, look, dt, gravity)

    # -- selection -------------------------------------------------------------------------------

    def _keep_on(self, uid: int, found: int, look: int) -> bool:
        """Decide whether to check a body in each step. Returns False if it flies."""
        until = self._mended[uid]
        if found == _SLIDES and until != _SOON and self._rolls(uid):
            found = _PILED
        if found == _MENDED:
            self._mended[uid] = look + _KEPT
        elif found == _SLIDES and until == _SOON:
            self._mended[uid] = look + _KEPT
        elif found != _SLIDES or look > until:
            del self._mended[uid]
            if found == _PILED:
                self._fast.pop(uid, None)
        return found != _FLIES

    def _look(self, look: int, seen: Set[int], dt: float, gravity: Vec3) -> List[int]:
        """Check the bodies that are due. Returns those that fly."""
        awake, asleep = self._lists()
        flying = [uid for uid in turn_of(awake, look, _ROUNDS) + turn_of(
            asleep, look, _SLOW_ROUNDS) if not self._ask(uid, look, gravity)]
        for uid in turn_of(list(self._fast), look, _FAST_ROUNDS):
            if uid in self._mended:
                continue
            found = self._mend(uid, seen, dt)
            if found == _MENDED:
                self._mended[uid] = look + _KEPT
            elif found == _PILED:
                del self._fast[uid]
            elif found == _FLIES:
                flying.append(uid)
        return flying

    def _lists(self) -> Tuple[List[int], List[int]]:
        """Return the bodies whose speed is checked: those that moved when last checked, others."""
        if self._rounds is None:
            self._rounds = ([uid for uid in self._watched if uid not in self._asleep],
                            [uid for uid in self._watched if uid in self._asleep])
        return self._rounds

    def _ask(self, uid: int, look: int, gravity: Vec3) -> bool:
        """Classify a body as fast, slow or at rest. Returns False if it flew until now."""
        until = self._clear.pop(uid, None)
        if until is not None and until > look:
            self._clear[uid] = until
            return True
        linear, angular = pybullet.getBaseVelocity(uid)
        speed = max(dot(linear, linear), dot(angular, angular))
        if (speed == 0.0) != (uid in self._asleep):
            (self._asleep.add if speed == 0.0 else self._asleep.discard)(uid)
            self._rounds = None
        rests = speed <= _FAST * _FAST and self._mended.get(uid, look) <= look
        if (rests and (speed == 0.0 or not self._is_held(uid))
                or _tumbles(angular, gravity) or self._rolls(uid)):
            self._fast.pop(uid, None)
            self._mended.pop(uid, None)
        elif until is not None:
            return False
        elif uid not in self._fast or speed < _MAY_STOP * _MAY_STOP:
            self._fast[uid] = None
            self._mended[uid] = look + _KEPT
        return True

    def _look_ahead(self, uid: int, look: int, dt: float, gravity: Vec3) -> None:
        """Skip a flying body while no other body is near its path; otherwise check it often."""
        centre = pybullet.getBasePositionAndOrientation(uid)[0]
        linear = pybullet.getBaseVelocity(uid)[0]
        reach, span = self._bodies[uid].radius + _REACH, (_CLEAR + _ROUNDS) * EVERY * dt
        ways = [v * span + g * span * span / 2.0 for v, g in zip(linear, gravity)]
        rise = norm(gravity) * span * span / 8.0  # largest height of a parabola above its chord
        low = [c + min(0.0, way) - reach - rise for c, way in zip(centre, ways)]
        high = [c + max(0.0, way) + reach + rise for c, way in zip(centre, ways)]
        near = pybullet.getOverlappingObjects(low, high) or ()
        if all(other == uid or other in self._planes for other, _ in near):
            self._clear[uid] = look + _CLEAR
            self._fast.pop(uid, None)
        else:
            self._fast[uid] = None

    # -- correction ------------------------------------------------------------------------------

    def _is_held(self, uid: int) -> bool:
        """Whether residual friction holds a slow body against Coulomb's law."""
        contacts = pybullet.getContactPoints(bodyA=uid)
        return (len(contacts) <= _MOST_CONTACTS and any(map(_is_left, contacts))
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
            frictions[node] = add(frictions.get(node, _NONE), friction_force(contact))
        mu = self._mu.get((uid, BASE), inf)
        return any(norm(frictions[node]) > _BEYOND * load * min(mu, self._mu[node])
                   for node, load in loads.items() if node in self._mu)

    def _mend(self, uid: int, seen: Set[int], dt: float) -> int:
        """Undo the residual friction at the contacts of a body. Returns the class of the body."""
        contacts = pybullet.getContactPoints(bodyA=uid)
        if not contacts:
            return _FLIES
        if len(contacts) > _MOST_CONTACTS:
            return _PILED if any(each[OTHER_BODY] in self._moving for each in contacts) else _SLIDES
        neighbours = {each[OTHER_BODY] for each in contacts} & self._moving
        if len(neighbours) > 1:
            return _PILED
        # Bodies with joints use another solver, which leaves no residual friction.
        left = [each for each in contacts if each[LOAD] <= 0.0 and _is_left(each)]
        if neighbours and left and not neighbours.isdisjoint(seen | self._trees):
            left = [each for each in left if each[OTHER_BODY] not in neighbours]
        if left:
            linear, angular = pybullet.getBaseVelocity(uid)
            if max(dot(linear, linear), dot(angular, angular)) <= _FAST * _FAST:
                if not self._is_beyond_mu(uid, contacts):
                    return _SLIDES
                if norm(linear) < _STUCK:
                    collision_groups.moving(self._bodies[uid].parts[0].link).set(uid, BASE)
                    return _MENDED
        for contact in left:
            self._take_back(contact, dt)
        seen.add(uid)
        return _MENDED if left else _SLIDES

    def _take_back(self, contact: ContactPoint, dt: float) -> None:
        """Undo the friction impulses of one contact; the first direction opposes the slip."""
        uid, other = contact[BODY], contact[OTHER_BODY]
        along: Vec3 = contact[DIRECTION]
        ours = motion(uid, BASE)
        theirs = motion(other, BASE) if other in self._bodies else None
        velocity = ours.velocity_at(contact[PLACE])
        if theirs is not None:
            velocity = subtract(velocity, theirs.velocity_at(contact[OTHER_PLACE]))
        sign = dt if (dot(velocity, along) > 0.0) == (contact[FRICTION] > 0.0) else -dt
        impulse = scale(friction_force(contact), sign)
        _push(self._bodies[uid], ours, impulse, contact[PLACE])
        if theirs is not None:
            _push(self._bodies[other], theirs, scale(impulse, -1.0), contact[OTHER_PLACE])


def _push(body: Body, before: Motion, impulse: Vec3, at: Vec3) -> None:
    """Apply an impulse, N s, to a rigid body at a point."""
    part = body.parts[0]
    own = rotate(conjugate(before.orientation), cross(subtract(at, before.position), impulse))
    gained = rotate(before.orientation, (own[0] / part.moments[0], own[1] / part.moments[1],
                                         own[2] / part.moments[2]))
    pybullet.resetBaseVelocity(body.uid, (
        before.linear[0] + impulse[0] / part.mass, before.linear[1] + impulse[1] / part.mass,
        before.linear[2] + impulse[2] / part.mass), add(before.angular, gained))


def _is_left(contact: ContactPoint) -> bool:
    """Whether a contact without load has friction.

    Contacts of separated surfaces are excluded: their forces are of an older step.
    """
    return contact[LOAD] <= 0.0 and contact[FRICTION] != 0.0 and contact[DISTANCE] <= 0.0


def _tumbles(angular: Vec3, gravity: Vec3) -> bool:
    """Whether a body turns over; rotation about the vertical does not count."""
    pull = norm(gravity)
    about = dot(angular, gravity) / pull if pull > 0.0 else 0.0
    return dot(angular, angular) - about * about > _TUMBLES * _TUMBLES
