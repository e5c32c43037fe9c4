"""joint_state_controller: publishes `joint_states` of all joints that have a transmission."""
from __future__ import annotations

from typing import Any, List, Sequence, Tuple, Union

from ..context import Context, Joint
from ..frames import stamp_message
from ..standard_messages import joint_state_message
from .controller import Controller
from .hardware import EFFORT, POSITION, VELOCITY, Hardware, HardwareJoint

_ORDER = (POSITION, VELOCITY, EFFORT)   # of the joints in a message
_UPDATE_HZ = 100.0                      # without a rate


def make_joint_state(context: Context, hardware: Hardware,
                     joints: Sequence[Union[Joint, HardwareJoint]]) -> Any:
    """Make a sensor_msgs/JointState with the present positions, rates and efforts."""
    return joint_state_message(context, joints,
                               efforts=hardware.efforts([joint.name for joint in joints]))


class JointStateController(Controller):
    """Names, in alphabetical order, and extra joints as the original.

    The topic is in the robot's namespace.
    """

    def load(self) -> None:
        """Find the joints, the rate, and joints that are not there but are to be published."""
        names = self.settings.texts("joints", sorted(self.hardware.names))
        self._joints = [self.hardware.state(name) for name in names]
        self._rate = self.settings.number("publish_rate")
        self._extra = self._extras(names)
        self._topic = self.context.publish("joint_states", "sensor_msgs/JointState", 4)
        self.keep_handle(self._topic)

    def start(self) -> None:
        if self._rate > 0.0:
            self.observe(self._rate, self._publish_states, [self._topic],
                         efforts=[joint.name for joint in self._joints])

    def _extras(self, known: List[str]) -> List[Tuple[str, float, float, float]]:
        found: List[Tuple[str, float, float, float]] = []
        for one in self.settings.get("extra_joints") or []:
            if isinstance(one, dict) and isinstance(one.get("name"), str):
                if one["name"] in known:
                    continue
                found.append((one["name"], float(one.get("position", 0.0)),
                              float(one.get("velocity", 0.0)), float(one.get("effort", 0.0))))
            else:
                self.context.warn(f"an entry of {self.name}/extra_joints has no name; it is"
                                  " left out")
        return found

    def _publish_states(self) -> None:
        message = make_joint_state(self.context, self.hardware, self._joints)
        for name, position, velocity, effort in self._extra:
            message.name.append(name)
            message.position.append(position)
            message.velocity.append(velocity)
            message.effort.append(effort)
        self._topic.publish(message)


class JointReadCommandController(Controller):
    """Publishes on `joint_commands` what joints are commanded, by their interfaces.

    Source: joint_read_command_controller of Robotnik. Where it differs: it reads all joints,
    through any interface; a joint that a loop of the engine commands has 0.
    """

    def load(self) -> None:
        self._rate = self.settings.number("publish_rate", 0.0)
        self._topic = self.context.publish("joint_commands", "sensor_msgs/JointState", 4)
        self.keep_handle(self._topic)

    def start(self) -> None:
        self.observe(self._rate if self._rate > 0.0 else _UPDATE_HZ, self._publish_states,
                     [self._topic])

    def _publish_states(self) -> None:
        context, joints = self.context, sorted(
            self.hardware.joints, key=lambda joint: (_ORDER.index(joint.interface), joint.name))
        message = stamp_message(context, "sensor_msgs/JointState")
        message.name = [joint.name for joint in joints]
        commands = [joint.read_command(context.step, context.step_size) or 0.0 for joint in joints]
        message.position, message.velocity, message.effort = (
            [value if joint.interface == interface else 0.0
             for joint, value in zip(joints, commands)] for interface in _ORDER)
        self._topic.publish(message)
