"""An altimeter (Gazebo Classic 11, `AltimeterSensor`)."""
from __future__ import annotations

from typing import NamedTuple

from ...geometry import Pose, Twist, transform
from .motion import velocity_at


class Altitude(NamedTuple):
    """`vertical_position` m above the reference; `vertical_velocity` m/s, upwards positive."""

    vertical_position: float
    vertical_velocity: float


def measure(link: Pose, twist: Twist, mount: Pose, reference: float = 0.0) -> Altitude:
    """Height of the sensor over `reference` (world z; Gazebo takes where it was at the start)."""
    return Altitude(transform(link, mount.position)[2] - reference,
                    velocity_at(link, twist, mount)[2])
