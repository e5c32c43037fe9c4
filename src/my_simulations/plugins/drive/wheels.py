"""What drives with wheels share: commands, wheel frames, joint states of wheels."""
from __future__ import annotations

import math
from typing import Any, Callable, List, Optional, Sequence, Tuple

from ...geometry import compose, inverse
from ..call_slot import CallSlot
from ..context import Context, Joint, Publication
from ..finite_messages import subscribe_finite
from ..frames import add_tf_prefix
from ..standard_messages import joint_state_message
from ..stepwise_change import StepwiseChange
from ..time_out import TimeOut


class VelocityCommand:
    """The last geometry_msgs/Twist; it applies until the next one, unless it has a timeout.

    Attributes:
        x, y: m/s.
        yaw: rad/s.
    """

    def __init__(self, context: Context, topic: str, timeout: Optional[float],
                 change: StepwiseChange, received: Callable[[], None]) -> None:
        """`timeout`: s of sim time after which a command expires; None for never.

        `change` begins at its first step after the timeout; `received` is called after each
        command.
        """
        self._context, self._change = context, change
        self._received = received
        self._time_out = TimeOut(context, timeout) if timeout is not None else None
        self._expiry = CallSlot()
        self.stop()
        subscribe_finite(context, topic, "geometry_msgs/Twist", self._receive)

    def stop(self) -> None:
        self.x = self.y = self.yaw = 0.0
        self._expiry.end()

    def clock_set(self) -> None:
        """Schedule the expiry of the last command again after sim time was set back."""
        if self._expiry.is_active:
            self._begin_expiry()

    def _receive(self, message: Any) -> None:
        self.x, self.y, self.yaw = message.linear.x, message.linear.y, message.angular.z
        if self._time_out is not None:
            self._time_out.begin()
        self._begin_expiry()
        self._received()

    def wheel_speeds(self, separation: float) -> Tuple[float, float]:
        """Return the speeds of a left and a right wheel with a distance (m) between them, m/s."""
        turn = self.yaw * separation / 2.0
        return self.x - turn, self.x + turn

    def discard_if_expired(self) -> None:
        if self._time_out is not None and self._time_out.is_over:
            self.stop()

    def _begin_expiry(self) -> None:
        if self._time_out is not None:
            self._expiry.set(self._change.begin_after(self._time_out.end_ns))


class WheelFrames:
    """Broadcasts the poses of wheels in the links that carry them."""

    def __init__(self, context: Context, joints: Sequence[Joint]) -> None:
        self._context = context
        self._pairs = [(add_tf_prefix(context, joint.parent), add_tf_prefix(context, joint.child),
                        context.link(joint.parent), context.link(joint.child))
                       for joint in joints]

    def send(self) -> None:
        for parent, child, carrier, wheel in self._pairs:
            self._context.transform(parent, child, compose(inverse(carrier.pose), wheel.pose))


class WheelStates:
    """Publishes sensor_msgs/JointState of the wheels."""

    def __init__(self, context: Context, joints: Sequence[Joint], motion: bool = False,
                 frame: str = "", topic: str = "joint_states", queue: int = 1000) -> None:
        """`motion`: with velocities; `frame`: of the header."""
        self._context, self._joints, self._motion = context, list(joints), motion
        self._frame = frame
        self._topic = context.publish(topic, "sensor_msgs/JointState", queue)
        self.topics: List[Publication] = [self._topic]

    def send(self) -> None:
        if self._topic.wanted:
            self._topic.publish(joint_state_message(
                self._context, self._joints, self._frame,
                [0.0] * len(self._joints) if self._motion else None, self._motion))


FASTEST = 1e3  # rad/s: no wheel of a car turns as fast


def apply_torque(wheel: Joint, torque: float, friction: float = 0.0,
                 most_rate: float = FASTEST) -> None:
    """Apply a torque against Coulomb friction, N m, until the next call.

    The joint's motor does both. A torque above the friction accelerates the wheel, up to
    `most_rate` (rad/s); a friction above the torque stops it.
    """
    friction += wheel.spec.axis.friction if wheel.spec.axis is not None else 0.0
    if torque * wheel.velocity < 0.0:
        friction = -friction   # both act against the motion
    left = friction - abs(torque)
    if left < 0.0:
        wheel.drive(math.copysign(most_rate, torque), -left)
    else:
        wheel.drive(0.0, left)
