"""Conserve the angular momentum of articulated bodies that tumble freely.

Bullet's gyroscopic terms add momentum and energy: a body that turns at 10 rad/s gains 6 % and 13 %
in 20 s. Joint forces do not change the momentum L about the common centre of mass. So after free
steps the missing angular velocity is added to the whole body. Bullet has updated the attitude with
the velocity I^-1 L of the end of a step instead of its middle, which would reduce the energy over
time. So the body is turned back by half of the difference.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, Set

import numpy as np
import pybullet

from ...geometry import multiply, normalised
from ..body_plan import BASE
from .bodies import Body
from .link_states import motion, motions

_FAST = 2.0  # rad/s


@dataclass
class Whole:
    """Centre of mass of a body, its velocity, and angular momentum and inertia about it."""

    centre: np.ndarray
    speed: np.ndarray
    momentum: np.ndarray
    inertia: np.ndarray


class GyroscopicArticulated:
    """Corrects free, fast articulated bodies periodically.

    The errors add up over the steps, so one correction after a series of free steps is enough.
    """

    def __init__(self) -> None:
        self._bodies: Dict[int, Body] = {}
        self._then: Dict[int, Whole] = {}

    def add(self, body: Body) -> None:
        """Register a body, except one joined to the world, turned by gravity, or damped."""
        if (not body.rigid and body.moves and body.base is not None
                and all(part.gravity and not part.link.linear_decay and not part.link.angular_decay
                        for part in body.parts)):
            self._bodies[body.uid] = body

    def forget(self, body: Body) -> None:
        """Discard the data of a removed body."""
        self._bodies.pop(body.uid, None)
        self._then.pop(body.uid, None)

    def moved(self, body: Body) -> None:
        """Discard the recorded state of a body whose pose or velocity was set."""
        self._then.pop(body.uid, None)

    @property
    def idle(self) -> bool:
        """True if no body can need a correction."""
        return not self._bodies

    @property
    def busy(self) -> bool:
        """True while a body is checked in each step."""
        return bool(self._then)

    def mend(self, dt: float) -> None:
        """Correct bodies that moved freely since the last call, and find those that turn fast."""
        for uid, then in self._then.items():
            _mend(self._bodies[uid], then, dt)
        self._then = {uid: _whole(body) for uid, body in self._bodies.items()
                      if not body.ties and _is_fast(uid)}

    def after(self, loaded: Set[int]) -> None:
        """Drop bodies with contacts or loads in the last step. `loaded`: rows of loaded links."""
        for uid in list(self._then):
            body = self._bodies[uid]
            if (body.ties or any(part.row in loaded for part in body.parts)
                    or pybullet.getContactPoints(bodyA=uid)):
                del self._then[uid]


def _mend(body: Body, then: Whole, dt: float) -> None:
    now = _whole(body)
    try:
        ahead = (np.linalg.solve(now.inertia, then.momentum)
                 - np.linalg.solve(then.inertia, then.momentum)) * dt / 2
        back = _turn_of(-ahead)
        inertia = back @ now.inertia @ back.T
        missing = np.linalg.solve(inertia, then.momentum - back @ now.momentum)
    except np.linalg.LinAlgError:  # all mass on a line: about it there is no inertia
        return
    _correct(body.uid, now.centre, now.speed, back, -ahead, missing)


def _correct(uid: int, centre: np.ndarray, speed: np.ndarray, back: np.ndarray,
             angle: np.ndarray, missing: np.ndarray) -> None:
    """Turn a body about its centre of mass, and its velocities along, and add a turning rate."""
    position, turn = pybullet.getBasePositionAndOrientation(uid)
    linear, angular = (np.array(v) for v in pybullet.getBaseVelocity(uid))
    arm = back @ (np.array(position) - centre)
    small = normalised((angle[0] / 2, angle[1] / 2, angle[2] / 2, 1.0))
    pybullet.resetBasePositionAndOrientation(uid, (centre + arm).tolist(), multiply(small, turn))
    pybullet.resetBaseVelocity(
        uid, (speed + back @ (linear - speed) + np.cross(missing, arm)).tolist(),
        (back @ angular + missing).tolist())


def _turn_of(angle: np.ndarray) -> np.ndarray:
    """The matrix of a small rotation, to second order as exact as a unit quaternion is."""
    small = normalised((angle[0] / 2, angle[1] / 2, angle[2] / 2, 1.0))
    return np.array(pybullet.getMatrixFromQuaternion(small)).reshape(3, 3)


def _is_fast(uid: int) -> bool:
    x, y, z = pybullet.getBaseVelocity(uid)[1]
    return x * x + y * y + z * z > _FAST * _FAST


def _whole(body: Body) -> Whole:
    base, hung = body.parts[0], body.parts[1:]
    states = [motion(body.uid, BASE), *motions(body.uid, [part.index for part in hung])]
    mass = np.array([part.mass for part in (base, *hung)])
    at, speed, spin = (np.array([state[n] for state in states]) for n in (0, 2, 3))
    turns = np.array([pybullet.getMatrixFromQuaternion(state[1]) for state in states])
    axes = turns.reshape(-1, 3, 3)
    own = (axes * np.array([part.moments for part in (base, *hung)])[:, None, :]
           ) @ axes.transpose(0, 2, 1)
    centre = mass @ at / mass.sum()
    drift = mass @ speed / mass.sum()
    arm, moving = at - centre, speed - drift
    momentum = (np.einsum("nij,nj->i", own, spin)
                + (mass[:, None] * np.cross(arm, moving)).sum(axis=0))
    spread = np.einsum("n,ni,nj->ij", mass, arm, arm)
    return Whole(centre, drift, momentum, own.sum(axis=0) + np.trace(spread) * np.eye(3) - spread)
