"""What a joint servo does in each step: ros_control's controllers and joint limits, as arithmetic.

Sources: control_toolbox::Pid; joint_limits_interface's saturation and soft limits;
gazebo_ros_control's DefaultRobotHWSim. No physics engine is needed here.
"""
from __future__ import annotations

import math
from typing import Optional, Tuple

from .commands import JointServo, PidGains
from .spline import Spline

_TWO_PI = 2.0 * math.pi
FOLLOW = 0.2
"""Share of a position error that a motor without gains takes back in a step."""


def shortest(angle: float) -> float:
    """An angle in -pi to pi."""
    return math.remainder(angle, _TWO_PI)


class Pid:
    """One loop: p e + i integral of e + d de/dt, e = wanted - present. Source: control_toolbox."""

    __slots__ = ("_d", "_i", "_last", "_least", "_most", "_p", "_winds_up", "integral")

    def __init__(self, gains: PidGains) -> None:
        self._p, self._i, self._d = gains.p, gains.i, gains.d
        self._least, self._most = gains.i_min, gains.i_max
        self._winds_up = not gains.antiwindup
        self.integral = 0.0
        self._last: Optional[float] = None

    def disturbed(self) -> None:
        """What is measured has jumped: its difference is no rate."""
        self._last = None

    def command(self, error: float, dt: float, slope: Optional[float] = None) -> float:
        """The next output; `slope` is de/dt, where it is known in another way."""
        if slope is None:
            last = self._last
            slope = 0.0 if last is None else (error - last) / dt
            self._last = error
        i = self._i
        if not i:
            return self._p * error + self._d * slope
        integral = self.integral = self.integral + error * dt
        if self._winds_up:
            term = i * integral
            if term > self._most:
                term = self._most
            elif term < self._least:
                term = self._least
        else:
            one, other = self._least / i, self._most / i
            integral = self.integral = max(min(one, other), min(max(one, other), integral))
            term = i * integral
        return self._p * error + term + self._d * slope


