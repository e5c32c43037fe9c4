"""What drives with wheels share: commands, wheel frames, joint states of wheels."""
from __future__ import annotations

from typing import Any, Callable, List, Optional, Sequence

from ...geometry import compose, inverse
from ..context import Context, Joint, Publication
from ..finite_messages import finite_only
from ..frames import prefixed, stamped
from ..time_out import TimeOut


class VelocityCommand:
    """The last geometry_msgs/Twist; it holds for ever, as in Gazebo, unless it is given a time.

    Attributes:
        x, y: m/s.
        yaw: rad/s.
    """

    def __init__(self, context: Context, topic: str, timeout: Optional[float] = None,
                 changed: Callable[[], None] = lambda: None) -> None:
        """`timeout`: s of sim time after which a command expires; None for never.

        `changed` is called when a command has come.
        """
        self._changed = changed
        self._time_out = TimeOut(context, timeout) if timeout is not None else None
        self.stop()
        context.subscribe(topic, "geometry_msgs/Twist", finite_only(context, topic, self._hear))

    def stop(self) -> None:
        """As if none had come."""
        self.x = self.y = self.yaw = 0.0

    def _hear(self, message: Any) -> None:
        self.x, self.y, self.yaw = message.linear.x, message.linear.y, message.angular.z
        if self._time_out is not None:
            self._time_out.begin()
        self._changed()

    def look(self) -> None:
        """Forget a command that is too old."""
        if self._time_out is not None and self._time_out.is_over:
            self.stop()


class WheelFrames:
    """Broadcasts where wheels are in the links that carry them."""

    def __init__(self, context: Context, joints: Sequence[Joint]) -> None:
        self._context = context
        self._pairs = [(prefixed(context, joint.parent), prefixed(context, joint.child),
                        context.link(joint.parent), context.link(joint.child))
                       for joint in joints]

    def send(self) -> None:
        """As of now."""
        for parent, child, carrier, wheel in self._pairs:
            self._context.transform(parent, child, compose(inverse(carrier.pose), wheel.pose))


class WheelStates:
    """Publishes sensor_msgs/JointState of the wheels."""

    def __init__(self, context: Context, joints: Sequence[Joint], motion: bool = False,
                 frame: str = "") -> None:
        """`motion`: with velocities; `frame`: of the header."""
        self._context, self._joints, self._motion = context, list(joints), motion
        self._frame = frame
        self._topic = context.publish("joint_states", "sensor_msgs/JointState", 1000)
        self.topics: List[Publication] = [self._topic]

    def send(self) -> None:
        """As of now."""
        if not self._topic.wanted:
            return
        message = stamped(self._context, "sensor_msgs/JointState", self._frame)
        message.name = [joint.name for joint in self._joints]
        message.position = [joint.position for joint in self._joints]
        if self._motion:
            message.velocity = [joint.velocity for joint in self._joints]
            message.effort = [0.0] * len(self._joints)
        self._topic.publish(message)
