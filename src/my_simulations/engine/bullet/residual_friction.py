"""Takes away friction that Bullet leaves at contacts which carry nothing.

Bullet's solver for rigid bodies solves the friction of a contact only while its normal impulse is
above zero (btSequentialImpulseConstraintSolver::solveSingleIteration). A contact that carries
something in an early iteration and nothing in the last one keeps the friction of the early one: a
unit cube with mu 0.8 that slides on a box stops 18 % too early, with mu 1 26 %. After the step such
impulses are known, and their effect on the velocities is taken back: 1 % remains.

Only fast bodies are looked at, and only those where something was found in every step. Which they
are follows from the step count and their state alone, so runs repeat bit for bit.
"""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Set, Tuple

import pybullet

from ...geometry import Vec3, conjugate, cross, rotate
from .bodies import Body

EVERY = 8
"""Steps between two looks at the fast bodies."""

_FAST_ROUNDS = 2   # looks until every fast body was asked for its contacts
_ROUNDS = 16       # looks until every moving body was asked for its speed
_SLOW_ROUNDS = 64  # the same for those found at rest
_FAST = 0.05       # m/s, or rad/s: slower ones lose nothing that one sees
_KEPT = 16         # looks for which a body is asked in every step, once fast or after a find
_MOST_CONTACTS = 8 # a body with more lies in a pile, where nobody knows how far it should slide
_SOON = -1         # instead of a look: it is not known yet which comes next
_NONE = (0.0, 0.0, 0.0)


