"""A force-torque sensor of a joint (Gazebo Classic 11, `ForceTorqueSensor`)."""
from __future__ import annotations

from typing import NamedTuple

from ...engine.commands import JointWrench
from ...geometry import IDENTITY, Pose, Quat, Vec3, conjugate, multiply, rotate, scale


class WrenchSample(NamedTuple):
    """Without noise: force, N, and torque about the joint's origin, N m."""

    force: Vec3
    torque: Vec3


def measure(wrench: JointWrench, frame: str = "child",
            measure_direction: str = "child_to_parent", joint: Pose = IDENTITY,
            sensor: Pose = IDENTITY) -> WrenchSample:
    """What it reads; the defaults are those of SDF, and of `libgazebo_ros_ft_sensor.so`.

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
