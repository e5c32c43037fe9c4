"""Joint axes: limits, friction, damping, and no hidden motors."""
from __future__ import annotations

import math
from typing import List, Optional, Protocol, Tuple

import pybullet

from ...description.model import INFINITE, JointAxis, Model
from .bodies import Axis, Body
from .implicit_axes import ImplicitAxes

_LIMIT_FORCE = 1e6         # N or N m a kilogram: holds 1000 kg at its stop (100 a kg falls through)
_EXPLICIT_DAMPING = 0.01   # d dt / I up to which PyBullet's explicit damping is exact enough


class AxisEfforts(Protocol):
    """What is told the limits of axes, and which of them are integrated implicitly."""

    def set_limits(self, row: int, effort: float, rate: float) -> None:
        """The most effort, N or N m, and rate, m/s or rad/s, of an axis; below 0 for none."""

    def set_implicit(self, body: Body, axes: Optional[ImplicitAxes]) -> None:
        """The springs and dampers of a body; None without any."""


def specs_of(body: Body, model: Model) -> List[Tuple[Axis, JointAxis]]:
    """The axes of a body of `model`, each with its description."""
    specs = {joint.name: (joint.axis, joint.axis2) for joint in model.joints}
    return [(axis, specs[axis.name][axis.number] or JointAxis()) for axis in body.axes]


def set_up(body: Body, model: Model, forces: AxisEfforts, dt: float) -> None:
    """Give every axis of a body the limits, friction, damping and spring of the description."""
    mass = sum(part.mass for part in body.parts)
    _free(body)
    implicit: List[Tuple[Axis, JointAxis]] = []
    for axis, spec in specs_of(body, model):
        # createMultiBody leaves a velocity motor on every axis; as a brake it is the friction.
        pybullet.setJointMotorControl2(body.uid, axis.index, pybullet.VELOCITY_CONTROL,
                                       targetVelocity=spec.motor_rate,
                                       force=max(0.0, spec.friction))
        _limit(body, axis, spec, mass)
        forces.set_limits(axis.row, spec.effort, spec.velocity)
        explicit = not spec.spring_stiffness and spec.damping * dt * axis.ease <= _EXPLICIT_DAMPING
        if not explicit:
            implicit.append((axis, spec))
        pybullet.changeDynamics(body.uid, axis.index,
                                jointDamping=spec.damping if explicit else 0.0)
    forces.set_implicit(body, ImplicitAxes(
        body, [axis for axis, _ in implicit], [spec for _, spec in implicit], dt)
        if implicit else None)


def _free(body: Body) -> None:
    """Switch the motors off that createMultiBody leaves on every axis, also those without a row."""
    with_row = {axis.index for axis in body.axes}
    balls = {ball.index for ball in body.balls}
    for index in range(pybullet.getNumJoints(body.uid)):
        if index in balls:
            pybullet.setJointMotorControlMultiDof(
                body.uid, index, pybullet.POSITION_CONTROL, targetPosition=(0.0, 0.0, 0.0, 1.0),
                positionGain=0.0, velocityGain=0.0, force=(0.0, 0.0, 0.0))
        elif index not in with_row:
            pybullet.setJointMotorControl2(body.uid, index, pybullet.VELOCITY_CONTROL, force=0.0)


def _limit(body: Body, axis: Axis, spec: JointAxis, mass: float) -> None:
    """A one-sided limit gets a far stop on the other side: PyBullet knows both or none."""
    lower, upper = spec.lower, spec.upper
    axis.lower, axis.upper = (lower, upper) if lower <= upper else (-math.inf, math.inf)
    if lower <= -INFINITE and upper >= INFINITE:
        pybullet.changeDynamics(body.uid, axis.index, jointLowerLimit=1.0, jointUpperLimit=-1.0)
        return
    pybullet.changeDynamics(body.uid, axis.index, jointLowerLimit=max(lower, -1e6),
                            jointUpperLimit=min(upper, 1e6),
                            jointLimitForce=_LIMIT_FORCE * max(1.0, mass))
