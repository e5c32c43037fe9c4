"""Cars on wheels: a differential drive with a caster, and four wheels that skid."""
from __future__ import annotations

import math
from typing import List

from ..errors import CommandError
from . import sdf_parts as sdf
from .sensor_links import (
    CAMERA,
    CAMERA_SIZE,
    IMU,
    IMU_SIZE,
    LASER,
    LASER_LENGTH,
    NAMESPACE,
    camera_link,
    imu_link,
    laser_link,
    namespace,
)
from .template_parameters import Parameter, Values, number

_GAP = 0.01
"""Between wheel and body, m."""
_NO_LIMIT = (-1e16, 1e16, 20.0, 1e3)


def car_parameters(length: float, width: float, mass: float, wheel: float) -> List[Parameter]:
    """The form of a car, with defaults of its size; m, kg."""
    return [
        number("length", "Body length", length, "m", 0.1, 5.0),
        number("width", "Body width", width, "m", 0.05, 3.0),
        number("body_height", "Body height", 0.1, "m", 0.02, 2.0),
        number("mass", "Body mass", mass, "kg", 0.1, 2000.0),
        number("wheel_radius", "Wheel radius", wheel, "m", 0.02, 1.0),
        number("wheel_width", "Wheel width", 0.04, "m", 0.005, 0.5),
        number("wheel_mass", "Mass of each wheel", 0.3, "kg", 0.01, 100.0),
        number("torque", "Largest torque of each wheel", 5.0, "N m", 0.1, 5000.0),
        NAMESPACE,
        Parameter("command_topic", "Velocity topic", "cmd_vel"),
        Parameter("odometry_topic", "Odometry topic", "odom"),
        Parameter("camera", "Camera", True), *CAMERA,
        Parameter("laser", "Laser scanner", False), *LASER,
        Parameter("imu", "IMU", False), *IMU,
    ]


def _middle(values: Values) -> float:
    """Height of the body's middle above the ground, m. Raises CommandError."""
    height, radius = values["body_height"], values["wheel_radius"]
    if values["length"] < 2.0 * radius:
        raise CommandError("Body length must be at least the diameter of a wheel")
    return float(max(radius + height / 4.0, height / 2.0 + radius / 2.0))


def _wheel(name: str, place: sdf.Triple, values: Values, mu: float) -> str:
    """A wheel with its axis along y, and the joint that turns it forward with positive speed."""
    radius, width = values["wheel_radius"], values["wheel_width"]
    round_ = sdf.cylinder(radius, width)
    hub = sdf.visual("hub", sdf.box((radius, radius / 3.0, width * 1.02)), "light")
    return (sdf.link(f"{name}_wheel", sdf.pose(place, (-math.pi / 2.0, 0.0, 0.0)),
                     sdf.cylinder_inertial(values["wheel_mass"], radius, width),
                     sdf.collision_and_visual("tire", round_, "dark",
                                              surface=sdf.friction(mu)), hub)
            + sdf.moving_joint(f"{name}_wheel_joint", "revolute", "base_link", f"{name}_wheel",
                               (0.0, 0.0, 1.0), _NO_LIMIT))


def _body(values: Values, offset: float, *more: str) -> str:
    """`base_link`: its origin is on the ground, its box lies `offset` m before it."""
    size = (values["length"], values["width"], values["body_height"])
    center = (offset, 0.0, _middle(values))
    return sdf.link("base_link", sdf.pose((0.0, 0.0, 0.0)),
                    sdf.box_inertial(values["mass"], size, center),
                    sdf.collision_and_visual("body", sdf.box(size), "orange",
                                             sdf.pose(center)), *more)


def _sensors(values: Values, offset: float) -> str:
    """The chosen sensors on the roof: camera in front, laser in the middle, IMU at the back."""
    roof = _middle(values) + values["body_height"] / 2.0
    front = offset + values["length"] / 2.0
    parts = []
    if values["camera"]:
        place = (front - CAMERA_SIZE[0] / 2.0, 0.0, roof + CAMERA_SIZE[2] / 2.0)
        parts += [camera_link(values, place),
                  sdf.fixed_joint("camera_joint", "base_link", "camera_link")]
    if values["laser"]:
        place = (offset, 0.0, roof + LASER_LENGTH / 2.0)
        parts += [laser_link(values, place),
                  sdf.fixed_joint("laser_joint", "base_link", "laser_link")]
    if values["imu"]:
        place = (offset - values["length"] / 2.0 + IMU_SIZE[0], 0.0, roof + IMU_SIZE[2] / 2.0)
        parts += [imu_link(values, place), sdf.fixed_joint("imu_joint", "base_link", "imu_link")]
    return "".join(parts)


def differential_drive(values: Values) -> str:
    """Two driven wheels about the model's origin, and a caster behind them."""
    radius, width = values["wheel_radius"], values["wheel_width"]
    track = values["width"] + 2.0 * _GAP + width
    offset = -0.2 * values["length"]
    # The ball touches the ground, and its top is inside of the body.
    ball = (_middle(values) - values["body_height"] / 2.0) / 2.0 + _GAP / 2.0
    at = sdf.pose((offset - values["length"] / 2.0 + ball, 0.0, ball))
    caster = sdf.collision_and_visual("caster", sdf.sphere(ball), "light", at, sdf.friction(0.0))
    wheels = "".join(_wheel(side, (0.0, sign * track / 2.0, radius), values, 1.0)
                     for side, sign in (("left", 1.0), ("right", -1.0)))
    drive = sdf.plugin("drive", "libgazebo_ros_diff_drive.so", robotNamespace=namespace(values),
                       leftJoint="left_wheel_joint", rightJoint="right_wheel_joint",
                       wheelSeparation=f"{track:.6g}", wheelDiameter=f"{2.0 * radius:.6g}",
                       wheelTorque=f'{values["torque"]:g}', wheelAcceleration=2,
                       commandTopic=values["command_topic"],
                       odometryTopic=values["odometry_topic"], odometryFrame="odom",
                       robotBaseFrame="base_link", odometrySource="encoder", updateRate=50)
    return sdf.document(values["name"], _body(values, offset, caster), wheels,
                        _sensors(values, offset), drive)


def four_wheels(values: Values) -> str:
    """Four driven wheels; the car turns by different speeds of its sides."""
    radius, width = values["wheel_radius"], values["wheel_width"]
    track = values["width"] + 2.0 * _GAP + width
    axle = values["length"] / 2.0 - radius
    wheels = "".join(_wheel(f"{end}_{side}", (along * axle, across * track / 2.0, radius), values,
                            0.8)
                     for end, along in (("front", 1.0), ("rear", -1.0))
                     for side, across in (("left", 1.0), ("right", -1.0)))
    drive = sdf.plugin("drive", "libgazebo_ros_skid_steer_drive.so",
                       robotNamespace=namespace(values),
                       leftFrontJoint="front_left_wheel_joint",
                       rightFrontJoint="front_right_wheel_joint",
                       leftRearJoint="rear_left_wheel_joint",
                       rightRearJoint="rear_right_wheel_joint",
                       wheelSeparation=f"{track:.6g}", wheelDiameter=f"{2.0 * radius:.6g}",
                       torque=f'{values["torque"]:g}', commandTopic=values["command_topic"],
                       odometryTopic=values["odometry_topic"], odometryFrame="odom",
                       robotBaseFrame="base_link", broadcastTF="true", updateRate=50)
    return sdf.document(values["name"], _body(values, 0.0), wheels, _sensors(values, 0.0), drive)
