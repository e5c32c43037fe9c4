"""Servos of joint axes: control loops and trajectories, evaluated in each step."""
from __future__ import annotations

import math
from typing import AbstractSet, Callable, Dict, Iterable, List, Mapping, Sequence, Set, Tuple

import pybullet

from ...description.model import Model
from ..api import CommandRefusedError
from ..drive_commands import JointServo
from ..run_state import ServoMemory
from ..servo_law import FOLLOW, Advance, ServoLaw
from .bodies import Axis, Body, specs_of

_UNLIMITED_EFFORT = 1e7   # N or N m: the limit of a motor without one
_UNLIMITED_RATE = 1e5     # rad/s or m/s: the same for its rate


class _ServoList:
    """Servos of one body that must be computed in each step.

    Attributes:
        indices, rows: PyBullet's joint indices, and axis rows.
        laws, advances: and their functions.
        largest_efforts: of their motors, N m or N.
    """

    def __init__(self) -> None:
        self.indices: List[int] = []
        self.rows: List[int] = []
        self.laws: List[ServoLaw] = []
        self.advances: List[Advance] = []
        self.largest_efforts: List[float] = []

    def add(self, axis: Axis, law: ServoLaw) -> None:
        self.indices.append(axis.index)
        self.rows.append(axis.row)
        self.laws.append(law)
        self.advances.append(law.advance)
        self.largest_efforts.append(_largest_effort(law.servo))

    def compute(self, uid: int, step: int) -> List[float]:
        """Return the effort or rate of each servo in the step that begins at count `step`."""
        return [advance(position, rate, step) for (position, rate, _, _), advance in zip(
            pybullet.getJointStates(uid, self.indices), self.advances)]


