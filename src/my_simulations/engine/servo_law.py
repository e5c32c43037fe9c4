"""Compute a joint servo in each step: the arithmetic of ros_control's controllers and limits.

Sources: control_toolbox::Pid; joint_limits_interface's saturation and soft limits;
gazebo_ros_control's DefaultRobotHWSim. No physics engine is needed here.
"""
from __future__ import annotations

import math
from typing import Callable, Optional, Tuple

from .drive_commands import JointServo, PidGains
from .run_state import LoopMemory, ServoMemory
from .spline import step_sampler

_TWO_PI = 2.0 * math.pi
FOLLOW = 0.2
"""Share of a position error that a motor without gains takes back in a step."""


Advance = Callable[[float, float, int], float]
_Target = Callable[[int], Tuple[float, float]]


def wrapped_angle(angle: float) -> float:
    """An angle in -pi to pi."""
    return math.remainder(angle, _TWO_PI)


class Pid:
    """One loop: p e + i integral of e + d de/dt, e = wanted - present. Source: control_toolbox.

    Attributes:
        gains: its gains.
        integral: of the error, s.
        error: the last one, for the next difference; None when that would be no rate.
    """

    __slots__ = ("error", "gains", "integral")

    def __init__(self, gains: PidGains) -> None:
        self.gains = gains
        self.integral = 0.0
        self.error: Optional[float] = None

    @property
    def memory(self) -> LoopMemory:
        """Its state, for `resume`."""
        return LoopMemory(self.integral, self.error)

    def resume(self, memory: LoopMemory) -> None:
        self.integral, self.error = memory.integral, memory.error

    def reset_after_jump(self) -> None:
        """Discard the last error after a jump of the measured value."""
        self.error = None

    def command(self, error: float, dt: float, slope: Optional[float] = None) -> float:
        """The next output; `slope` is de/dt, where it is known in another way."""
        gains = self.gains
        if slope is None:
            last = self.error
            slope = 0.0 if last is None else (error - last) / dt
            self.error = error
        i = gains.i
        if not i:
            return gains.p * error + gains.d * slope
        integral = self.integral = self.integral + error * dt
        term = i * integral
        if gains.antiwindup:
            one, other = gains.i_min / i, gains.i_max / i
            integral = self.integral = max(min(one, other), min(max(one, other), integral))
            term = i * integral
        elif term > gains.i_max:
            term = gains.i_max
        elif term < gains.i_min:
            term = gains.i_min
        return gains.p * error + term + gains.d * slope


