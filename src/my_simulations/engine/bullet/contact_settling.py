"""What keeps standing things where they stand.

In the first second after something was put into the world overlaps are parted without giving
velocity: with split impulses Bullet moves rigid bodies apart and
leaves their momentum alone, so that a body that starts in a shelf does not jump out of it, and one
with a large moment of inertia does not turn on for ever. Their price is that Bullet forgets to put
joints back that went past their stops, so that is done here, without velocity too.

With that, contacts may begin with 0.99 of the impulse that they had in the step before. Later the
split impulses end: with them a stack of ten boxes leans by 1 mm a second (measured).

Bullet ends its iterations once no row changes a velocity by more than sqrt(1e-7) m/s, at which a
thing that stands may drift. Contacts of articulated bodies start from nothing in each step (there
is no warm start for them): a parked robot went 1 mm and 0.8 degrees in a minute, or slid where its
wheels were not solved in 50 iterations (measured). While one that touches something is slow, the
world is solved to 3e-8 m/s and with more iterations; one that is slower than 0.01 mm/s is put back
where it was 16 steps ago, or in ten minutes it would turn by 0.1 degrees. Rigid bodies that may not
sleep creep where friction holds them up; while there are such, it is solved to 3e-6 m/s. What
moves, sleeps, or stands on the level costs nothing. Small ones that may not sleep creep on the
level too, for which 3e-4 m/s is much: twenty cards of 2 mm went 2.7 mm apart in 20 s, solved so
0.3 mm.
"""
from __future__ import annotations

from math import dist
from typing import Any, Dict, Optional, Sequence

import pybullet

from ...geometry import Pose, Vec3
from .bodies import Body

JointStates = Sequence[Any]  # as PyBullet tells them

EVERY = 16            # steps between two looks at articulated bodies
_RIGID_EVERY = 256    # and at rigid ones, of which there may be hundreds
_SLOW = 0.02          # m/s and rad/s: of the base, and of all joints
_STILL = 1e-5         # m/s and rad/s: an acceleration of 1e-3 gives more between two looks
_CREEP = 1e-6         # m, or of a quaternion: what else goes so far between two looks was moved
_LEANS = 0.02         # friction by normal force
_SMALL = 0.06         # m, radius: such a body creeps on the level too
_RESIDUALS = (1e-7, 1e-11, 1e-15)  # PyBullet's own; for leaning bodies; for standing robots
_MORE_ITERATIONS = 4
_PARTING = 1.0        # s
_PAST_STOP = 1e-6     # rad or m past a stop that do not matter
_PUT_BACK = 0.5       # share of the way back to the stop at each look


