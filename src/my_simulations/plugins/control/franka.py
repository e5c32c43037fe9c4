"""Hardware and controllers of franka_gazebo: the arm and its joint states.

Source: franka_ros 0.10, franka_control and franka_gazebo. Messages of the package franka_msgs are
not offered.
"""
from __future__ import annotations

from ..context import Context
from ..frames import data_message
from ..world.gravity_compensation import GravityCompensation
from .controller import Controller
from .joint_state import make_joint_state

UPDATE_HZ = 30.0   # without a rate
_JOINT_STATE = "sensor_msgs/JointState"


class FrankaArm:
    """What franka_gazebo/FrankaHWSim adds to the joints: gravity is compensated, and the topic
    `initialized`, for which its launch files wait, says true.
    """

    def __init__(self, context: Context) -> None:
        self._compensation = GravityCompensation(context)
        topic = context.publish("initialized", "std_msgs/Bool", latch=True)
        topic.publish(data_message(context, "std_msgs/Bool", True))

    def reset(self) -> None:
        """Compensate gravity again: forces ended with the reset."""
        self._compensation.apply()


class FrankaStateController(Controller):
    """franka_control/FrankaStateController: `joint_states` and `joint_states_desired`.

    Both have the measured values, as franka_gazebo's have under efforts.
    """

    def load(self) -> None:
        names = self.settings.texts("joint_names", [])
        self._joints = [self.hardware.state(name) for name in names]
        self._rate = self.settings.number("publish_rate", UPDATE_HZ)
        self._topics = [self.publish(name, _JOINT_STATE)
                        for name in ("joint_states", "joint_states_desired")]

    def start(self) -> None:
        self.observe(self._rate if self._rate > 0.0 else UPDATE_HZ, self._publish, self._topics,
                     efforts=[joint.name for joint in self._joints])

    def _publish(self) -> None:
        for topic in self._topics:
            topic.publish(make_joint_state(self.context, self.hardware, self._joints))