class ServoLaw:
    """The state and the law of one servo.

    Attributes:
        servo: as it was given.
        advance: gives the effort, N m or N, or the rate of a motor, for the step that begins at a
            count: (position, rate, step). A function of its own for what most servos are.
        gives_effort: `advance` returns an effort; else the rate of a motor.
        steady: nothing is to be computed: a motor keeps `servo.target`.
        loop: about the target; None without gains.
        last: what `advance` returned last; 0 while steady.
        before: the position, or the rate with a lag, commanded in the last step; None when there
            was none.
    """

    def __init__(self, servo: JointServo, dt: float) -> None:
        self._dt = dt
        self.loop = Pid(servo.gains) if servo.gains is not None else None
        self._inner = Pid(servo.drive_gains) if servo.drive_gains is not None else None
        self.before: Optional[float] = None
        self.last = 0.0
        self.change(servo)

    def change(self, servo: JointServo) -> None:
        """Another target for the same loops."""
        self.servo = servo
        self._target = _target_of(servo, self._dt)
        self.gives_effort = servo.drive == "effort" or self._inner is not None
        self.steady = (servo.spline is None and servo.gains is None and self._inner is None
                       and (servo.drive != "effort" or servo.target == 0.0)
                       and servo.soft is None and servo.lags is None)
        if self.steady:
            self.last = 0.0  # `advance` is not called
        self.advance: Advance = self._advance
        if servo.soft is None and servo.drive == "effort" and self.loop is not None and not (
                servo.of_rate or servo.wraps or self.loop.gains.antiwindup):
            self.advance = _position_loop(self, self._target, self._dt)
        elif servo.soft is None and servo.drive == "position" and servo.spline is not None and (
                self.loop is None and self._inner is None):
            self.advance = _position_motor(self, self._target, self._dt)
        elif servo.lags is not None:
            self.advance = _lagging_motor(self, servo.lags, self._dt)

    def moves(self, step: int) -> bool:
        """Whether the position that is wanted at a step count is on its way."""
        return self.servo.spline is not None and self._target(step)[1] != 0.0

    @property
    def memory(self) -> ServoMemory:
        """Its state, for `resume`."""
        loop, inner = (LoopMemory() if pid is None else pid.memory
                       for pid in (self.loop, self._inner))
        return ServoMemory(loop, inner, self.servo.target, self.before, self.last)

    def resume(self, memory: ServoMemory) -> None:
        """Continue from the state of a servo with the same loops."""
        self.change(self.servo.held_at(memory.target))
        for pid, state in ((self.loop, memory.loop), (self._inner, memory.inner)):
            if pid is not None:
                pid.resume(state)
        self.before, self.last = memory.before, memory.last

    def reset_after_jump(self) -> None:
        """Reset the loops after the position of the joint was set."""
        self.before = None
        for loop in (self.loop, self._inner):
            if loop is not None:
                loop.reset_after_jump()

    def _advance(self, position: float, rate: float, step: int) -> float:
        """`advance` for all kinds of servos."""
        servo, dt = self.servo, self._dt
        wanted, wanted_rate = self._target(step)
        command = wanted
        if self.loop is not None:
            error = wanted - (rate if servo.of_rate else position)
            if servo.wraps and not servo.of_rate:
                error = wrapped_angle(error)
            command = servo.feedforward * wanted_rate + self.loop.command(
                error, dt, wanted_rate - rate if servo.by_rates else None)
        if servo.drive == "effort":
            self.last = self.limited(command, position, rate)
        elif servo.drive == "velocity":
            self.last = self._velocity_output(command, position, rate)
        else:
            self.last = self._position_output(command, position, step)
        return self.last

    def limited(self, effort: float, position: float, rate: float) -> float:
        servo = self.servo
        most = servo.most_effort
        least = -most
        if servo.soft is not None:
            slow, fast = servo.soft.rates(position, servo.most_rate)
            stiff = servo.soft.k_velocity
            least = max(-most, min(most, -stiff * (rate - slow)))
            most = max(-most, min(most, -stiff * (rate - fast)))
        else:
            if position < servo.lower or rate < -servo.most_rate:
                least = 0.0
            if position > servo.upper or rate > servo.most_rate:
                most = 0.0
        return max(least, min(most, effort))

    def _velocity_output(self, command: float, position: float, rate: float) -> float:
        """Return a rate within the limits, or the effort of the inner loop that follows it."""
        slow, fast = self._rate_limits(position)
        command = max(slow, min(fast, command))
        return command if self._inner is None else self._inner_effort(self._inner, command - rate)

    def _rate_limits(self, position: float) -> Tuple[float, float]:
        servo = self.servo
        if servo.soft is not None:
            return servo.soft.rates(position, servo.most_rate)
        return -servo.most_rate, servo.most_rate

    def _inner_effort(self, inner: Pid, error: float) -> float:
        most = self.servo.most_effort
        return max(-most, min(most, inner.command(error, self._dt)))

    def _position_output(self, command: float, position: float, step: int) -> float:
        servo, dt = self.servo, self._dt
        before = position if self.before is None else self.before
        slow, fast = self._rate_limits(before)
        command = self._within(command, before + slow * dt, before + fast * dt)
        if self._inner is not None:
            self.before = command
            error = command - position
            return self._inner_effort(self._inner, wrapped_angle(error) if servo.wraps else error)
        # A motor arrives at the end of the step where the spline is then.
        ahead = command
        if servo.spline is not None:
            self.before = command
            ahead = self._within(self._target(step + 1)[0], command + slow * dt,
                                 command + fast * dt)
        else:
            self.before = None
        return (FOLLOW * (command - position) + ahead - command) / dt

    def _within(self, position: float, least: float, most: float) -> float:
        """A position within the joint's limits and these."""
        return max(self.servo.lower, least, min(self.servo.upper, most, position))


