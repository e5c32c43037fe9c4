"""The links and joints of a plugin, and its commands for its model."""
from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Dict, Optional, Tuple

from ..description.model import Inertial
from ..description.model import Joint as JointSpec
from ..engine.drive_commands import JointMotor, JointServo, PlanarVelocity, RateRamp
from ..engine.wrench_laws import WrenchLaw
from ..geometry import Pose, Twist, Vec3
from .checked_arguments import check_finite, check_number
from .observations import StepView


@dataclass
class PendingCommands:
    """The commands of a plugin that were not sent to the engine yet.

    Attributes:
        motors, servos: by joint row.
        planar: of the model.
        wrenches: force and torque, or the law of both and the scoped name of the joint that the law
            follows, by the scoped name of a link.
    """

    motors: Dict[int, JointMotor] = field(default_factory=dict)
    servos: Dict[int, JointServo] = field(default_factory=dict)
    planar: Optional[PlanarVelocity] = None
    wrenches: Dict[str, Tuple[Vec3, Vec3, Optional[WrenchLaw], str]] = field(default_factory=dict)


class SimulatedLink:
    """A link, by the row it has now."""

    def __init__(self, view: StepView, name: str) -> None:
        self.name = name
        self._view = view
        self.row = -1
        self.inertial = Inertial()

    @property
    def pose(self) -> Pose:
        return self._view.link_at(self.row)[0]

    @property
    def twist(self) -> Twist:
        """Twist at the link's origin, world axes."""
        return self._view.link_at(self.row)[1]


class SimulatedJoint:
    """A joint axis, by the row it has now."""

    def __init__(self, view: StepView, commands: PendingCommands, spec: JointSpec,
                 name: str) -> None:
        self.name, self.spec_name = name, spec.name
        self.parent, self.child = spec.parent, spec.child
        self._view, self._commands = view, commands
        self.row = -1
        self.motor: Optional[JointMotor] = None
        self.servo: Optional[JointServo] = None
        self.spec = spec

    @property
    def position(self) -> float:
        """rad or m."""
        return self._view.axis_at(self.row)[0]

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""
        return self._view.axis_at(self.row)[1]

    @property
    def set_count(self) -> float:
        """The number of times the position was set directly."""
        return self._view.set_count(self.row)

    def drive(self, rate: float, effort: float, ramp: Optional[RateRamp] = None) -> None:
        self.motor = JointMotor(self.row, check_finite(rate, "the rate of a motor"),
                                check_number(effort, "the effort of a motor"), ramp)
        self._commands.motors[self.row] = self.motor

    def set_servo(self, servo: JointServo) -> None:
        """Drive the axis by a servo of the engine."""
        self.servo = replace(servo, row=self.row)
        self._commands.servos[self.row] = self.servo

    def moved_to(self, row: int) -> None:
        """Set the row of the axis, and send the motor or servo command for it again."""
        self.row = row
        if self.motor is not None:
            self.drive(self.motor.rate, self.motor.effort, self.motor.ramp)
        if self.servo is not None:
            self.set_servo(self.servo)

    def release(self) -> None:
        """Switch off the motor and the servo."""
        if self.motor is not None:
            self.drive(0.0, 0.0)
        if self.servo is not None:
            self.set_servo(JointServo(self.row, ""))
