"""Controllers that pass commands on: of one joint (Float64), of a group (Float64MultiArray)."""
from __future__ import annotations

from typing import Any, List

from .controller import Controller
from .hardware import EFFORT, POSITION, VELOCITY, HardwareJoint


class Forward(Controller):
    """One joint: the parameter `joint`, the topic `command`."""

    interface = ""

    def load(self) -> None:
        """Take the joint."""
        self._joint = self.take(self.interface, self.settings.text("joint"))
        self.subscribe("command", "std_msgs/Float64", self._hear)

    def start(self) -> None:
        """Hold the position, or command 0."""
        self._joint.rest()

    def _hear(self, message: Any) -> None:
        self._joint.command(float(message.data))


class Group(Controller):
    """Several joints: the parameter `joints`, the topic `command`."""

    interface = ""

    def load(self) -> None:
        """Take the joints."""
        self.joints: List[HardwareJoint] = [self.take(self.interface, name)
                                            for name in self.settings.texts("joints")]
        self.subscribe("command", "std_msgs/Float64MultiArray", self._hear)

    def start(self) -> None:
        """Hold the position, or command 0."""
        for joint in self.joints:
            joint.rest()

    def _hear(self, message: Any) -> None:
        if len(message.data) != len(self.joints):
            self.context.warn(f"controller '{self.name}' has {len(self.joints)} joints, and"
                              f" ignores a command of {len(message.data)}")
            return
        for joint, value in zip(self.joints, message.data):
            self.command(joint, float(value))

    def command(self, joint: HardwareJoint, value: float) -> None:
        """Pass a value on."""
        joint.command(value)


class PositionForward(Forward):
    """position_controllers/JointPositionController."""

    interface = POSITION


class VelocityForward(Forward):
    """velocity_controllers/JointVelocityController."""

    interface = VELOCITY


class EffortForward(Forward):
    """effort_controllers/JointEffortController."""

    interface = EFFORT


class PositionGroup(Group):
    """position_controllers/JointGroupPositionController."""

    interface = POSITION


class VelocityGroup(Group):
    """velocity_controllers/JointGroupVelocityController."""

    interface = VELOCITY


class EffortGroup(Group):
    """effort_controllers/JointGroupEffortController."""

    interface = EFFORT
