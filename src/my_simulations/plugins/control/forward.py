"""Controllers that forward commands to joints. Source: forward_command_controller."""
from __future__ import annotations

from typing import Any, List

from .controller import Controller
from .hardware import HardwareJoint


class ForwardCommandController(Controller):
    """Forwards std_msgs/Float64 on `command` to the joint in the parameter `joint`."""

    def load(self) -> None:
        self._joint = self.claim_joint(self.interface, self.settings.text("joint"))
        self.subscribe("command", "std_msgs/Float64", self._receive)

    def start(self) -> None:
        """Hold the position, or command rate or effort 0."""
        self._joint.set_idle()

    def _receive(self, message: Any) -> None:
        self._joint.command(float(message.data))


class ForwardGroupController(Controller):
    """Forwards std_msgs/Float64MultiArray on `command` to the joints in the parameter `joints`."""

    def load(self) -> None:
        self.joints: List[HardwareJoint] = [self.claim_joint(self.interface, name)
                                            for name in self.settings.texts("joints")]
        self.subscribe("command", "std_msgs/Float64MultiArray", self._receive)

    def start(self) -> None:
        """Hold the position, or command rate or effort 0."""
        for joint in self.joints:
            joint.set_idle()

    def _receive(self, message: Any) -> None:
        if len(message.data) != len(self.joints):
            self.context.warn(f"controller '{self.name}' has {len(self.joints)} joints, and"
                              f" ignores a command of {len(message.data)}")
            return
        for joint, value in zip(self.joints, message.data):
            self.command(joint, float(value))

    def command(self, joint: HardwareJoint, value: float) -> None:
        joint.command(value)
