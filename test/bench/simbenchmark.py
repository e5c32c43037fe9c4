#!/usr/bin/env python3
"""Runs five scenes of SimBenchmark with this engine, and prints its errors beside published ones.

usage: simbenchmark.py [--energy ROBOT.urdf] [--momentum ROBOT.urdf]

The scenes are those of SimBenchmark (Legged Robotics Lab, ETH Zurich), written again from its
description; the published errors are those of its data files for steps of 1 ms, without error
reduction, with the best solver of each engine. Errors are means of squares over all steps: of
velocities against the closed form ((m/s)^2), of energy (J^2), of overlaps (m^2), of momentum
((kg m/s)^2). The scenes with ANYmal need that project's two files `robot.urdf` (for Bullet) of its
energy and momentum benchmarks.
"""
from __future__ import annotations

import argparse
import contextlib
import random
import sys
import time
from pathlib import Path
from typing import Callable, Dict, Iterator, List, Optional, Sequence, Tuple

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "engine")]
import numpy as np
from conftest import Lab, ball, ground, inertial_of_box, link_of

from my_simulations.description.model import Inertial, Model
from my_simulations.description.shapes import Box, Surface
from my_simulations.engine.commands import SetJoints
from my_simulations.engine.timed_forces import FOREVER, AddTimedForces, TimedWrench
from my_simulations.formats.reading import read_file
from my_simulations.geometry import compose, multiply, rotate, twist_at
from my_simulations.resources.resolver import Resolver

DT, G = 0.001, 9.81
ENGINES = ("Bullet", "ODE", "DART", "MuJoCo", "RaiSim")
PUBLISHED: Dict[str, Tuple[Optional[float], ...]] = {
    "rolling, pushed diagonally": (3.9e-27, 3.1, 3.1, 2.0e-3, 4.1e-7),
    "bouncing, restitution 1": (7.5e4, 1.9e2, 7.2e4, None, 1.9e-2),
    "666 balls": (3.8e-1, 1.5e-4, 2.8e-4, 9.5e-2, 1.4e-4),
    "ANYmal, energy": (3.7, 3.9, 2.4e2, 1.6e-17, 1.2e-2),
    "ANYmal, momentum": (2.7e-4, 1.3e-27, 1.6e2, 3.0e-13, 4.7e-5),
}
"""By scene, in the order of `ENGINES`; None: the engine has no restitution."""

POSTURE = {"LF": (0.03, 0.4, -0.8), "RF": (-0.03, 0.4, -0.8),
           "LH": (0.03, -0.4, 0.8), "RH": (-0.03, -0.4, 0.8)}
"""Positions (rad) of HAA, HFE and KFE of each leg."""


@contextlib.contextmanager
def _world(gravity: float = G) -> Iterator[Lab]:
    """A world of its own: PyBullet has one for each process, which must be closed."""
    lab = Lab()
    try:
        lab.configure(step_size=DT, gravity=(0.0, 0.0, -gravity))
        yield lab
    finally:
        lab.backend.close()


def _states(lab: Lab, models: Sequence[int], link: str = "link") -> np.ndarray:
    rows = [lab.rows[model, link] for model in models]
    table: np.ndarray = lab.backend._readout.links[rows]
    return table


def _push(lab: Lab, row: int, force: Tuple[float, float, float], stop: int = FOREVER) -> None:
    lab.apply(AddTimedForces((TimedWrench(1, row, lab.step, stop, force=force),)))


def _steps(lab: Lab, seconds: float) -> Iterator[float]:
    """Yield the time before each step."""
    for n in range(round(seconds / DT)):
        yield n * DT
        lab.steps(1)


def rolling(lab: Lab) -> float:
    """25 balls on a box that is pushed by 150 N at 60 degrees to x."""
    direction = np.array([0.5, 0.75 ** 0.5, 0.0])
    lab.load(ground(0.4))
    moments = inertial_of_box(10.0, 20.0, 20.0, 1.0)
    box = lab.load(Model("box", links=[link_of(Box((20.0, 20.0, 1.0)), moments,
                                               Surface(mu=0.8))]), (0, 0, 0.5))
    balls = [lab.load(ball(f"b{i}{j}", 0.5, 1.0, Surface(mu=0.8)), (2 * i - 4, 2 * j - 4, 1.5))
             for i in range(5) for j in range(5)]
    _push(lab, lab.rows[box, "link"], tuple((150.0 * direction).tolist()))
    ground_force = 0.4 * 35.0 * G
    ball_force = (150.0 - ground_force) / 10.0 / (3.5 + 2.5)
    rates = np.array([(150.0 - ground_force - 25 * ball_force) / 10.0, ball_force])
    errors = []
    for now in _steps(lab, 4.0):
        found = _states(lab, [box, balls[0]])[:, 7:10]
        errors.append(float(((found - rates[:, None] * now * direction) ** 2).sum()))
    return float(np.mean(errors))


def bouncing(lab: Lab) -> float:
    """49 balls of 10 kg that fall from 5 m and bounce for 20 s."""
    elastic = Surface(mu=0.0, restitution=1.0, bounce_threshold=0.0)
    lab.load(ground(surface=elastic))
    balls = [lab.load(ball(f"b{i}-{j}", 0.1, 10.0, elastic), (2 * i - 10, 2 * j - 10, 5.0))
             for i in range(7) for j in range(7)]
    start, errors = 10.0 * 49 * G * 5.0, []
    for _ in _steps(lab, 20.0):
        rows = _states(lab, balls)
        energy = 10.0 * (G * rows[:, 2] + 0.5 * (rows[:, 7:10] ** 2).sum(axis=1)).sum()
        errors.append((energy - start) ** 2)
    return float(np.mean(errors))