def _target_of(servo: JointServo, dt: float) -> _Target:
    """The target and its rate at a step count."""
    if servo.spline is not None:
        return step_sampler(servo.spline, dt)
    wanted = servo.target, servo.target_rate
    return lambda step: wanted


def _position_loop(law: ServoLaw, target: _Target, dt: float) -> Advance:
    """Return a fast `ServoLaw._advance` for an effort by a position loop.

    An axis of an arm costs a third of what the general form costs.
    """
    servo, loop = law.servo, law.loop
    assert loop is not None
    p, i, d, i_min, i_max = (loop.gains.p, loop.gains.i, loop.gains.d, loop.gains.i_min,
                             loop.gains.i_max)
    stands, by_rates, feedforward = servo.spline is None, servo.by_rates, servo.feedforward
    lower, upper, fast, most = servo.lower, servo.upper, servo.most_rate, servo.most_effort
    wanted, wanted_rate = servo.target, servo.target_rate

    def advance(position: float, rate: float, step: int) -> float:
        nonlocal wanted, wanted_rate
        if not stands:
            wanted, wanted_rate = target(step)
        error = wanted - position
        if by_rates:
            effort = p * error + d * (wanted_rate - rate)
        else:
            before, loop.error = loop.error, error
            effort = p * error
            if before is not None:
                effort += d * ((error - before) / dt)
        if i:
            integral = loop.integral = loop.integral + error * dt
            term = i * integral
            effort += i_max if term > i_max else i_min if term < i_min else term
        if feedforward:
            effort += feedforward * wanted_rate
        if lower <= position <= upper and -fast <= rate <= fast:
            law.last = effort = most if effort > most else -most if effort < -most else effort
        else:
            law.last = effort = law.limited(effort, position, rate)
        return effort

    return advance


def _position_motor(law: ServoLaw, target: _Target, dt: float) -> Advance:
    """Return a fast `ServoLaw._advance` for a motor that follows a spline."""
    servo = law.servo
    lower, upper, way = servo.lower, servo.upper, servo.most_rate * dt

    def advance(position: float, rate: float, step: int) -> float:
        before = position if law.before is None else law.before
        command, ahead = target(step)[0], target(step + 1)[0]
        if not (lower <= command <= upper and before - way <= command <= before + way):
            command = max(lower, before - way, min(upper, before + way, command))
        # The motor arrives at the end of the step where the spline is then.
        if not (lower <= ahead <= upper and command - way <= ahead <= command + way):
            ahead = max(lower, command - way, min(upper, command + way, ahead))
        law.before = command
        law.last = found = (FOLLOW * (command - position) + ahead - command) / dt
        return found

    return advance


def _lagging_motor(law: ServoLaw, lags: Tuple[float, float], dt: float) -> Advance:
    """Return a `ServoLaw._advance` for a rate that follows its target with a first-order lag.

    It begins with the rate of the joint.
    """
    servo = law.servo
    target = max(-servo.most_rate, min(servo.most_rate, servo.target))
    rising, falling = (math.exp(-dt / lag) for lag in lags)

    def advance(position: float, rate: float, step: int) -> float:
        before = rate if law.before is None else law.before
        lack = (before - target) * (rising if target > before else falling)
        law.before = law.last = found = target + lack
        return found

    return advance
