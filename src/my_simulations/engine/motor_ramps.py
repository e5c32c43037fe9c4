"""Motors whose rates approach their targets with a limited acceleration, at the steps of a rate.

The law is that of `wheelAcceleration` in gazebo_plugins' differential drive. At each step of the
rate, the commanded rate of each motor changes by target minus measured rate, at most by what the
acceleration allows, and not beyond the target. As soon as one joint of the group is near its
target, all motors get their targets.
"""
from __future__ import annotations

from typing import Callable, Dict, Iterable, List, Optional, Sequence, Tuple

from .commands import Clear, Command, LoadModel, RemoveModel, Restart
from .drive_commands import JointMotor, RateRamp, SetMotors
from .rates import Rate
from .ring import NO_LIMIT, Clock
from .ring_rows import axis_rows


class _Group:
    """Motors that reach their targets together.

    Attributes:
        targets: motors with their targets, by joint row.
        commanded: the present rate of each motor, rad/s or m/s, by joint row.
        due: the next step at which rates change; NO_LIMIT if all motors have their targets.
        last: the last one; None if none was made since the group began.
    """

    def __init__(self, ramp: RateRamp) -> None:
        self.ramp, self.rate = ramp, Rate(ramp.hertz)
        self.targets: Dict[int, JointMotor] = {}
        self.commanded: Dict[int, float] = {}
        self.due = NO_LIMIT
        self.last: Optional[int] = None

    def begin(self, step: int, clock: Clock) -> None:
        """Change the rates from the next step of the rate on."""
        self.due, self.last = self.rate.after(step, clock), None

    def advance(self, measured: Dict[int, float], step: int, clock: Clock) -> None:
        """Change the commanded rates at a step that is due; `measured`: the rates of the joints."""
        if all(abs(one.rate - measured[row]) >= self.ramp.tolerance
               for row, one in self.targets.items()):
            change = self.ramp.acceleration * self._elapsed(step, clock)
            for row, one in self.targets.items():
                before, wanted = self.commanded[row], one.rate
                after = before + max(-change, min(change, wanted - measured[row]))
                # Limited by the target, so that a blocked wheel causes no wind-up.
                self.commanded[row] = min(max(after, min(before, wanted)), max(before, wanted))
        else:
            self.commanded = {row: one.rate for row, one in self.targets.items()}
        self.last = step
        done = all(self.commanded[row] == one.rate for row, one in self.targets.items())
        self.due = NO_LIMIT if done else self.rate.after(step, clock)

    def _elapsed(self, step: int, clock: Clock) -> float:
        """The time since the last change, s; the period of the rate at the first one."""
        if self.last is not None:
            return (step - self.last) * clock.step_ps * 1e-12
        return 1.0 / self.ramp.hertz if self.ramp.hertz > 0.0 else clock.step_ps * 1e-12

    def motors(self) -> Tuple[JointMotor, ...]:
        """The motors with their commanded rates."""
        return tuple(JointMotor(row, self.commanded[row], one.effort)
                     for row, one in self.targets.items())


class MotorRamps:
    """Computes the rates of motors that have a `RateRamp`.

    Args:
        read_axes: returns position and rate of joint axes by row, one after the other.
        set_motors: gives motors their rates; raises CommandRefusedError for unknown joints.

    Attributes:
        next_step: the next step at which `act` must be called; NO_LIMIT for none.
    """

    def __init__(self, read_axes: Callable[[Tuple[int, ...]], List[float]],
                 set_motors: Callable[[SetMotors], object]) -> None:
        self._read_axes, self._set_motors = read_axes, set_motors
        self._groups: Dict[str, _Group] = {}
        self._rates: Dict[int, float] = {}          # of motors without a ramp, by joint row
        self._rows: Dict[int, Sequence[int]] = {}   # of the joint axes of each model
        self.next_step = NO_LIMIT

    def set(self, command: SetMotors, step: int, clock: Clock) -> None:
        """Set motors at a step; those with a ramp approach their rates from now on.

        Raises CommandRefusedError before any motor is set.
        """
        begun = tuple(
            one if one.ramp is None
            else JointMotor(one.row, self._present_rate(one.row), one.effort)
            for one in command.motors)
        self._set_motors(SetMotors(begun))
        for one, present in zip(command.motors, begun):
            if one.ramp is None:
                self._end([one.row])
                self._rates[one.row] = one.rate
            else:
                self._set_target(one, one.ramp, present.rate, step, clock)
        self._plan()

    def _present_rate(self, row: int) -> float:
        """The rate to which a motor drives an axis now; without a motor that of the axis."""
        for group in self._groups.values():
            if row in group.commanded:
                return group.commanded[row]
        found = self._rates.get(row)
        return self._read_axes((row,))[1] if found is None else found

    def _set_target(self, motor: JointMotor, ramp: RateRamp, present: float, step: int,
                    clock: Clock) -> None:
        group = self._groups.get(ramp.group)
        if group is None or group.ramp != ramp or motor.row not in group.targets:
            self._end([motor.row])   # in another group
        if group is None or group.ramp != ramp:
            group = self._groups[ramp.group] = _Group(ramp)
        group.targets[motor.row] = motor
        group.commanded.setdefault(motor.row, present)
        if group.due == NO_LIMIT:
            group.begin(step, clock)

    def act(self, step: int, clock: Clock) -> None:
        """Change the rates that are due at a step."""
        for group in self._groups.values():
            if group.due <= step:
                rows = tuple(group.targets)
                group.advance(dict(zip(rows, self._read_axes(rows)[1::2])), step, clock)
                self._set_motors(SetMotors(group.motors()))
        self._plan()

    def set_clock(self, step: int, clock: Clock) -> None:
        """Continue by another clock."""
        for group in self._groups.values():
            if group.due != NO_LIMIT:
                group.begin(step, clock)
        self._plan()

    def note_applied(self, command: Command) -> None:
        """Forget the motors of removed models."""
        if isinstance(command, LoadModel):
            first = command.first_joint_row
            self._rows[command.model_id] = range(first, first + len(axis_rows(command.model)))
        elif isinstance(command, RemoveModel):
            gone = self._rows.pop(command.model_id, ())
            self._end(gone)
            self._rates = {row: rate for row, rate in self._rates.items() if row not in gone}
            self._plan()
        elif isinstance(command, (Restart, Clear)):
            self._groups.clear()
            self._rates.clear()
            self._plan()

    def _end(self, rows: Iterable[int]) -> None:
        """End the ramps of some motors."""
        if not self._groups:
            return
        for row in rows:
            for group in self._groups.values():
                group.targets.pop(row, None)
                group.commanded.pop(row, None)
        self._groups = {name: group for name, group in self._groups.items() if group.targets}

    def _plan(self) -> None:
        self.next_step = min((group.due for group in self._groups.values()), default=NO_LIMIT)
