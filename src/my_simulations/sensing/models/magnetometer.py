"""A magnetometer (Gazebo Classic 11, `MagnetometerSensor`)."""
from __future__ import annotations

from ...geometry import Pose, Vec3, compose, conjugate, rotate


def measure(link: Pose, mount: Pose, magnetic_field: Vec3) -> Vec3:
    """The world's field (tesla, world axes; SDF `<magnetic_field>`) in the sensor frame."""
    return rotate(conjugate(compose(link, mount).orientation), magnetic_field)
