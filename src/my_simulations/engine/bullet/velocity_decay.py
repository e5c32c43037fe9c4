"""Apply velocity_decay of SDFormat.

Gazebo's ODE reduces the velocities of a link by this share in each step, before other forces act.
For joint-free bodies Bullet's damping d has the same effect: it leaves (1 - d) ** dt of a velocity.
But if little of it is left after one second, d rounds to 1, and this module reduces the velocity.
For links of articulated bodies it applies the force and torque with this effect on a free link.
"""
from __future__ import annotations

from typing import Dict, Tuple

import pybullet

from ...geometry import Vec3, conjugate, rotate, scale
from ..body_plan import BASE
from .bodies import Body, Part
from .link_states import motion
from .step_helper import FAR, StepHelper

_LEAST_LEFT = 1e-9   # of a velocity after 1 s; the share of a step is exact to 1e-7 of dt, in s


class VelocityDecay(StepHelper):
    """Slows links down in every step, before anything else acts on them."""

    def __init__(self) -> None:
        self._dt = 0.0
        self._links: Dict[int, Tuple[Body, Part, float, float]] = {}

    def configure(self, step_size: float) -> None:
        """Use another step size, s, for bodies that are added from now on."""
        self._dt = step_size

    def add(self, body: Body) -> None:
        """Register a body, or update it after a change of the step size."""
        for part in body.parts if body.moves else ():
            link = part.link
            linear, angular = min(1.0, link.linear_decay), min(1.0, link.angular_decay)
            if body.rigid and (linear or angular):
                linear, angular = _damp(body, linear, angular, self._dt)
            self._links.pop(part.row, None)
            if linear or angular:
                self._links[part.row] = (body, part, linear, angular)

    def forget(self, body: Body) -> None:
        for part in body.parts:
            self._links.pop(part.row, None)

    def due(self, step: int) -> int:
        """Each step, when a link is slowed down."""
        return step if self._links else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Act in the next step, of `dt` s."""
        for body, part, linear_share, angular_share in self._links.values():
            if body.rigid:
                _slow_down(body.uid, linear_share, angular_share)
            else:
                _apply_damping(body.uid, part, linear_share / dt, angular_share / dt)


def _damp(body: Body, linear: float, angular: float, dt: float) -> Tuple[float, float]:
    """Set Bullet's damping of a rigid body; returns the shares that it cannot take off."""
    most = 1.0 - _LEAST_LEFT ** dt
    taken = [share if 0.0 <= share <= most else 0.0 for share in (linear, angular)]
    damping = [1.0 - (1.0 - share) ** (1.0 / dt) for share in taken]
    pybullet.changeDynamics(body.uid, BASE, linearDamping=damping[0], angularDamping=damping[1])
    body.angular_velocity_kept = 1.0 - taken[1]
    return linear - taken[0], angular - taken[1]


def _slow_down(uid: int, linear_share: float, angular_share: float) -> None:
    """Take shares off the velocities of a rigid body."""
    linear, angular = pybullet.getBaseVelocity(uid)
    if any(linear) or any(angular):
        pybullet.resetBaseVelocity(uid, scale(linear, 1.0 - linear_share),
                                   scale(angular, 1.0 - angular_share))


def _apply_damping(uid: int, part: Part, linear_rate: float, angular_rate: float) -> None:
    """Let a force and a torque act against the velocities of a link, by rates in 1/s."""
    at, turn, linear, angular = motion(uid, part.index)
    if linear_rate:
        pybullet.applyExternalForce(uid, part.index, scale(linear, -linear_rate * part.mass), at,
                                    pybullet.WORLD_FRAME)
    if angular_rate:
        own = rotate(conjugate(turn), angular)
        torque = tuple(i * w for i, w in zip(part.moments, own))
        pybullet.applyExternalTorque(
            uid, part.index,
            scale(rotate(turn, (torque[0], torque[1], torque[2])), -angular_rate),
            pybullet.WORLD_FRAME)