class JointServos:
    """Stores servos; PyBullet's motors run those that need no computation in each step."""

    def __init__(self, axes: Mapping[int, Tuple[Body, Axis]],
                 wake: Callable[[List[Body]], None],
                 release: Callable[[Body, Axis], None]) -> None:
        """`release` restores the motor of an axis, or its friction."""
        self._axes, self._wake, self._release = axes, wake, release
        self._laws: Dict[int, ServoLaw] = {}
        # By body: servos that return an effort in each step, and servos that set a motor's rate.
        self._effort_servos: Dict[int, _ServoList] = {}
        self._motor_servos: Dict[int, _ServoList] = {}
        self._loop_rows: Set[int] = set()
        self._dt = 0.0
        self._step = -1   # of the last call of `act`

    @property
    def idle(self) -> bool:
        """Whether no servo must be computed in each step."""
        return not (self._effort_servos or self._motor_servos)

    def disable_for_loops(self, rows: Set[int]) -> None:
        """Disable the servos of axes that PID loops drive from now on; friction stays."""
        changed, self._loop_rows = rows ^ self._loop_rows, set(rows)
        for row in changed & self._laws.keys():
            body, axis = self._axes[row]
            self._laws[row].reset_after_jump()
            self._release(body, axis)
            self._drive(body, axis)
        self._collect_busy()

    def drives(self, body: Body) -> bool:
        """Whether a servo of a body must be computed in each step."""
        return body.uid in self._effort_servos or body.uid in self._motor_servos

    def rate_of(self, row: int) -> float:
        """Return the rate to which an axis is driven, rad/s or m/s; 0 if none, or on a spline.

        For a position target it is the largest rate on the way.
        """
        law = self._laws.get(row)
        if law is None or law.servo.spline is not None or row in self._loop_rows:
            return 0.0
        servo = law.servo
        if servo.of_rate or servo.drive == "velocity" and servo.gains is None:
            return max(-servo.most_rate, min(servo.most_rate, servo.target))
        return servo.most_rate if servo.most_rate < math.inf else 0.0

    @property
    def moving(self) -> Set[int]:
        """PyBullet's numbers of bodies that move along a spline."""
        return {uid for table in (self._effort_servos, self._motor_servos)
                for uid, servos in table.items()
                if any(law.moves(self._step) for law in servos.laws)}

    def set(self, servos: Iterable[JointServo], dt: float) -> None:
        """Set some servos; others stay. Raises CommandRefusedError before any servo is set."""
        self._dt = dt
        changed = list(servos)
        for servo in changed:
            if servo.row not in self._axes:
                raise CommandRefusedError("the joint of the servo does not exist")
        woken: Dict[int, Body] = {}
        for servo in changed:
            body, axis = self._axes[servo.row]
            law = self._laws.get(servo.row)
            if law is not None and law.servo == servo.held_at(law.servo.target):
                continue
            servo = _with_present_target(servo, body, axis)
            if not servo.drive:
                self._laws.pop(servo.row, None)
                self._release(body, axis)
            elif law is not None and law.servo.same_loops(servo):
                law.change(servo)
            else:
                self._laws[servo.row] = ServoLaw(servo, dt)
                self._release(body, axis)
            self._drive(body, axis)
            woken[body.uid] = body
        self._collect_busy()
        if woken:
            self._wake(list(woken.values()))

    def memories(self) -> Tuple[Tuple[int, ServoMemory], ...]:
        """The states of all servos by joint row, for `resume`."""
        return tuple((row, law.memory) for row, law in self._laws.items())

    def resume(self, memories: Iterable[Tuple[int, ServoMemory]]) -> None:
        """Continue from saved states; the servos must be set before."""
        for row, memory in memories:
            self._laws[row].resume(memory)
            self._drive(*self._axes[row])
        self._collect_busy()

    def set_up(self, body: Body, model: Model, dt: float) -> None:
        """Restart the servos of axes whose limits and friction were set (again)."""
        for axis, _ in specs_of(body, model):
            law = self._laws.get(axis.row)
            if law is not None:
                if dt != self._dt:
                    self._laws[axis.row] = ServoLaw(law.servo, dt)
                self._drive(body, axis)
        self._dt = dt
        self._collect_busy()

    def reset_after_jump(self, body: Body) -> None:
        """Reset the servos of a body whose joints were set."""
        for axis in body.axes:
            law = self._laws.get(axis.row)
            if law is not None:
                law.reset_after_jump()
                if law.servo.holds:
                    law.change(_with_present_target(law.servo, body, axis))
                    self._drive(body, axis)

    def forget(self, body: Body) -> None:
        """Discard the data of a removed body."""
        self._effort_servos.pop(body.uid, None)
        self._motor_servos.pop(body.uid, None)
        for axis in body.axes:
            self._laws.pop(axis.row, None)

    def act(self, efforts: Dict[int, float], shared: AbstractSet[int], step: int) -> None:
        """Apply the servos in the step that begins at count `step`.

        `shared` are PyBullet's numbers of bodies on which other efforts act. For these the efforts
        of servos are added to `efforts`, N m or N by row. For all others they are applied here.
        """
        self._step = step
        for uid, servos in self._effort_servos.items():
            given = servos.compute(uid, step)
            if uid in shared:
                for row, effort in zip(servos.rows, given):
                    efforts[row] = efforts.get(row, 0.0) + effort
            else:
                pybullet.setJointMotorControlArray(
                    uid, servos.indices, pybullet.TORQUE_CONTROL, forces=given)
        for uid, servos in self._motor_servos.items():
            pybullet.setJointMotorControlArray(
                uid, servos.indices, pybullet.VELOCITY_CONTROL,
                targetVelocities=servos.compute(uid, step), forces=servos.largest_efforts)

    def effort_of(self, row: int) -> float:
        """Return the effort of a servo in the last step, N m or N; 0 if it drives a motor."""
        law = self._laws.get(row)
        return law.last if law is not None and law.gives_effort and (
            row not in self._loop_rows) else 0.0

    def motor_effort_of(self, row: int) -> float:
        """Return the largest effort of the motor that a servo drives, N m or N; 0 for none."""
        law = self._laws.get(row)
        return _largest_effort(law.servo) if law is not None and not law.gives_effort and (
            row not in self._loop_rows) else 0.0

    def efforts(self, rows: Sequence[int]) -> Tuple[float, ...]:
        """Return the efforts on axes in the last step, N m or N; 0 without a servo or motor."""
        def effort(row: int) -> float:
            law = self._laws.get(row)
            if row not in self._axes or law is not None and law.gives_effort:
                return self.effort_of(row)
            body, axis = self._axes[row]
            return float(pybullet.getJointState(body.uid, axis.index)[3])

        return tuple(map(effort, rows))

    def _collect_busy(self) -> None:
        """Collect the servos that must be computed in each step, by body."""
        self._effort_servos, self._motor_servos = {}, {}
        for row, law in self._laws.items():
            if not law.steady and row not in self._loop_rows:
                body, axis = self._axes[row]
                table = self._effort_servos if law.gives_effort else self._motor_servos
                table.setdefault(body.uid, _ServoList()).add(axis, law)

    def _drive(self, body: Body, axis: Axis) -> None:
        """Set the PyBullet motor of a servo that needs no computation in each step."""
        law = self._laws.get(axis.row)
        if law is None or not law.steady or law.gives_effort or axis.row in self._loop_rows:
            return
        servo = law.servo
        if servo.drive == "velocity":
            rate = max(-servo.most_rate, min(servo.most_rate, servo.target))
            pybullet.setJointMotorControl2(body.uid, axis.index, pybullet.VELOCITY_CONTROL,
                                           targetVelocity=rate, force=_largest_effort(servo))
        else:
            pybullet.setJointMotorControl2(
                body.uid, axis.index, pybullet.POSITION_CONTROL,
                targetPosition=max(servo.lower, min(servo.upper, servo.target)),
                positionGain=FOLLOW, velocityGain=1.0, force=_largest_effort(servo),
                maxVelocity=servo.most_rate if servo.most_rate < math.inf else _UNLIMITED_RATE)


def _with_present_target(servo: JointServo, body: Body, axis: Axis) -> JointServo:
    """Return a servo that `holds` with the present position of its axis as target."""
    if not servo.holds:
        return servo
    return servo.held_at(float(pybullet.getJointState(body.uid, axis.index)[0]))


def _largest_effort(servo: JointServo) -> float:
    """Return the largest effort of the motor of a servo, N m or N."""
    return servo.most_effort if servo.most_effort < math.inf else _UNLIMITED_EFFORT
