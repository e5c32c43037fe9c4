"""Keeps the angular momentum of bodies that tumble freely.

Bullet integrates the gyroscopic torque to first order: a body with three different moments that
turns at 10 rad/s loses 3 to 5 % of its momentum and 10 % of its energy in 20 s. Without torque the
momentum L = R I R^T w stays (Euler's equations), so the attitude follows q' = w(q) q / 2 with
w = R I^-1 R^T L alone: after a free step it is put where Runge-Kutta 4 says.

Only bodies that turn fast are looked at in each step; which they are is asked now and then.
"""
from __future__ import annotations

from typing import Callable, Dict, List, Set, Tuple

import pybullet

from ...geometry import Quat, Vec3, conjugate, multiply, normalised, rotate
from .bodies import Body
from .gyroscopic_articulated import GyroscopicArticulated
from .step_helper import FAR, next_multiple

_EVERY = 16        # steps between two looks for fast bodies
_FAST = 1.0        # rad/s
_ROUND = 0.02      # relative difference of moments that is none

Free = Tuple[int, Quat, Vec3]
"""A body before a step: uid, attitude of its principal axes, momentum in world axes."""


class GyroscopicRigid:
    """Corrects free, fast bodies after each step: asymmetric rigid ones, and articulated ones."""

    def __init__(self, loaded: Callable[[], Set[int]]) -> None:
        """`loaded` tells the rows of links that a load acts on in this step."""
        self._loaded = loaded
        self._free: List[Free] = []
        self._moments: Dict[int, Vec3] = {}
        self._bodies: Dict[int, Body] = {}
        self._fast: List[int] = []
        self._trees = GyroscopicArticulated()

    def add(self, body: Body) -> None:
        """Know a body; only rigid, moving ones with different moments matter."""
        moments = body.parts[0].moments
        if body.rigid and body.moves and max(moments) - min(moments) > _ROUND * max(moments):
            self._moments[body.uid] = moments
            self._bodies[body.uid] = body
        self._trees.add(body)

    def forget(self, body: Body) -> None:
        """A body is gone."""
        self._moments.pop(body.uid, None)
        self._bodies.pop(body.uid, None)
        self._fast = [uid for uid in self._fast if uid != body.uid]
        self._free = []
        self._trees.forget(body)

    def clear(self) -> None:
        """All bodies are gone."""
        self._moments.clear()
        self._bodies.clear()
        self._fast.clear()
        self._free.clear()
        self._trees.clear()

    def moved(self, body: Body) -> None:
        """A body was put somewhere, or given another velocity."""
        self._trees.moved(body)

    def due(self, step: int) -> int:
        """Each step while something turns fast, else the next look."""
        if self._fast or self._trees.busy:
            return step
        return FAR if not self._moments and self._trees.idle else next_multiple(step, _EVERY)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """See now and then who turns fast, and note their momentum."""
        if step % _EVERY == 0:
            self._fast = [uid for uid in self._moments if _is_fast(uid)]
            self._trees.mend(dt)
        self._free = [self._momentum(uid) for uid in self._fast]

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Give the bodies that met nothing the attitude and velocity of their momentum."""
        if not (self._free or self._trees.busy):
            return
        loaded = self._loaded()
        self._trees.after(loaded)
        for uid, turn, momentum in self._free:
            body = self._bodies[uid]
            if (body.ties or body.parts[0].row in loaded
                    or pybullet.getContactPoints(bodyA=uid)):
                continue
            moments = self._moments[uid]
            turn = _turned(turn, momentum, moments, dt)
            linear = pybullet.getBaseVelocity(uid)[0]  # first: placing a body stops it
            pybullet.resetBasePositionAndOrientation(
                uid, pybullet.getBasePositionAndOrientation(uid)[0], turn)
            pybullet.resetBaseVelocity(uid, linear, _velocity(turn, momentum, moments))

    def _momentum(self, uid: int) -> Free:
        turn: Quat = pybullet.getBasePositionAndOrientation(uid)[1]
        own = rotate(conjugate(turn), pybullet.getBaseVelocity(uid)[1])
        a, b, c = self._moments[uid]
        return uid, turn, rotate(turn, (own[0] * a, own[1] * b, own[2] * c))


def _is_fast(uid: int) -> bool:
    x, y, z = pybullet.getBaseVelocity(uid)[1]
    return x * x + y * y + z * z > _FAST * _FAST


def _velocity(turn: Quat, momentum: Vec3, moments: Vec3) -> Vec3:
    """w = R I^-1 R^T L, world axes."""
    own = rotate(conjugate(turn), momentum)
    return rotate(turn, (own[0] / moments[0], own[1] / moments[1], own[2] / moments[2]))


def _turned(turn: Quat, momentum: Vec3, moments: Vec3, dt: float) -> Quat:
    """The attitude `dt` s later."""

    def rate(q: Quat) -> Quat:
        x, y, z = _velocity(normalised(q), momentum, moments)
        return multiply((0.5 * x, 0.5 * y, 0.5 * z, 0.0), q)

    def ahead(slope: Quat, span: float) -> Quat:
        return (turn[0] + span * slope[0], turn[1] + span * slope[1], turn[2] + span * slope[2],
                turn[3] + span * slope[3])

    k1 = rate(turn)
    k2 = rate(ahead(k1, dt / 2))
    k3 = rate(ahead(k2, dt / 2))
    k4 = rate(ahead(k3, dt))
    slope = tuple(a + 2 * b + 2 * c + d for a, b, c, d in zip(k1, k2, k3, k4))
    return normalised(ahead((slope[0], slope[1], slope[2], slope[3]), dt / 6))
