"""Small bodies that fly fast do not pass through what is thin."""
from __future__ import annotations

import pytest
from conftest import Lab, ball, inertial_of_box, link_of, slab
from laws import Laws

from my_simulations.description.model import Model
from my_simulations.description.shapes import Box, Surface

BOUNCES = 0.0   # the bounce threshold of a surface that always does


def _wall(lab: Lab) -> None:
    wall = slab("wall", (0.01, 3, 60))
    wall.links[0].collisions[0].surface = Surface(restitution=1.0, bounce_threshold=BOUNCES)
    lab.configure(gravity=(0.0, 0.0, 0.0))
    lab.load(wall)


@pytest.mark.parametrize("speed", [5.0, 10.0, 20.0, 30.0, 40.0])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_small_balls_bounce_off_a_thin_wall(lab: Lab, laws: Laws, e: float, speed: float):
    _wall(lab)
    surface = Surface(restitution=e, bounce_threshold=BOUNCES if e else 1e5)
    balls = [lab.load(ball(f"b{n}", radius=0.0025, mass=0.001, surface=surface),
                      (-0.5 - 0.0013 * n, 0, 2 * n - 20)) for n in range(16)]
    for number in balls:
        lab.push(number, (speed, 0, 0))
    lab.steps(round(1000 / speed) + 50)
    for number in balls:
        assert lab.pose(number).position[0] < 0.0
        laws.near("balls of 5 mm against a wall of 1 cm, to 40 m/s: bounce",
                  -lab.twist(number).linear[0] / speed, e, abs=0.02)


def test_a_thin_plate_does_not_pass_through_a_thin_wall(lab: Lab):
    _wall(lab)
    size = (0.004, 0.1, 0.1)
    plate = lab.load(Model("plate", links=[link_of(Box(size), inertial_of_box(0.1, *size))]),
                     (-0.5, 0, 0))
    lab.push(plate, (30, 0, 0))
    lab.steps(100)
    assert lab.pose(plate).position[0] < 0.0
