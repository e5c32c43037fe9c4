"""Set motors of joint axes: a target rate and the largest effort (ODE's `vel` and `fmax`)."""
from __future__ import annotations

from typing import Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Set, Tuple

import pybullet

from ...description.model import JointAxis, Model
from ..api import CommandRefusedError
from ..drive_commands import JointMotor
from .bodies import Axis, Body, specs_of
from .body_events import BodyObserver


class JointMotors(BodyObserver):
    """Sets PyBullet's velocity motors; on axes without a motor they represent joint friction.

    A body with axes never sleeps, nor do bodies that touch it. So motors need not wake any.

    Args:
        axes: joint rows to bodies and their axes.
        notify: called for each body whose motors have other targets.
    """

    def __init__(self, axes: Mapping[int, Tuple[Body, Axis]],
                 notify: Callable[[Body], None]) -> None:
        self._axes = axes
        self._notify = notify
        self._motors: Dict[int, JointMotor] = {}
        self._specs: Dict[int, JointAxis] = {}
        # Rates and largest efforts of motors and friction, as set in PyBullet.
        self._targets: Dict[int, Tuple[float, float]] = {}
        self._loop_rows: Set[int] = set()

    def disable_for_loops(self, rows: Set[int]) -> None:
        """Disable the motors of axes that PID loops drive from now on; friction stays."""
        changed, self._loop_rows = rows ^ self._loop_rows, set(rows)
        for row in changed:
            if row in self._motors and row in self._axes:
                body, axis = self._axes[row]
                self.restore(body, [axis])

    def rate_of(self, row: int) -> float:
        """Return the rate to which a motor drives an axis, rad/s or m/s; 0 without a motor."""
        rate, effort = self._targets.get(row, (0.0, 0.0))
        return rate if effort > 0.0 else 0.0

    def effort_of(self, row: int) -> float:
        """Return the largest effort of the motor, or of the friction, of an axis, N m or N."""
        return self._targets.get(row, (0.0, 0.0))[1]

    def motor_of(self, row: int) -> Optional[Tuple[float, float]]:
        """Return the rate to which a motor drives an axis, rad/s or m/s, and its largest effort.

        None without a motor, or for a rate of 0. The effort is in N m or N.
        """
        found = self._targets.get(row)
        return None if found is None or not found[0] or found[1] <= 0.0 else found

    def set(self, motors: Iterable[JointMotor]) -> None:
        """Set some motors; others stay. Raises CommandRefusedError before any motor is set."""
        changed = list(motors)
        for motor in changed:
            if motor.row not in self._axes:
                raise CommandRefusedError("the joint of the motor does not exist")
        moved: Dict[int, Tuple[Body, List[Axis]]] = {}
        for motor in changed:
            if self._motors.get(motor.row) != motor:
                self._motors[motor.row] = motor
                body, axis = self._axes[motor.row]
                moved.setdefault(body.uid, (body, []))[1].append(axis)
        for body, axes in moved.values():
            self.restore(body, axes)
            self._notify(body)

    def set_up(self, body: Body, model: Model) -> None:
        """Apply motors, or the friction of a model, to the axes of a body."""
        self._specs.update((axis.row, spec) for axis, spec in specs_of(body, model))
        if body.axes:
            self.restore(body, body.axes)

    def forget(self, body: Body) -> None:
        for axis in body.axes:
            self._motors.pop(axis.row, None)
            self._specs.pop(axis.row, None)
            self._targets.pop(axis.row, None)

    def restore(self, body: Body, axes: Sequence[Axis]) -> None:
        """Enable the motors of axes of a body, or their friction if there is no motor.

        createMultiBody leaves a velocity motor on every axis; as a brake it is the friction.
        """
        targets = [self._target_of(axis.row) for axis in axes]
        pybullet.setJointMotorControlArray(
            body.uid, [axis.index for axis in axes], pybullet.VELOCITY_CONTROL,
            targetVelocities=[rate for rate, _ in targets],
            forces=[effort for _, effort in targets])
        self._targets.update((axis.row, target) for axis, target in zip(axes, targets))

    def _target_of(self, row: int) -> Tuple[float, float]:
        """Return the rate of the motor or friction of an axis, rad/s or m/s, and its effort."""
        motor = self._motors.get(row)
        if motor is not None and motor.effort > 0.0 and row not in self._loop_rows:
            return motor.rate, motor.effort
        spec = self._specs.get(row) or JointAxis()
        return spec.motor_rate, max(0.0, spec.friction)