class ServoLaw:
    """One servo at work.

    Attributes:
        servo: as it was given.
        gives_effort: `advance` returns an effort, N m or N; else the rate of a motor.
        steady: nothing is to be computed: a motor keeps `servo.target`.
        last: what `advance` returned last.
    """

    def __init__(self, servo: JointServo, dt: float) -> None:
        self._dt = dt
        self._outer = Pid(servo.gains) if servo.gains is not None else None
        self._inner = Pid(servo.drive_gains) if servo.drive_gains is not None else None
        self._before: Optional[float] = None   # the position commanded in the last step
        self.last = 0.0
        self.change(servo)

    def change(self, servo: JointServo) -> None:
        """Another target for the same loops."""
        self.servo = servo
        self._seen_step, self._seen = -1, (0.0, 0.0)
        self._begin, self._end = math.inf, -math.inf
        self._coefficients = (0.0,) * 10   # of the position, c0 to c5, and of its rate, 2 c2 to 5 c5
        self.gives_effort = servo.drive == "effort" or self._inner is not None
        # Most loops: an effort that follows a position, and limits that are seldom reached.
        self._plain = (servo.drive == "effort" and servo.soft is None
                       and self._outer is not None and not servo.of_rate and not servo.wraps)
        self.steady = (servo.spline is None and servo.gains is None and self._inner is None
                       and (servo.drive != "effort" or servo.target == 0.0)
                       and servo.soft is None)

    @property
    def moving(self) -> bool:
        """Whether the position that was wanted last is on its way."""
        return self.servo.spline is not None and self._seen[1] != 0.0

    def disturbed(self) -> None:
        """The joint was put somewhere."""
        self._before = None
        for loop in (self._outer, self._inner):
            if loop is not None:
                loop.disturbed()

    def advance(self, position: float, rate: float, step: int) -> float:
        """The effort or rate for the step that begins at count `step`."""
        servo, dt = self.servo, self._dt
        if servo.spline is None:
            wanted, wanted_rate = servo.target, servo.target_rate
        else:
            wanted, wanted_rate = self._on_spline(servo.spline, step)
        outer = self._outer
        if outer is None:
            command = wanted
        elif self._plain:
            command = outer.command(wanted - position, dt,
                                    wanted_rate - rate if servo.by_rates else None)
            if servo.feedforward:
                command += servo.feedforward * wanted_rate
        else:
            if servo.of_rate:
                error = wanted - rate
            else:
                error = wanted - position
                if servo.wraps:
                    error = shortest(error)
            command = servo.feedforward * wanted_rate + outer.command(
                error, dt, wanted_rate - rate if servo.by_rates else None)
        if servo.drive == "effort":
            most = servo.most_effort
            if servo.soft is None and servo.lower <= position <= servo.upper and (
                    -servo.most_rate <= rate <= servo.most_rate):
                self.last = -most if command < -most else most if command > most else command
            else:
                self.last = self._effort(command, position, rate)
        elif servo.drive == "velocity":
            self.last = self._velocity(command, position, rate)
        else:
            self.last = self._position(command, position, step)
        return self.last

    def _on_spline(self, spline: Spline, step: int) -> Tuple[float, float]:
        """Position and rate at a step count, without a search within one segment."""
        if step == self._seen_step:
            return self._seen
        time, begin = (step - spline.origin) * self._dt, self._begin
        if not begin <= time < self._end:
            index = spline.index(time)
            segment = spline.segments[index]
            following = spline.segments[index + 1:index + 2]
            self._begin, self._end = segment.start, min(
                [segment.end, *(one.start for one in following)])
            self._coefficients = (*segment.coefficients, *(
                power * one for power, one in enumerate(segment.coefficients[2:], 2)))
            position, rate, _ = spline.at(time)
        else:
            c0, c1, c2, c3, c4, c5, d2, d3, d4, d5 = self._coefficients
            t = time - begin
            position = ((((c5 * t + c4) * t + c3) * t + c2) * t + c1) * t + c0
            rate = (((d5 * t + d4) * t + d3) * t + d2) * t + c1
        self._seen_step = step
        seen = self._seen = position, rate
        return seen

    def _effort(self, effort: float, position: float, rate: float) -> float:
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

    def _velocity(self, command: float, position: float, rate: float) -> float:
        servo = self.servo
        slow, fast = -servo.most_rate, servo.most_rate
        if servo.soft is not None:
            slow, fast = servo.soft.rates(position, servo.most_rate)
        command = max(slow, min(fast, command))
        if self._inner is None:
            return command
        return max(-servo.most_effort, min(servo.most_effort,
                                           self._inner.command(command - rate, self._dt)))

    def _within(self, position: float, least: float, most: float) -> float:
        """A position within the joint's limits and these."""
        lower, upper = self.servo.lower, self.servo.upper
        if lower <= position <= upper and least <= position <= most:
            return position   # nearly always: four calls less
        return max(lower, least, min(upper, most, position))

    def _position(self, command: float, position: float, step: int) -> float:
        servo, dt = self.servo, self._dt
        before = position if self._before is None else self._before
        slow, fast = -servo.most_rate, servo.most_rate
        if servo.soft is not None:
            slow, fast = servo.soft.rates(before, servo.most_rate)
        command = self._within(command, before + slow * dt, before + fast * dt)
        if self._inner is not None:
            self._before = command
            error = command - position
            if servo.wraps:
                error = shortest(error)
            return max(-servo.most_effort, min(servo.most_effort, self._inner.command(error, dt)))
        # A motor arrives at the end of the step where the spline is then.
        ahead = command
        if servo.spline is not None:
            self._before = command
            ahead = self._on_spline(servo.spline, step + 1)[0]
            ahead = self._within(ahead, command + slow * dt, command + fast * dt)
        else:
            self._before = None
        return (FOLLOW * (command - position) + ahead - command) / dt
