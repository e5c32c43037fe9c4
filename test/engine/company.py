"""Bodies of every kind far from a law: together they need every helper of contacts all the time."""
from __future__ import annotations

import math
from typing import Callable, Dict, List, Set, Tuple

import numpy as np
from conftest import Lab, ball, box, inertial_of_box, link_of, slab

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import (
    Box,
    Collision,
    Cylinder,
    Heightmap,
    MeshData,
    Surface,
    mesh_key,
)
from my_simulations.engine.commands import Command, SetModelState
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.geometry import Pose, Twist, quat_from_rpy

Triple = Tuple[float, float, float]
FAR = (1500.0, 1500.0, 50.0)   # m, the middle of the top of the company's floor
AGAIN = 0.5                    # s, after which moving pieces start again
DRIVE_HZ = 50.0                # of the commands of the company's robot
LYING = quat_from_rpy(math.pi / 2, 0, 0)


def _can(name: str, radius: float, height: float, mu: float) -> Model:
    across = (3 * radius * radius + height * height) / 12
    return Model(name, allow_auto_disable=False, links=[link_of(
        Cylinder(radius, height), Inertial(1.0, ixx=across, iyy=across, izz=radius * radius / 2),
        Surface(mu=mu))])


def _robot() -> Model:
    """Four wheels, the left ones of which turn backwards, and an arm with a damper."""
    links = [Link("link", inertial=inertial_of_box(5, 0.3, 0.2, 0.05))]
    joints: List[Joint] = []
    for n, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        links.append(Link(f"w{n}", Pose((0.1 * x, 0.12 * y, 0), quat_from_rpy(-math.pi / 2, 0, 0)),
                          Inertial(0.3, ixx=3e-4, iyy=3e-4, izz=4e-4),
                          [Collision("c", Cylinder(0.05, 0.03), surface=Surface(mu=0.8))]))
        joints.append(Joint(f"j{n}", "revolute", "link", f"w{n}", axis=JointAxis((0, 0, 1))))
    links.append(Link("arm", Pose((0, 0, 0.05)), inertial_of_box(0.3, 0.02, 0.02, 0.2,
                                                                Pose((0, 0, 0.1)))))
    joints.append(Joint("shoulder", "revolute", "link", "arm",
                        axis=JointAxis((0, 1, 0), damping=0.1)))
    return Model("robot", links=links, joints=joints)


def _terrain() -> Tuple[Model, Dict[str, MeshData]]:
    """A level height map of 6 x 2 m."""
    x, y = np.meshgrid(0.5 * np.arange(13), 0.5 * np.arange(5))
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    at = (np.arange(4)[:, None] * 13 + np.arange(12)).ravel()
    faces = np.concatenate([np.stack([at, at + 1, at + 13], 1),
                            np.stack([at + 1, at + 14, at + 13], 1)]).astype(np.int32)
    shape = Heightmap("company_terrain", "/company_terrain")
    return (Model("company_terrain", static=True, links=[Link("link", collisions=[
        Collision("c", shape, surface=Surface(mu=1.0))])]),
        {mesh_key(shape): MeshData(points, faces)})


class Company:
    """The bodies, and what users do with them.

    Attributes:
        rows: of their links.

    Args:
        load: puts a model into the world; its arguments are those of `Lab.load`.
        apply: applies a command.
        lab: whose rows the loaded models get.
    """

    def __init__(self, load: Callable[..., int], apply: Callable[[Command], object],
                 lab: Lab) -> None:
        self._load, self._apply, self._lab = load, apply, lab
        self.rows: Set[int] = set()
        self._started: List[SetModelState] = []
        self._period = AGAIN
        self._next = self._next_drive = 0.0
        floor = slab("company_floor", (30.0, 30.0, 0.2))
        floor.links[0].collisions[0].surface = Surface(mu=1.0, restitution=1.0,
                                                       bounce_threshold=0.0)
        self._put(floor, (0, 0, -0.1))
        terrain, meshes = _terrain()
        self._put(terrain, (0, 5, 0.2), meshes=meshes)
        for n in range(3):   # a settled stack that may sleep, and a box that may not
            self._put(box(f"stacked{n}", 0.2), (-8, 0, 0.1 + 0.2 * n))
        awake = box("awake", 0.3, surface=Surface(mu=0.5))
        awake.allow_auto_disable = False
        self._put(awake, (-8, 3, 0.15))
        self._put(ball("soft", 0.2, surface=Surface(kp=1e4, kd=10.0)), (-6, 0, 0.2))
        self._put(Model("syrup", allow_auto_disable=False, links=[link_of(
            Box((0.4, 0.4, 0.1)), inertial_of_box(2.0, 0.4, 0.4, 0.1),
            Surface(slip1=0.1, slip2=0.1))]), (-4, 0, 0.05), linear=(0.5, 0, 0))
        # As the laws have it: PyBullet cannot store moving surfaces that bounce unlike each other.
        self._put(ball("elastic", 0.1, surface=Surface(restitution=0.8, bounce_threshold=0.0)),
                  (-2, 0, 1.0), linear=(0, 0, -1))
        self._put(_can("slider", 0.1, 0.1, 0.1), (0, 0, 0.05), linear=(1.0, 0, 0))
        self._put(_can("edge", 0.1, 0.2, 0.5), (0, 2, 0.18), quat_from_rpy(0.6, 0, 0),
                  angular=(0, 0, 3.0))
        self._put(_can("lander", 0.05, 0.2, 0.5), (0, -2, 0.8), linear=(0, 0, -2))
        self._put(_can("roller", 0.1, 0.3, 1.0), (2, 0, 0.1), LYING, (0.5, 0, 0), (0, 5, 0))
        self._put(_can("wheel", 0.1, 0.3, 1.0), (0.5, 6, 0.3), LYING, (0.5, 0, 0), (0, 5, 0))
        self._put(box("tumbler", 0.2), (4, 4, 2.0), linear=(0, 0, 2.0), angular=(2, 3, 1))
        robot = self._put(_robot(), (6, 0, 0.05))
        self._wheels = [row for (number, _), row in lab.joint_rows.items() if number == robot][:4]

    def _put(self, model: Model, at: Triple, turn=(0, 0, 0, 1), linear: Triple = (0, 0, 0),
             angular: Triple = (0, 0, 0), meshes=None) -> int:
        place = tuple(a + b for a, b in zip(at, FAR))
        number = self._load(model, place, turn, meshes)
        self.rows |= {self._lab.rows[number, link.name] for link in model.links}
        if linear != (0, 0, 0):
            self._started.append(SetModelState(number, Pose(place, turn), Twist(linear, angular)))
        return number

    def act(self, time: float) -> None:
        """Start again what has stopped, and drive, before the step at `time` s."""
        if time >= self._next - 1e-9:
            self._next += AGAIN
            for command in self._started:
                self._apply(command)
        if time >= self._next_drive - 1e-9:
            self._next_drive += 1 / DRIVE_HZ
            change = 1e-3 * math.sin(37.0 * time)
            self._apply(SetMotors(tuple(JointMotor(row, (-2.0, 2.0)[n % 2] + change, 5.0)
                                        for n, row in enumerate(self._wheels))))



