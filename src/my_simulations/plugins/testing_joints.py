"""Links and joints of the world without physics in which plugins are tested."""
from __future__ import annotations

from typing import Optional, Tuple

from ..description.model import Inertial, JointAxis
from ..description.model import Joint as JointSpec
from ..engine.drive_commands import JointServo
from ..engine.servo_law import FOLLOW, ServoLaw
from ..geometry import IDENTITY, STILL


class FakeLink:
    """A link at a pose that a test sets."""

    def __init__(self, name: str) -> None:
        self.name, self.pose, self.twist = name, IDENTITY, STILL
        self.inertial = Inertial()


class FakeJoint:
    """A joint that turns as its motor says, without delay; a servo's effort turns 1 kg m^2.

    Attributes:
        motor: rate and effort that it was driven with; None before.
        servo: what it was steered with; None before.
        spec: its description.
        effort: what the servo spent in the last step.
        stuck: something holds it.
        set_count: how often a test or a plugin has put it somewhere.
    """

    def __init__(self, name: str) -> None:
        self.name, self.parent, self.child = name, "base", name
        self.position = self.velocity = 0.0
        self.motor: Optional[Tuple[float, float]] = None
        self.servo: Optional[JointServo] = None
        self.spec = JointSpec(name, "revolute", "base", name, axis=JointAxis())
        self.effort = 0.0
        self.stuck = False
        self.set_count = 0
        self._law: Optional[ServoLaw] = None

    def put(self, position: float) -> None:
        """Set the position at once, with velocity 0."""
        self.position, self.velocity = position, 0.0
        self.set_count += 1
        if self.servo is not None and self.servo.holds:
            self.set_servo(self.servo)

    def drive(self, rate: float, effort: float) -> None:
        self.motor = (rate, effort)

    def set_servo(self, servo: JointServo) -> None:
        servo = servo.held_at(self.position)
        before, self.servo = self.servo, servo
        if not servo.drive:
            self._law = None
        elif self._law is not None and before is not None and before.same_loops(servo):
            self._law.change(servo)
        else:
            self._law = None

    def step(self, step: int, dt: float) -> None:
        """Integrate one step."""
        if self.stuck:
            self.velocity = 0.0
            return
        if self.motor is not None and self.motor[1] > 0.0:
            self.velocity = self.motor[0]
        elif self.servo is not None and self.servo.drive:
            self._law = self._law or ServoLaw(self.servo, dt)
            self._follow(self._law, step, dt)
        else:
            return
        self.position += self.velocity * dt

    def _follow(self, law: ServoLaw, step: int, dt: float) -> None:
        servo = law.servo
        if not law.steady:
            asked = law.advance(self.position, self.velocity, step)
            self.effort = asked if law.gives_effort else 0.0
            self.velocity = self.velocity + asked * dt if law.gives_effort else asked
        elif servo.drive == "velocity":
            self.velocity = max(-servo.most_rate, min(servo.most_rate, servo.target))
        elif servo.drive == "position":
            way = max(servo.lower, min(servo.upper, servo.target)) - self.position
            self.velocity = max(-servo.most_rate, min(servo.most_rate, FOLLOW * way / dt))
