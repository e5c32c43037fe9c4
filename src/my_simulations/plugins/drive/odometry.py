"""nav_msgs/Odometry, as the drives of Gazebo publish it."""
from __future__ import annotations

import math
from typing import List, Optional, Sequence, Tuple

from ...geometry import Pose, Twist, quat_from_rpy, rpy_from_quat
from ..context import Context, Joint, Publication
from ..frames import add_tf_prefix
from ..standard_messages import diagonal_covariance, odometry_message

_UNKNOWN_VARIANCE = 1e12  # of what a wheeled robot does not measure

NO_COVARIANCE = (0.0,) * 6
DRIVE_COVARIANCE = (1e-5, 1e-5, _UNKNOWN_VARIANCE, _UNKNOWN_VARIANCE, _UNKNOWN_VARIANCE, 1e-3)


def planar_pose(x: float, y: float, yaw: float) -> Pose:
    """Return a pose in the plane of the ground."""
    return Pose((x, y, 0.0), quat_from_rpy(0.0, 0.0, yaw))


def heading_velocity(pose: Pose, twist: Twist) -> Tuple[float, float, float]:
    """Forward and sideways velocity in the robot's heading, and the yaw rate in the world."""
    yaw = rpy_from_quat(pose.orientation)[2]
    (vx, vy, _), c, s = twist.linear, math.cos(yaw), math.sin(yaw)
    return c * vx + s * vy, c * vy - s * vx, twist.angular[2]


def planar_twist(velocity: Tuple[float, float, float]) -> Twist:
    """Return the twist of a velocity along x and y, and of a yaw rate."""
    x, y, yaw = velocity
    return Twist((x, y, 0.0), (0.0, 0.0, yaw))


class WheelRotations:
    """Rotation of wheels between two calls, rad, without positions that were set directly.

    Gazebo's drives integrate wheel rates, so /gazebo/set_model_configuration does not move the
    odometry. Positions have no drift; rates are used only over such a jump.
    """

    def __init__(self, joints: Sequence[Joint]) -> None:
        self._joints = joints
        self.restart()

    def restart(self) -> None:
        """Restart the count at the present wheel positions."""
        self._last = [(joint.position, joint.set_count) for joint in self._joints]

    def rotations_since_last(self, dt: float) -> List[float]:
        """Return the rotation of each wheel since the last call, `dt` s ago."""
        before, self._last = self._last, []
        turns = []
        for joint, (position, count) in zip(self._joints, before):
            began, now = joint.set_count, joint.position
            steady = count in (began, -1.0)   # there is no count outside of observations
            self._last.append((now, began))
            turns.append(now - position if steady else joint.velocity * dt)
        return turns


class WheelCounter:
    """Pose of a robot from the rotation of its wheels; Siegwart, Autonomous Mobile Robots, 5.2.4.

    Attributes:
        pose: since the last `reset`.
    """

    def __init__(self, left: Joint, right: Joint, radius: float, separation: float) -> None:
        self._wheels = WheelRotations((left, right))
        self._radius, self._separation = radius, separation
        self.reset()

    def reset(self) -> None:
        """Reset the pose, and restart the count at the present wheel positions."""
        self._x = self._y = self._yaw = 0.0
        self.discard_rotation()

    def discard_rotation(self) -> None:
        """Discard the rotation of the wheels since the last count."""
        self._wheels.restart()

    @property
    def pose(self) -> Pose:
        """The pose in the plane of the ground."""
        return planar_pose(self._x, self._y, self._yaw)

    def count(self, dt: float) -> Tuple[float, float, float]:
        """Add the rotation of the last `dt` s; return its mean velocity (forward, 0, yaw)."""
        left, right = (turn * self._radius for turn in self._wheels.rotations_since_last(dt))
        way, turn = (left + right) / 2.0, (right - left) / self._separation
        self._x += way * math.cos(self._yaw + turn / 2.0)
        self._y += way * math.sin(self._yaw + turn / 2.0)
        self._yaw += turn
        return (way / dt, 0.0, turn / dt) if dt > 0.0 else (0.0, 0.0, 0.0)


class Odometer:
    """Publishes odometry and its transform.

    Args:
        context: of the plugin.
        frame, base: tf frames, before `tf_prefix` is applied.
        topic: of the odometry; "" for none.
        covariance: diagonal of the pose's; `twist_covariance` that of the twist's.
    """

    def __init__(self, context: Context, topic: str, frame: str, base: str,
                 covariance: Tuple[float, ...] = DRIVE_COVARIANCE,
                 twist_covariance: Tuple[float, ...] = NO_COVARIANCE) -> None:
        self._context = context
        self._frames = (add_tf_prefix(context, frame), add_tf_prefix(context, base))
        self._topic = context.publish(topic, "nav_msgs/Odometry") if topic else None
        self.topics: List[Publication] = [self._topic] if self._topic is not None else []
        self._covariances = (diagonal_covariance(covariance), diagonal_covariance(twist_covariance))

    def transform(self, pose: Pose) -> None:
        """Broadcast odom -> base."""
        self._context.transform(*self._frames, pose)

    def publish(self, pose: Pose, velocity: Tuple[float, float, float],
                yaw_variance: Optional[float] = None) -> None:
        """Publish a pose, and (forward, sideways, yaw) velocity in the base frame.

        `yaw_variance`: of the yaw and of its rate in this message, rad^2 and rad^2/s^2; None for
        those of the diagonals.
        """
        if self._topic is None or not self._topic.wanted:
            return
        message = odometry_message(self._context, self._frames, pose, planar_twist(velocity),
                                   self._covariances)
        if yaw_variance is not None:
            message.pose.covariance[35] = message.twist.covariance[35] = yaw_variance
        self._topic.publish(message)
