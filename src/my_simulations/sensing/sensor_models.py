"""Measurements of sensors without rays or pictures, as functions of the state (Gazebo 11)."""
from __future__ import annotations

from typing import NamedTuple

from ..engine.commands import JointWrench
from ..geometry import (
    IDENTITY,
    IDENTITY_QUAT,
    Pose,
    Quat,
    Twist,
    Vec3,
    add,
    compose,
    conjugate,
    cross,
    multiply,
    normalised,
    rotate,
    scale,
    subtract,
    transform,
)


def velocity_at(link: Pose, twist: Twist, mount: Pose) -> Vec3:
    """World velocity (m/s) of a sensor at `mount` (link from sensor): v + w x r.

    `twist` is the link's, at its origin, in world axes.
    """
    lever = rotate(link.orientation, mount.position)
    return add(twist.linear, cross(twist.angular, lever))


def acceleration_between(before: Vec3, now: Vec3, elapsed: float) -> Vec3:
    """Mean acceleration (m/s^2) between two velocities `elapsed` s apart, as Gazebo's IMU; 0 for
    no time.
    """
    if elapsed <= 0.0:
        return (0.0, 0.0, 0.0)
    return scale(subtract(now, before), 1.0 / elapsed)


class ImuSample(NamedTuple):
    """A measurement of an inertial measurement unit without noise, in the sensor frame.

    Attributes:
        orientation: reference frame from sensor, x y z w.
        angular_velocity: rad/s.
        linear_acceleration: m/s^2, less gravity: +g upwards at rest, 0 in free fall.
    """

    orientation: Quat
    angular_velocity: Vec3
    linear_acceleration: Vec3


def measure_motion(link: Pose, twist: Twist, acceleration: Vec3, gravity: Vec3, mount: Pose,
                   reference: Quat = IDENTITY_QUAT) -> ImuSample:
    """Return the measurement of an inertial measurement unit.

    Args:
        link: world pose of its link.
        twist: of its link, world axes.
        acceleration: of the sensor's point, world axes (`acceleration_between`).
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


class Altitude(NamedTuple):
    """`vertical_position` m above the reference; `vertical_velocity` m/s, upwards positive."""

    vertical_position: float
    vertical_velocity: float


def measure_altitude(link: Pose, twist: Twist, mount: Pose, reference: float = 0.0) -> Altitude:
    """Height of the sensor over `reference` (world z; Gazebo takes where it was at the start)."""
    return Altitude(transform(link, mount.position)[2] - reference,
                    velocity_at(link, twist, mount)[2])


def measure_magnetic_field(link: Pose, mount: Pose, magnetic_field: Vec3) -> Vec3:
    """The world's field (tesla, world axes; SDF `<magnetic_field>`) in the sensor frame."""
    return rotate(conjugate(compose(link, mount).orientation), magnetic_field)


class WrenchSample(NamedTuple):
    """A measurement without noise: force, N, and torque about the joint's origin, N m."""

    force: Vec3
    torque: Vec3


def measure_wrench(wrench: JointWrench, frame: str = "child",
                   measure_direction: str = "child_to_parent", joint: Pose = IDENTITY,
                   sensor: Pose = IDENTITY) -> WrenchSample:
    """Return the measurement of a force-torque sensor of a joint.

    The defaults are those of SDF, and of `libgazebo_ros_ft_sensor.so`.

    Args:
        wrench: of its joint.
        frame: in whose axes: `child`, `parent` or `sensor`; others are `child`. The torque is
            about the joint's origin for all of them. Where the parent is the world, `parent` means
            the child's axes (Gazebo behaviour).
        measure_direction: `child_to_parent` for what the child exerts on the parent (a weight that
            hangs on it points down), `parent_to_child` for the opposite; others are the former.
        joint: child link from joint (`Joint.pose`), and
        sensor: joint from sensor (`Sensor.pose`); both for the frame `sensor` only.
    """
    sign = 1.0 if measure_direction == "parent_to_child" else -1.0
    turn: Quat = (0.0, 0.0, 0.0, 1.0)
    if frame == "parent":
        turn = wrench.parent_from_child
    elif frame == "sensor":
        turn = conjugate(multiply(joint.orientation, sensor.orientation))
    return WrenchSample(scale(rotate(turn, wrench.force), sign),
                        scale(rotate(turn, wrench.torque), sign))
