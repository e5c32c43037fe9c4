"""Mobile bases of four kinds on a slope, and what Coulomb's law and kinematics say of them.

Positions, velocities and headings are those in the frame of the slope, whose x axis points up it.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Callable, Dict, List, NamedTuple, Tuple

from conftest import Lab, inertial_of_box, slab

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Cylinder, Sphere, Surface
from my_simulations.engine.drive_commands import JointMotor, JointServo, SetMotors, SetServos
from my_simulations.geometry import (
    Pose,
    Vec3,
    conjugate,
    multiply,
    quat_from_rpy,
    rotate,
)

G = 9.8
EFFORT = 1e3                              # N m, of motors
LYING = quat_from_rpy(-math.pi / 2, 0, 0)   # the axle of a wheel is its z axis


@dataclass(frozen=True)
class MobileBase:
    """A base and the rates of its wheels.

    Attributes:
        model: stands on the ground at the origin, its front along x.
        rates: returns the rates of the driven wheels, rad/s, by joint, for a velocity ahead, m/s,
            and a turn, rad/s.
        steer: returns the positions of the steered joints, rad, for the same.
    """

    model: Model
    rates: Callable[[float, float], Dict[str, float]]
    steer: Callable[[float, float], Dict[str, float]]


def _wheel(name: str, at: Vec3, radius: float, width: float, mass: float, mu: float,
           parent: str = "link") -> Tuple[Link, Joint]:
    across, about = mass * (3 * radius ** 2 + width ** 2) / 12, mass * radius ** 2 / 2
    return (Link(name, Pose(at, LYING), Inertial(mass, ixx=across, iyy=across, izz=about),
                 [Collision("c", Cylinder(radius, width), surface=Surface(mu=mu, mu2=mu))]),
            Joint(f"{name}_joint", "revolute", parent, name, axis=JointAxis((0.0, 0.0, 1.0))))


def _not_steered(ahead: float, turn: float) -> Dict[str, float]:
    return {}


def differential(mu: float) -> MobileBase:
    """Two driven wheels in the middle, and a box that slides behind them; a small robot's size."""
    radius, aside, rear = 0.033, 0.08, 0.081
    links = [Link("link", Pose((0, 0, 0.01)), Inertial(
        0.83, Pose((-0.02, 0, 0.01)), 2.2e-3, 0, 0, 2.1e-3, 0, 2.0e-3),
        [Collision("body", Box((0.14, 0.14, 0.1)), Pose((0, 0, 0.08)))]),
             Link("caster", Pose((-rear, 0, 0.006)), Inertial(0.005, ixx=1e-3, iyy=1e-3, izz=1e-3),
                  [Collision("c", Box((0.03, 0.02, 0.012)), surface=Surface(mu=0.1, mu2=0.1))])]
    joints = [Joint("mount", "fixed", "link", "caster")]
    for name, y in (("left", aside), ("right", -aside)):
        link, joint = _wheel(name, (0, y, radius), radius, 0.018, 0.0285, mu)
        links.append(link)
        joints.append(joint)

    def rates(ahead: float, turn: float) -> Dict[str, float]:
        return {"left_joint": (ahead - turn * aside) / radius,
                "right_joint": (ahead + turn * aside) / radius}
    return MobileBase(Model("differential", links=links, joints=joints), rates, _not_steered)


_CORNERS = {"front_left": (1, 1), "front_right": (1, -1), "rear_left": (-1, 1),
            "rear_right": (-1, -1)}


class _Skid(NamedTuple):
    """The skid-steered base: m, kg, kg m^2 about z. Its centre of mass is `low` below the axles."""

    radius: float = 0.165
    width: float = 0.114
    front: float = 0.256
    aside: float = 0.285
    mass: float = 46.0
    wheel_mass: float = 2.6
    low: float = 0.03
    inertia: float = 2.0


SKID = _Skid()


def skid_steered(mu: float) -> MobileBase:
    """Four wide wheels without steering; a large robot's size."""
    radius, width, front, aside = SKID[:4]
    links = [Link("link", Pose((0, 0, radius)), Inertial(
        SKID.mass, Pose((0, 0, -SKID.low)), 0.6, 0, 0, 1.7, 0, SKID.inertia),
                  [Collision("body", Box((0.98, 0.57, 0.12)), Pose((0, 0, 0.09)))])]
    joints: List[Joint] = []
    for name, (x, y) in _CORNERS.items():
        link, joint = _wheel(name, (x * front, y * aside, radius), radius, width, SKID.wheel_mass,
                             mu)
        links.append(link)
        joints.append(joint)

    def rates(ahead: float, turn: float) -> Dict[str, float]:
        return {f"{name}_joint": (ahead - y * turn * aside) / radius
                for name, (_, y) in _CORNERS.items()}
    return MobileBase(Model("skid", links=links, joints=joints), rates, _not_steered)