def many_balls(lab: Lab) -> float:
    """A cube of 6 x 6 x 6 balls of 10 kg without friction that falls and spreads, 10 s."""
    draw = random.Random(42)
    lab.load(ground(0.0))
    balls = [lab.load(ball(f"b{n}", 0.1, 10.0, Surface(mu=0.0)), (
        0.21 * (n // 36) + 0.001 * draw.random() - 0.6, 0.21 * (n // 6 % 6) + 0.001 * draw.random(),
        0.21 * (n % 6) + 0.001 * draw.random() + 0.101)) for n in range(216)]
    first, second = np.triu_indices(216, 1)
    errors = []
    for _ in _steps(lab, 10.0):
        at = _states(lab, balls)[:, :3]
        apart = np.sqrt(((at[first] - at[second]) ** 2).sum(axis=1))
        errors.append(float((np.clip(0.2 - apart, 0.0, None) ** 2).sum()
                            + (np.clip(0.1 - at[:, 2], 0.0, None) ** 2).sum()))
    return float(np.mean(errors))


class _Robot:
    """ANYmal in its posture, 2 m above the ground."""

    def __init__(self, lab: Lab, file: str) -> None:
        found, _ = read_file(file, Resolver())
        assert isinstance(found, Model)
        self._lab, self._model = lab, found
        self._id = lab.load(found, (0, 0, 2.0))
        lab.apply(SetJoints(tuple(
            (lab.joint_rows[self._id, f"{leg}_{joint}"], angle, 0.0)
            for leg, angles in POSTURE.items()
            for joint, angle in zip(("HAA", "HFE", "KFE"), angles))))
        lab.backend.read()

    @property
    def mass(self) -> float:
        return sum(link.inertial.mass for link in self._model.links)

    @property
    def base(self) -> int:
        return self._lab.rows[self._id, self._model.links[0].name]

    def sums(self) -> Tuple[float, np.ndarray]:
        """Kinetic plus potential energy (J), and momentum (kg m/s)."""
        energy, momentum = 0.0, np.zeros(3)
        for link in self._model.links:
            inertial: Inertial = link.inertial
            pose, twist = self._lab.pose(self._id, link.name), self._lab.twist(self._id, link.name)
            centre = compose(pose, inertial.pose)
            moving = twist_at(twist, rotate(pose.orientation, inertial.pose.position))
            turn = np.array([rotate(multiply(pose.orientation, inertial.pose.orientation), axis)
                             for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]).T
            tensor = turn @ _tensor(inertial) @ turn.T
            linear, angular = np.array(moving.linear), np.array(moving.angular)
            momentum += inertial.mass * linear
            energy += (0.5 * inertial.mass * linear @ linear + 0.5 * angular @ tensor @ angular
                       + inertial.mass * G * centre.position[2])
        return energy, momentum


def _tensor(inertial: Inertial) -> np.ndarray:
    i = inertial
    return np.array([[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]])


def energy(lab: Lab, file: str) -> float:
    """ANYmal, lifted for 1 s by twice its weight, then in free flight for 2 s."""
    lab.load(ground())
    robot = _Robot(lab, file)
    _push(lab, robot.base, (0.0, 0.0, 2 * G * robot.mass), round(1.0 / DT))
    for _ in _steps(lab, 1.0):
        pass
    start, _ = robot.sums()
    return float(np.mean([(robot.sums()[0] - start) ** 2 for _ in _steps(lab, 2.0)]))


def momentum(lab: Lab, file: str) -> float:
    """A ball of 10 kg and 5 m/s that hits ANYmal without gravity, 10 s."""
    thrown = lab.load(ball("ball", 0.2, 10.0, Surface(mu=0.0)), (0, -5.0, 2.0))
    robot = _Robot(lab, file)
    lab.push(thrown, (0.0, 5.0, 0.0))
    lab.backend.read()
    start = np.array([0.0, 50.0, 0.0])
    return float(np.mean([
        ((10.0 * _states(lab, [thrown])[0, 7:10] + robot.sums()[1] - start) ** 2).sum()
        for _ in _steps(lab, 10.0)]))


def main(words: List[str]) -> int:
    """Print a Markdown table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--energy", help="ANYmal's file of the energy benchmark")
    parser.add_argument("--momentum", help="ANYmal's file of the momentum benchmark")
    options = parser.parse_args(words)
    scenes: List[Tuple[str, Callable[[Lab], float]]] = [
        ("rolling, pushed diagonally", rolling), ("bouncing, restitution 1", bouncing),
        ("666 balls", many_balls)]
    if options.energy:
        scenes.append(("ANYmal, energy", lambda lab: energy(lab, options.energy)))
    if options.momentum:
        scenes.append(("ANYmal, momentum", lambda lab: momentum(lab, options.momentum)))
    print("| scene | my_simulations | " + " | ".join(ENGINES) + " |")
    print("|---|" + "---|" * (1 + len(ENGINES)))
    for name, run in scenes:
        began = time.process_time()
        with _world(0.0 if name == "ANYmal, momentum" else G) as lab:
            error = run(lab)
        cells = ["-" if value is None else f"{value:.2g}" for value in (error, *PUBLISHED[name])]
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
        print(f"{name}: {time.process_time() - began:.1f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
