"""Boxes on a level floor that a constant force pushes, and how far they slide."""
from __future__ import annotations

import math
from typing import List, NamedTuple, Sequence

from conftest import Lab, inertial_of_box, link_of, slab

from my_simulations.description.model import Model
from my_simulations.description.shapes import Box, Surface
from my_simulations.engine.commands import FOREVER
from my_simulations.engine.timed_forces import AddTimedForces, TimedWrench

G = 9.8
SECONDS = 1.0


class PushedBox(NamedTuple):
    """A box of 1 kg. `push`: of mu N; `angle`: of the push about z, rad."""

    size: float
    height: float
    mu: float
    push: float
    angle: float = 0.0

    def way(self) -> float:
        """How far it slides in `SECONDS` by Coulomb's law, m."""
        return max(0.0, self.push - 1.0) * self.mu * G * SECONDS ** 2 / 2


def ways(boxes: Sequence[PushedBox], step_size: float = 0.001) -> List[float]:
    """How far each box slides, all in one world, m."""
    lab = Lab()
    try:
        lab.configure(step_size=step_size)
        lab.load(slab("floor", (600.0, 600.0, 2.0)), (0, 0, -1.0))
        loaded = [lab.load(Model(f"box{n}", allow_auto_disable=False, links=[link_of(
            Box((box.size, box.size, box.height)),
            inertial_of_box(1.0, box.size, box.size, box.height), Surface(mu=box.mu))]),
            (0, 15 * n - 200, box.height / 2)) for n, box in enumerate(boxes)]
        lab.steps(200)
        starts = [lab.pose(number).position for number in loaded]
        lab.apply(AddTimedForces(tuple(TimedWrench(
            number, lab.rows[number, "link"], lab.step, FOREVER,
            (box.push * box.mu * G * math.cos(box.angle),
             box.push * box.mu * G * math.sin(box.angle), 0.0))
            for number, box in zip(loaded, boxes))))
        lab.seconds(SECONDS)
        return [math.dist(lab.pose(number).position[:2], start[:2])
                for number, start in zip(loaded, starts)]
    finally:
        lab.backend.close()