def car(mu: float) -> MobileBase:
    """Two steered wheels in front that turn freely, and two driven ones; the origin between those.

    Angles and rates are those of wheels that roll about one point.
    """
    radius, width, aside, ahead_of = 0.1, 0.04, 0.2, 0.6
    links = [Link("link", Pose((0, 0, radius)), inertial_of_box(
        15.0, 0.8, 0.3, 0.2, Pose((ahead_of / 2, 0, 0.05))),
        [Collision("body", Box((0.9, 0.3, 0.1)), Pose((ahead_of / 2, 0, 0.1)))])]
    joints: List[Joint] = []
    for name, (x, y) in _CORNERS.items():
        parent = "link"
        at = (ahead_of * (x + 1) / 2, y * aside, radius)
        if x > 0:
            parent = f"{name}_fork"
            links.append(Link(parent, Pose(at), Inertial(0.3, ixx=3e-3, iyy=3e-3, izz=3e-3)))
            joints.append(Joint(f"{name}_steer", "revolute", "link", parent,
                                axis=JointAxis((0, 0, 1), effort=100.0, velocity=10.0)))
        link, joint = _wheel(name, at, radius, width, 0.5, mu, parent)
        links.append(link)
        joints.append(joint)

    def rates(ahead: float, turn: float) -> Dict[str, float]:
        return {f"{name}_joint": (ahead - y * turn * aside) / radius
                for name, (x, y) in _CORNERS.items() if x < 0}

    def steer(ahead: float, turn: float) -> Dict[str, float]:
        return {f"{name}_steer": math.atan2(turn * ahead_of, ahead - y * turn * aside)
                if turn else 0.0 for name, (x, y) in _CORNERS.items() if x > 0}
    return MobileBase(Model("car", links=links, joints=joints), rates, steer)


def mecanum(mu: float, rollers: int = 16, size: float = 0.04) -> MobileBase:
    """Four wheels with balls on their rims, which turn about axes at 45 degrees to the wheel's.

    The balls are soft, as rubber: rims of hard balls would load one diagonal pair of wheels only.
    """
    radius, front, aside = 0.1, 0.3, 0.25
    links = [Link("link", Pose((0, 0, radius)), inertial_of_box(20.0, 0.8, 0.4, 0.1),
                  [Collision("body", Box((0.9, 0.3, 0.1)))])]
    joints: List[Joint] = []
    moment = 0.4 * 0.05 * size ** 2
    for name, (x, y) in _CORNERS.items():
        links.append(Link(name, Pose((x * front, y * aside, radius)),
                          Inertial(0.5, ixx=2e-3, iyy=3e-3, izz=2e-3)))
        joints.append(Joint(f"{name}_joint", "revolute", "link", name, axis=JointAxis((0, 1, 0))))
        for n in range(rollers):
            angle = 2.0 * math.pi * n / rollers
            hub = (-math.sin(angle) * (radius - size), 0.0, -math.cos(angle) * (radius - size))
            links.append(Link(f"{name}_{n}", Pose((x * front + hub[0], y * aside, radius + hub[2])),
                              Inertial(0.05, ixx=moment, iyy=moment, izz=moment),
                              [Collision("c", Sphere(size), surface=Surface(
                                  mu=mu, mu2=mu, kp=3e4, kd=300.0, max_vel=10.0))]))
            axis = (math.cos(angle), -x * y, -math.sin(angle))
            joints.append(Joint(f"{name}_roller_{n}", "revolute", name, f"{name}_{n}",
                                axis=JointAxis(tuple(math.sqrt(0.5) * part for part in axis))))

    def rates(ahead: float, turn: float) -> Dict[str, float]:
        # A ball does not slip along its axis (1, -x y).
        return {f"{name}_joint": (ahead - y * turn * (front + aside)) / radius
                for name, (_, y) in _CORNERS.items()}
    return MobileBase(Model("mecanum", links=links, joints=joints), rates, _not_steered)


def angle_between(one: float, other: float) -> float:
    """Return the angle between two headings, degrees."""
    return abs(math.degrees(math.remainder(one - other, 2.0 * math.pi)))


KINDS: Dict[str, Callable[[float], MobileBase]] = {
    "differential": differential, "skid": skid_steered, "car": car, "mecanum": mecanum}


class OnSlope:
    """A base in a lab, on a slope that rises along x.

    Args:
        degrees: of the slope.
        heading: of the base on the slope at its start, rad.
    """

    def __init__(self, lab: Lab, base: MobileBase, degrees: float, heading: float = 0.0,
                 ) -> None:
        self.lab, self.base = lab, base
        self.tilt = quat_from_rpy(0.0, -math.radians(degrees), 0.0)
        lab.load(slab("slope", (100.0, 100.0, 1.0)), rotate(self.tilt, (0.0, 0.0, -0.5)), self.tilt)
        self.number = lab.load(base.model, orientation=multiply(
            self.tilt, quat_from_rpy(0.0, 0.0, heading)))

    def drive(self, ahead: float, turn: float = 0.0) -> None:
        """Drive at a velocity ahead, m/s, and a turn, rad/s."""
        rows = self.lab.joint_rows
        angles = self.base.steer(ahead, turn)
        if angles:
            self.lab.apply(SetServos(tuple(JointServo(rows[self.number, name], "position", angle)
                                           for name, angle in angles.items())))
        self.lab.apply(SetMotors(tuple(JointMotor(rows[self.number, name], rate, EFFORT)
                                       for name, rate in self.base.rates(ahead, turn).items())))

    def place(self) -> Tuple[float, float, float]:
        """Where the base is on the slope: x, y, m, and heading, rad."""
        pose = self.lab.pose(self.number, "link")
        x, y, _ = rotate(conjugate(self.tilt), pose.position)
        ahead = rotate(conjugate(self.tilt), rotate(pose.orientation, (1.0, 0.0, 0.0)))
        return x, y, math.atan2(ahead[1], ahead[0])
