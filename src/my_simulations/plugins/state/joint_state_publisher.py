"""libgazebo_ros_joint_state_publisher.so: positions and velocities of joints."""
from __future__ import annotations

from typing import List

from ..base import Plugin
from ..context import Joint, PluginError
from ..standard_messages import joint_state_message


class JointStatePublisher(Plugin):
    """Publishes `joint_states` (sensor_msgs/JointState)."""

    def load(self) -> None:
        """Find the joints of `<jointName>`, a list with commas."""
        context, p = self.enter_namespace(self.context.model)
        names = [name.strip() for name in p.text("jointName").split(",") if name.strip()]
        if not names:
            context.warn("it has no <jointName>, and publishes empty joint_states")
        self._joints: List[Joint] = []
        for name in names:
            try:
                self._joints.append(context.joint(name))
            except PluginError as fault:
                context.warn(f"{fault}; its state is not published")
        self._topic = context.publish("joint_states", "sensor_msgs/JointState", 1000)
        context.observe(p.number("updateRate", 100.0), self.update, [self._topic])

    def update(self) -> None:
        self._topic.publish(joint_state_message(self.context, self._joints))