class ResidualFriction:
    """Mends the velocities of sliding rigid bodies after each step."""

    def __init__(self) -> None:
        self._bodies: Dict[int, Body] = {}
        self._trees: Set[int] = set()
        self._watched: Dict[int, None] = {}
        self._fast: Dict[int, None] = {}
        self._mended: Dict[int, int] = {}   # until which look
        self._asleep: Set[int] = set()
        self._rounds: Optional[Tuple[List[int], List[int]]] = None

    def add(self, body: Body) -> None:
        """Know a new body; only rigid ones that move and can have several contacts matter."""
        if not body.moves:
            return
        if not body.rigid:
            self._trees.add(body.uid)
            return
        self._bodies[body.uid] = body
        if not body.is_ball:
            self._watched[body.uid] = None
            self._rounds = None

    def forget(self, body: Body) -> None:
        """A body is gone."""
        for table in (self._bodies, self._watched, self._fast, self._mended):
            table.pop(body.uid, None)
        self._trees.discard(body.uid)
        self._asleep.discard(body.uid)
        self._rounds = None

    def clear(self) -> None:
        """All bodies are gone."""
        for table in (self._bodies, self._watched, self._fast, self._mended):
            table.clear()
        self._trees.clear()
        self._asleep.clear()
        self._rounds = None

    @property
    def idle(self) -> bool:
        """True when no body can need it."""
        return not self._watched

    @property
    def busy(self) -> bool:
        """True when bodies are mended in every step, not only looked at now and then."""
        return bool(self._mended)

    def touched(self, body: Body) -> None:
        """A body was put somewhere or given another velocity: it is looked at soon."""
        if body.uid in self._watched:
            self._fast[body.uid] = None
            self._mended[body.uid] = _SOON

    def after(self, step: int, dt: float) -> None:
        """Mend what the step that began at count `step` left, and look around now and then."""
        look = step // EVERY
        seen: Set[int] = set()
        for uid in list(self._mended):
            if self._mend(uid, seen, dt):
                self._mended[uid] = look + _KEPT
            elif self._mended[uid] == _SOON:
                self._mended[uid] = look + _KEPT
            elif look > self._mended[uid]:
                del self._mended[uid]
        if step % EVERY == 0:
            self._look(look, seen, dt)

    # -- who needs it ----------------------------------------------------------------------------

    def _look(self, look: int, seen: Set[int], dt: float) -> None:
        if self._rounds is None:
            self._rounds = ([uid for uid in self._watched if uid not in self._asleep],
                            [uid for uid in self._watched if uid in self._asleep])
        awake, asleep = self._rounds
        for uid in awake[look % _ROUNDS::_ROUNDS] + asleep[look % _SLOW_ROUNDS::_SLOW_ROUNDS]:
            self._ask(uid, look)
        for uid in list(self._fast)[look % _FAST_ROUNDS::_FAST_ROUNDS]:
            if uid not in self._mended and self._mend(uid, seen, dt):
                self._mended[uid] = look + _KEPT

    def _ask(self, uid: int, look: int) -> None:
        """Find out whether a body is fast, slow or at rest."""
        linear, angular = pybullet.getBaseVelocity(uid)
        # Products become infinite where `** 2` raises OverflowError, which would end the engine.
        speed = max(sum(value * value for value in linear),
                    sum(value * value for value in angular))
        if (speed == 0.0) != (uid in self._asleep):
            (self._asleep.add if speed == 0.0 else self._asleep.discard)(uid)
            self._rounds = None
        if speed <= _FAST * _FAST:
            self._fast.pop(uid, None)
            self._mended.pop(uid, None)
        elif uid not in self._fast:
            self._fast[uid] = None
            self._mended[uid] = look + _KEPT

    # -- mending ---------------------------------------------------------------------------------

    def _mend(self, uid: int, seen: Set[int], dt: float) -> bool:
        """Take back what was left at the contacts of a body. Returns True when there was any."""
        found = False
        contacts = pybullet.getContactPoints(bodyA=uid)
        if len(contacts) > _MOST_CONTACTS:
            return False
        for contact in contacts:
            # What lies apart was not solved in this step, its forces are older ones.
            if contact[9] > 0.0 or contact[10] == 0.0 or contact[8] > 0.0:
                continue
            other = contact[2]
            if other in seen or other in self._trees:
                continue  # those with joints go through another solver, which leaves nothing
            self._take_back(uid, other, contact, dt)
            found = True
        seen.add(uid)
        return found

    def _take_back(self, uid: int, other: int, contact: Tuple[Any, ...], dt: float) -> None:
        """Undo the friction impulse of one contact: it acts against the slip of each body."""
        ours = self._motion(uid, contact[5])
        theirs = self._motion(other, contact[6])
        along: Vec3 = contact[11]
        slip = sum((a - b) * d for a, b, d in zip(ours[1], theirs[1], along))
        size = abs(contact[10]) * dt * (1.0 if slip > 0.0 else -1.0)
        impulse = (along[0] * size, along[1] * size, along[2] * size)
        self._push(uid, impulse, ours[0])
        self._push(other, (-impulse[0], -impulse[1], -impulse[2]), theirs[0])

    def _motion(self, uid: int, at: Vec3) -> Tuple[Vec3, Vec3]:
        """The arm from a body's centre of mass to a point, and the point's velocity."""
        if uid not in self._bodies:
            return _NONE, _NONE
        centre = pybullet.getBasePositionAndOrientation(uid)[0]
        (vx, vy, vz), angular = pybullet.getBaseVelocity(uid)
        arm = (at[0] - centre[0], at[1] - centre[1], at[2] - centre[2])
        turn = cross(angular, arm)
        return arm, (vx + turn[0], vy + turn[1], vz + turn[2])

    def _push(self, uid: int, impulse: Vec3, arm: Vec3) -> None:
        """Change the velocities of a body by an impulse, N s, that attacks at `arm`."""
        body = self._bodies.get(uid)
        if body is None:
            return
        part = body.parts[0]
        (vx, vy, vz), (wx, wy, wz) = pybullet.getBaseVelocity(uid)
        turn = pybullet.getBasePositionAndOrientation(uid)[1]
        own = rotate(conjugate(turn), cross(arm, impulse))
        ax, ay, az = rotate(turn, (own[0] / part.moments[0], own[1] / part.moments[1],
                                   own[2] / part.moments[2]))
        pybullet.resetBaseVelocity(
            uid, (vx + impulse[0] / part.mass, vy + impulse[1] / part.mass,
                  vz + impulse[2] / part.mass), (wx + ax, wy + ay, wz + az))

