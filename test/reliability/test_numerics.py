"""Worlds that physics cannot bear: what fails is held and named, the rest goes on."""
from __future__ import annotations

import math
import random
from typing import Dict, List, Tuple

import pytest
from editor_case import box
from proofs import allowance, scaled

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Plane
from my_simulations.description.world import World
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.errors import CommandError
from my_simulations.geometry import Pose
from my_simulations.simulator.simulator import Simulator

GRAVITY = 9.8
MODELS, SECONDS = scaled(20, 1000), scaled(2, 60)
AT_ONCE = 20
"""Models in one world."""


def started(models: List[Model], issues: list) -> Simulator:
    ground = Model("ground", static=True,
                   links=[Link("link", collisions=[Collision("c", Plane())])])
    simulator = Simulator(World(models=[ground, *models], gravity=(0.0, 0.0, -GRAVITY)),
                          engine_factory=ProcessEngine, paused=True, log=issues.append)
    simulator.start()
    return simulator


def chain(name: str, chance: random.Random,
          where: Tuple[float, float]) -> Tuple[Model, List[float]]:
    """A random tree of boxes on hinges and sliders, and the masses of its links."""
    links, joints, masses = [], [], []
    poses = [(0.0, 0.0, 0.0)]
    for n in range(chance.randint(2, 6)):
        size, mass = chance.uniform(0.1, 0.4), chance.uniform(0.2, 5.0)
        moment = mass * size * size / 6.0
        masses.append(mass)
        parent = chance.randrange(n) if n else 0
        if n:
            poses.append(tuple(poses[parent][k] + chance.choice((-1, 0, 1)) * 0.5
                               for k in range(3)))
        links.append(Link(f"l{n}", Pose(poses[n]),
                          Inertial(mass, ixx=moment, iyy=moment, izz=moment),
                          [Collision("c", Box((size,) * 3))]))
        if n:
            axis = JointAxis(chance.choice(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))),
                             damping=chance.choice((0.0, 0.1, 5.0)))
            kind = chance.choice(("revolute", "revolute", "prismatic", "fixed", "ball"))
            joints.append(Joint(f"j{n}", kind, f"l{parent}", f"l{n}",
                                axis=None if kind in ("fixed", "ball") else axis))
    pose = Pose((*where, 3.0 + chance.random()))
    return Model(name, pose, links=links, joints=joints), masses


def energy(simulator: Simulator, model: Model, masses: List[float]) -> float:
    """Kinetic and potential, in J; the moments of the links are equal about all axes."""
    total = 0.0
    for link, mass in zip(model.links, masses):
        pose, twist = simulator.states.link_state(f"{model.name}::{link.name}")
        speed = sum(value * value for value in twist.linear)
        spin = sum(value * value for value in twist.angular)
        total += 0.5 * mass * speed + 0.5 * link.inertial.ixx * spin
        total += mass * GRAVITY * pose.position[2]
    return total


def test_no_energy_comes_from_nothing(record):
    chance, used = random.Random(2026), allowance()
    worst, count = -math.inf, 0
    while count < MODELS and used() < 1.0:
        made = [chain(f"m{n}", chance, (12.0 * (n % 5), 12.0 * (n // 5)))
                for n in range(min(AT_ONCE, MODELS - count))]
        count += len(made)
        issues: list = []
        simulator = started([model for model, _ in made], issues)
        try:
            begun = [energy(simulator, *each) for each in made]
            for _ in range(SECONDS * 10):
                simulator.clock.advance(100)
                for each, before in zip(made, begun):
                    worst = max(worst, energy(simulator, *each) / before)
        finally:
            simulator.close()
        assert [issue for issue in issues if issue.code == "state-diverged"] == []
    assert worst < 1.01
    record("no energy from nothing", models=count, sim_seconds=SECONDS,
           worst_gain_percent=round(100 * (worst - 1.0), 2))


@pytest.fixture
def world():
    """(simulator, issues): a box to be harmed, and one that must not notice."""
    issues: list = []
    simulator = started([box("harmed", (0.0, 0.0, 0.5)), box("other", (50.0, 0.0, 5.0))], issues)
    yield simulator, issues
    simulator.close()


@pytest.mark.parametrize("size", [1e155, 1e200, 1e300, 1e308])
def test_a_body_that_is_thrown_out_of_the_world_harms_no_other(world, size, record):
    simulator, issues = world
    pid = simulator.engine_pid
    simulator.wrenches.apply_wrench("harmed::link", (size, size, 0.0), (0.0, 0.0, size),
                                    duration_ns=10**9)
    simulator.clock.advance(1000)
    assert simulator.engine_pid == pid  # it did not end its engine
    for name in ("harmed", "other"):
        assert all(map(math.isfinite, simulator.states.model_state(name)[0].position))
    assert simulator.states.model_state("other")[0].position[2] == pytest.approx(0.5, abs=0.5)
    told = [issue.message for issue in issues if issue.code == "state-diverged"]
    assert len(told) <= 1 and all("'harmed'" in message for message in told)
    record(f"a wrench of {size:g} N", reports=len(told))


VALUES = (math.nan, math.inf, -math.inf)


def test_values_that_are_not_finite_are_refused_at_every_door(world):
    simulator, _ = world
    refused: Dict[str, int] = {}
    for value in VALUES:
        doors = {
            "spawn": lambda v=value: simulator.models.spawn(box("new", (v, 0.0, 0.0))),
            "state": lambda v=value: simulator.states.set_model_state(
                "other", Pose((v, 0.0, 0.0)), simulator.states.model_state("other")[1]),
            "wrench": lambda v=value: simulator.wrenches.apply_wrench(
                "other::link", (v, 0.0, 0.0), (0.0, 0.0, 0.0), duration_ns=10**9),
        }
        for door, enter in doors.items():
            try:
                enter()
            except CommandError:
                refused[door] = refused.get(door, 0) + 1
    assert refused == dict.fromkeys(doors, len(VALUES))
    simulator.clock.advance(10)
    assert all(map(math.isfinite, simulator.states.model_state("other")[0].position))
