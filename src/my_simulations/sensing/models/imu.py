"""An inertial measurement unit (Gazebo Classic 11, `ImuSensor`)."""
from __future__ import annotations

from typing import NamedTuple

from ...geometry import (
    IDENTITY_QUAT,
    Pose,
    Quat,
    Twist,
    Vec3,
    compose,
    conjugate,
    multiply,
    normalised,
    rotate,
    subtract,
)


class ImuSample(NamedTuple):
    """Without noise, in the sensor frame.

    Attributes:
        orientation: reference frame from sensor, x y z w.
        angular_velocity: rad/s.
        linear_acceleration: m/s^2, less gravity: +g upwards at rest, 0 in free fall.
    """

    orientation: Quat
    angular_velocity: Vec3
    linear_acceleration: Vec3


def measure(link: Pose, twist: Twist, acceleration: Vec3, gravity: Vec3, mount: Pose,
            reference: Quat = IDENTITY_QUAT) -> ImuSample:
    """What it reads.

    Args:
        link: world pose of its link.
        twist: of its link, world axes.
        acceleration: of the sensor's point, world axes (`motion.acceleration_between`).
        gravity: world axes, m/s^2.
        mount: link from sensor.
        reference: world from the frame that orientations refer to: identity for the world's (REP
            145 ENU), the first orientation for Gazebo's `initialOrientationAsReference`.
    """
    sensor = compose(link, mount)
    back = conjugate(sensor.orientation)
    return ImuSample(
        normalised(multiply(conjugate(reference), sensor.orientation)),
        rotate(back, twist.angular), rotate(back, subtract(acceleration, gravity)))
