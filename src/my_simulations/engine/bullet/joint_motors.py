"""Motors of joint axes: a rate, and the largest effort for it (ODE's `vel` and `fmax`)."""
from __future__ import annotations

from typing import Callable, Dict, Iterable, List, Mapping, Optional, Set, Tuple

import pybullet

from ...description.model import JointAxis, Model
from ..api import CommandRefusedError
from ..drive_commands import JointMotor
from .bodies import Axis, Body
from .body_events import BodyObserver
from .joint_axes import specs_of


class JointMotors(BodyObserver):
    """Sets PyBullet's velocity motors; on axes without a motor they represent joint friction."""

    def __init__(self, axes: Mapping[int, Tuple[Body, Axis]],
                 wake: Callable[[List[Body]], None]) -> None:
        self._axes = axes
        self._wake = wake
        self._motors: Dict[int, JointMotor] = {}
        self._specs: Dict[int, JointAxis] = {}
        self._driven: Dict[int, Tuple[float, float]] = {}  # rates other than 0 now, and efforts
        self._efforts: Dict[int, float] = {}
        self._yielding: Set[int] = set()

    def yield_to(self, rows: Set[int]) -> None:
        """Disable the motors of axes that PID loops drive from now on; friction stays."""
        changed, self._yielding = rows ^ self._yielding, set(rows)
        for row in changed:
            if row in self._motors and row in self._axes:
                self.restore(*self._axes[row])

    def rate_of(self, row: int) -> float:
        """The rate to which an axis is driven, rad/s or m/s; 0 also for one that is not."""
        return self._driven.get(row, (0.0, 0.0))[0]

    def effort_of(self, row: int) -> float:
        """The most effort of the motor, or of the friction, of an axis, N m or N."""
        return self._efforts.get(row, 0.0)

    def driven(self, row: int) -> Optional[Tuple[float, float]]:
        """The rate to which an axis is driven, rad/s or m/s, and the most effort, N m or N.

        None for one that is not driven, or to a rate of 0.
        """
        return self._driven.get(row)

    def set(self, motors: Iterable[JointMotor]) -> None:
        """Set these motors; others stay. Raises CommandRefusedError before any motor is set."""
        changed = list(motors)
        for motor in changed:
            if motor.row not in self._axes:
                raise CommandRefusedError("the joint of the motor does not exist")
        woken: Dict[int, Body] = {}
        for motor in changed:
            body, axis = self._axes[motor.row]
            before = self._motors.get(motor.row)
            if before == motor:
                continue
            self._motors[motor.row] = motor
            self.restore(body, axis)
            woken[body.uid] = body
        if woken:
            self._wake(list(woken.values()))

    def set_up(self, body: Body, model: Model) -> None:
        """Apply motors, or friction, to axes whose limits and friction were set (again)."""
        for axis, spec in specs_of(body, model):
            self._specs[axis.row] = spec
            if axis.row in self._motors:
                self.restore(body, axis)
            else:
                self._note(axis.row, spec.motor_rate, spec.friction)

    def forget(self, body: Body) -> None:
        for axis in body.axes:
            self._motors.pop(axis.row, None)
            self._specs.pop(axis.row, None)
            self._driven.pop(axis.row, None)
            self._efforts.pop(axis.row, None)

    def restore(self, body: Body, axis: Axis) -> None:
        """Enable the motor of an axis, or its friction if it has no motor."""
        motor = self._motors.get(axis.row)
        if motor is not None and motor.effort > 0.0 and axis.row not in self._yielding:
            rate, effort = motor.rate, motor.effort
        else:
            spec = self._specs.get(axis.row) or JointAxis()
            rate, effort = spec.motor_rate, max(0.0, spec.friction)
        pybullet.setJointMotorControl2(body.uid, axis.index, pybullet.VELOCITY_CONTROL,
                                       targetVelocity=rate, force=effort)
        self._note(axis.row, rate, effort)

    def _note(self, row: int, rate: float, effort: float) -> None:
        self._efforts[row] = effort
        self._driven.pop(row, None)
        if rate and effort > 0.0:
            self._driven[row] = rate, effort
