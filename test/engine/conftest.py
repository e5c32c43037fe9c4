"""A PyBullet backend to test against, and short ways to build models."""
from __future__ import annotations

import os
from typing import Iterator, List, Optional, Tuple

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as in the engine's own process

import pytest
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Geometry, Plane, Sphere, Surface
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.engine.commands import (
    Command,
    LoadModel,
    ModelState,
    PhysicsSettings,
    RemoveModel,
    SetModelState,
)
from my_simulations.engine.ring_rows import axis_rows
from my_simulations.geometry import STILL, Pose, Twist


def inertial_of_box(mass: float, x: float, y: float, z: float, pose: Pose = Pose()) -> Inertial:
    return Inertial(mass, pose, mass * (y * y + z * z) / 12, 0, 0, mass * (x * x + z * z) / 12, 0,
                    mass * (x * x + y * y) / 12)


def link_of(geometry: Geometry, inertial: Inertial, surface: Optional[Surface] = None,
            name: str = "link", pose: Pose = Pose(), gravity: bool = True) -> Link:
    return Link(name, pose, inertial, [Collision("c", geometry, surface=surface or Surface())],
                gravity=gravity)


def box(name: str = "box", size: float = 1.0, mass: float = 1.0,
        surface: Optional[Surface] = None, gravity: bool = True) -> Model:
    return Model(name, links=[link_of(Box((size,) * 3), inertial_of_box(mass, size, size, size),
                                      surface, gravity=gravity)])


def ball(name: str = "ball", radius: float = 0.5, mass: float = 1.0,
         surface: Optional[Surface] = None) -> Model:
    moment = 0.4 * mass * radius * radius
    return Model(name, links=[link_of(Sphere(radius),
                                      Inertial(mass, Pose(), moment, 0, 0, moment, 0, moment),
                                      surface)])


def ground(mu: float = 100.0, surface: Optional[Surface] = None) -> Model:
    return Model("ground", static=True, links=[Link("link", collisions=[Collision("c", Plane(),
                                                           surface=surface or Surface(mu=mu))])])


def slab(name: str, size: Tuple[float, float, float]) -> Model:
    return Model(name, static=True, links=[link_of(Box(size), Inertial())])


def arm(kind: str, axis: JointAxis, mass: float = 1.0, length: float = 1.0,
        moment: float = 1e-3, gravity: bool = True) -> Model:
    """A point-like mass `length` along x from a joint to the world at the model origin."""
    inertial = Inertial(mass, Pose((length, 0, 0)), moment, 0, 0, moment, 0, moment)
    return Model("arm", links=[Link("bob", inertial=inertial, gravity=gravity)],
                 joints=[Joint("hinge", kind, "world", "bob", axis=axis)])


class Lab:
    """A backend with rows and ids handed out."""

    def __init__(self) -> None:
        self.backend = BulletBackend()
        self.settings = PhysicsSettings()
        self.step = 0
        self._id = self._links = self._joints = 0
        self.rows: dict = {}
        self.joint_rows: dict = {}

    def configure(self, **changes: object) -> None:
        self.settings = PhysicsSettings(**{**self.settings.__dict__, **changes})
        self.backend.configure(self.settings)

    def load(self, model: Model, position=(0, 0, 0), orientation=(0, 0, 0, 1),
             meshes=None, state: Optional[ModelState] = None, articulated: bool = False) -> int:
        self._id += 1
        self.backend.apply(LoadModel(self._id, model, Pose(tuple(position), tuple(orientation)),
                                     self._links, self._joints, meshes or {}, state,
                                     articulated=articulated))
        for n, link in enumerate(model.links):
            self.rows[self._id, link.name] = self._links + n
        for n, row in enumerate(axis_rows(model)):
            self.joint_rows[self._id, row.name] = self._joints + n
        self._links += len(model.links)
        self._joints += len(axis_rows(model))
        self.backend.read()
        return self._id

    def remove(self, model_id: int) -> None:
        self.backend.apply(RemoveModel(model_id))

    def apply(self, command: Command) -> object:
        return self.backend.apply(command)

    def push(self, model_id: int, linear=(0, 0, 0), angular=(0, 0, 0), at=None) -> None:
        pose = self.pose(model_id) if at is None else at
        self.apply(SetModelState(model_id, pose, Twist(tuple(linear), tuple(angular))))

    def steps(self, count: int) -> None:
        self.backend.step(self.step, count)
        self.step += count
        self.backend.read()

    def seconds(self, duration: float) -> None:
        """Advance, reading out every 10 ms of sim time as a running world does."""
        for _ in range(round(duration / self.settings.step_size / 10)):
            self.steps(10)

    def row(self, model_id: int, link: str = "link") -> List[float]:
        return self.backend._readout.links[self.rows[model_id, link]].tolist()

    def pose(self, model_id: int, link: str = "link") -> Pose:
        values = self.row(model_id, link)
        return Pose(tuple(values[:3]), tuple(values[3:7]))

    def twist(self, model_id: int, link: str = "link") -> Twist:
        values = self.row(model_id, link)
        return Twist(tuple(values[7:10]), tuple(values[10:]))

    def joint(self, model_id: int, name: str = "hinge") -> Tuple[float, float]:
        return tuple(self.backend._readout.joints[self.joint_rows[model_id, name]].tolist())


_LAWS = pytest.StashKey[Laws]()


def pytest_configure(config: pytest.Config) -> None:
    config.stash[_LAWS] = Laws()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    lines = terminalreporter.config.stash[_LAWS].report()
    if lines:
        terminalreporter.section("laws: the worst case of each")
        for line in lines:
            terminalreporter.write_line(line)


@pytest.fixture
def laws(request: pytest.FixtureRequest) -> Laws:
    """Where measurements are compared with laws and noted."""
    return request.config.stash[_LAWS]


@pytest.fixture
def lab() -> Iterator[Lab]:
    made = Lab()
    made.backend.read()
    yield made
    made.backend.close()


__all__ = ["STILL", "Lab", "arm", "ball", "box", "ground", "inertial_of_box", "link_of", "slab"]
