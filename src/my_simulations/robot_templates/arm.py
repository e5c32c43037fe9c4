"""An arm of four joints with a gripper of two fingers, fixed to the world."""
from __future__ import annotations

import math
from typing import List

from . import sdf_parts as sdf
from .sensor_links import NAMESPACE, namespace
from .template_parameters import Parameter, Values, number

_BASE_RADIUS, _BASE_HEIGHT = 0.09, 0.08
_FINGER = (0.012, 0.012, 0.07)
_FINGER_MASS = 0.05
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist")
FINGERS = ("left_finger_joint", "right_finger_joint")

ARM: List[Parameter] = [
    number("upper_arm", "Length of the upper arm", 0.3, "m", 0.1, 2.0),
    number("forearm", "Length of the forearm", 0.25, "m", 0.1, 2.0),
    number("link_mass", "Mass of each part of the arm", 0.5, "kg", 0.05, 50.0),
    number("opening", "Largest opening of the gripper", 0.08, "m", 0.02, 0.3),
    number("stiffness", "Stiffness of the joints", 400.0, "N m/rad", 10.0, 1e5),
    number("grip_force", "Largest force of a finger", 20.0, "N", 1.0, 500.0),
    NAMESPACE,
    Parameter("states_topic", "Joint states topic", "joint_states"),
]


def _part(name: str, height: float, length: float, thickness: float, mass: float,
          color: str) -> str:
    """A part of the arm that stands on its joint at a height above the ground; m, kg."""
    size, center = (thickness, thickness, length), (0.0, 0.0, length / 2.0)
    return sdf.link(name, sdf.pose((0.0, 0.0, height)), sdf.box_inertial(mass, size, center),
                    sdf.collision_and_visual(name, sdf.box(size), color, sdf.pose(center)))


def _finger(side: str, sign: float, height: float, values: Values) -> str:
    """A finger of which the joint's position is the way from the closed gripper, m."""
    at = sdf.pose((0.0, sign * _FINGER[1] / 2.0, height + _FINGER[2] / 2.0))
    name = f"{side}_finger"
    return (sdf.link(name, at, sdf.box_inertial(_FINGER_MASS, _FINGER),
                     sdf.collision_and_visual(name, sdf.box(_FINGER), "dark",
                                              surface=sdf.friction(1.5)))
            + sdf.moving_joint(f"{name}_joint", "prismatic", "hand", name, (0.0, sign, 0.0),
                               (0.0, values["opening"] / 2.0, values["grip_force"], 0.5), 2.0))


def arm_with_gripper(values: Values) -> str:
    """The arm stands upright; a position controller holds each joint."""
    mass, upper, fore = values["link_mass"], values["upper_arm"], values["forearm"]
    base = sdf.cylinder(_BASE_RADIUS, _BASE_HEIGHT)
    shoulder = _BASE_HEIGHT + 0.08
    elbow = shoulder + upper
    wrist = elbow + fore
    palm = wrist + 0.06
    hand_size = (0.04, values["opening"] + 2.0 * _FINGER[1], 0.06)
    turret = sdf.cylinder(0.05, 0.08)
    most = 3.0 * 9.8 * mass * (upper + fore + 0.3) + 10.0
    bend = (-2.4, 2.4, most, 3.0)
    parts = [
        sdf.link("base_link", sdf.pose((0.0, 0.0, _BASE_HEIGHT / 2.0)),
                 sdf.cylinder_inertial(4.0, _BASE_RADIUS, _BASE_HEIGHT),
                 sdf.collision_and_visual("base", base, "dark")),
        sdf.link("turret", sdf.pose((0.0, 0.0, _BASE_HEIGHT + 0.04)),
                 sdf.cylinder_inertial(mass, 0.05, 0.08),
                 sdf.collision_and_visual("turret", turret, "light")),
        _part("upper_arm", shoulder, upper, 0.06, mass, "orange"),
        _part("forearm", elbow, fore, 0.05, mass, "orange"),
        sdf.link("hand", sdf.pose((0.0, 0.0, wrist)),
                 sdf.box_inertial(mass / 2.0, hand_size, (0.0, 0.0, 0.03)),
                 sdf.collision_and_visual("hand", sdf.box(hand_size), "light",
                                          sdf.pose((0.0, 0.0, 0.03)))),
        _finger("left", 1.0, palm, values), _finger("right", -1.0, palm, values),
        sdf.fixed_joint("fixed_to_world", "world", "base_link"),
        sdf.moving_joint(JOINTS[0], "revolute", "base_link", "turret", (0.0, 0.0, 1.0),
                         (-math.pi, math.pi, most, 3.0), 0.5),
        sdf.moving_joint(JOINTS[1], "revolute", "turret", "upper_arm", (0.0, 1.0, 0.0), bend, 0.5),
        sdf.moving_joint(JOINTS[2], "revolute", "upper_arm", "forearm", (0.0, 1.0, 0.0), bend, 0.5),
        sdf.moving_joint(JOINTS[3], "revolute", "forearm", "hand", (0.0, 1.0, 0.0), bend, 0.2),
    ]
    stiff = values["stiffness"]
    hold = f"{stiff:g} 0 {stiff / 20.0:g}"
    controllers = "".join(
        f'<controller type="position"><joint>{joint}</joint><target>{target:g}</target>'
        f"<pid_gains>{gains}</pid_gains></controller>"
        for joint, target, gains in (
            *((name, 0.0, hold) for name in JOINTS),
            *((name, values["opening"] / 2.0, "1000 0 20") for name in FINGERS)))
    holding = f'<plugin name="hold" filename="libJointControlPlugin.so">{controllers}</plugin>'
    states = sdf.plugin("joint_states", "libgazebo_ros_joint_state_publisher.so",
                        robotNamespace=namespace(values), topicName=values["states_topic"],
                        jointName=", ".join((*JOINTS, *FINGERS)), updateRate=50)
    return sdf.document(values["name"], *parts, holding, states)