class ContactSettling:
    """Chooses how exactly Bullet solves."""

    def __init__(self) -> None:
        self._trees: Dict[int, Body] = {}
        self._rigid: Dict[int, Body] = {}
        self._kept: Dict[int, Pose] = {}
        self._level = 0
        self._leaning = False
        self._iterations = 50
        self._parting_steps = 1000
        self._new = False                     # something was put in since the last look
        self._until: Optional[int] = None     # the step at which split impulses end

    def configure(self, iterations: int, dt: float) -> None:
        """Tell PyBullet, also after its world was reset; `iterations` are those of the file.

        `dt`: the step size, s.
        """
        self._iterations = iterations
        self._parting_steps = round(_PARTING / dt)
        pybullet.setPhysicsEngineParameter(splitImpulsePenetrationThreshold=0.0)
        self._split(self._new or self._until is not None)
        self._use(self._level)

    def add(self, body: Body) -> None:
        """Know a body; only articulated ones and those that may not sleep matter."""
        self._new = True
        if body.moves and not body.rigid:
            self._trees[body.uid] = body
        elif body.moves and not body.may_sleep:
            self._rigid[body.uid] = body

    def forget(self, body: Body) -> None:
        """A body is gone."""
        self._trees.pop(body.uid, None)
        self._kept.pop(body.uid, None)
        self._rigid.pop(body.uid, None)
        if not self._trees and not self._rigid:
            self._leaning = False
            self._change(0)

    def clear(self) -> None:
        """All bodies are gone."""
        self._trees.clear()
        self._kept.clear()
        self._rigid.clear()
        self._level, self._leaning = 0, False
        self._new, self._until = False, None

    @property
    def idle(self) -> bool:
        """True when no body can need it."""
        return not (self._trees or self._rigid or self._new or self._until is not None)

    def ahead(self, step: int) -> int:
        """Up to the next look."""
        every = EVERY if self._trees or self._until is not None else _RIGID_EVERY
        return every - step % every

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Do nothing after a step."""

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """See now and then whether something stands."""
        if self._new:
            self._new, self._until = False, step + self._parting_steps
            self._split(True)
        if step % EVERY:
            return
        if self._until is not None and step >= self._until:
            self._until = None
            self._split(False)
        if step % _RIGID_EVERY == 0:
            self._leaning = any(_creeps(body) for body in self._rigid.values())
        standing = False
        for body in self._trees.values():
            states = pybullet.getJointStates(body.uid, [axis.index for axis in body.axes]) or ()
            _put_back(body, states)
            stands = _stands(body, states)
            standing = standing or stands
            self._keep(body, states, stands)
        self._change(2 if standing else int(self._leaning))

    def _keep(self, body: Body, states: JointStates, stands: bool) -> None:
        """Put a free body that stands back where it stood at the last look."""
        before = self._kept.pop(body.uid, None)
        if not stands or body.base is None or not _is_slow(body.uid, _STILL) or any(
                abs(state[1]) > _STILL for state in states):
            return
        position, turn = pybullet.getBasePositionAndOrientation(body.uid)
        if before is None or dist(position, before.position) > _CREEP or dist(
                turn, before.orientation) > _CREEP:
            before = Pose(position, turn)
        elif position != before.position or turn != before.orientation:
            pybullet.resetBasePositionAndOrientation(body.uid, *before)
        self._kept[body.uid] = before

    @staticmethod
    def _split(wanted: bool) -> None:
        pybullet.setPhysicsEngineParameter(useSplitImpulse=int(wanted))

    def _change(self, level: int) -> None:
        if level != self._level:
            self._level = level
            self._use(level)

    def _use(self, level: int) -> None:
        pybullet.setPhysicsEngineParameter(
            solverResidualThreshold=_RESIDUALS[level],
            numSolverIterations=self._iterations * (_MORE_ITERATIONS if level == 2 else 1))


def _put_back(body: Body, states: JointStates) -> None:
    """Move joints that are past a stop towards it, their rates unchanged."""
    for axis, (position, rate, *_) in zip(body.axes, states):
        past = position - min(max(position, axis.lower), axis.upper)
        if abs(past) > _PAST_STOP:
            pybullet.resetJointState(body.uid, axis.index, position - _PUT_BACK * past, rate)


def _stands(body: Body, states: JointStates) -> bool:
    """An articulated body is slow, and touches something."""
    if body.base is not None and not _is_slow(body.uid):
        return False
    if any(abs(state[1]) > _SLOW for state in states):
        return False
    return bool(pybullet.getContactPoints(bodyA=body.uid))


def _creeps(body: Body) -> bool:
    """A rigid body is slow, and small, or friction carries a share of its weight."""
    uid = body.uid
    if not _is_slow(uid):
        return False
    if body.radius < _SMALL:
        return True
    normal = along = across = 0.0
    for contact in pybullet.getContactPoints(bodyA=uid):
        normal += contact[9]
        along += abs(contact[10])
        across += abs(contact[12])
    return max(along, across) > _LEANS * normal


def _is_slow(uid: int, most: float = _SLOW) -> bool:
    linear, angular = pybullet.getBaseVelocity(uid)
    return max(map(abs, linear)) <= most and max(map(abs, angular)) <= most
