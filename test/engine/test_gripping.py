"""Two fingers hold a box by friction."""
from __future__ import annotations

import math

import pytest
from conftest import Lab, inertial_of_box, link_of
from laws import Laws

from my_simulations.description.model import Joint, JointAxis, Model
from my_simulations.description.shapes import Box, Surface
from my_simulations.engine.commands import FOREVER
from my_simulations.engine.timed_forces import AddTimedForces, TimedEffort
from my_simulations.geometry import Pose

SECONDS = [10, pytest.param(60, marks=pytest.mark.long)]
MU = 1.0


def _gripper(mass: float) -> Model:
    """Two fingers on rails that hang from the world."""
    finger = inertial_of_box(0.1, 0.02, 0.04, 0.08)
    links = [link_of(Box((0.02, 0.04, 0.08)), finger, Surface(mu=MU), name,
                     Pose((side * (0.025 + 0.01), 0, 0)))
             for name, side in (("left", -1.0), ("right", 1.0))]
    return Model("gripper", links=links, joints=[
        Joint(f"{link.name}_rail", "prismatic", "world", link.name, axis=JointAxis((1, 0, 0)))
        for link in links])


@pytest.mark.parametrize("seconds", SECONDS)
@pytest.mark.parametrize("grip", [5.0, 10.0, 30.0])
def test_a_grip_holds(lab: Lab, laws: Laws, grip: float, seconds: int) -> None:
    # Half of what friction can carry.
    mass = 0.5 * 2 * MU * grip / 9.8
    gripper = lab.load(_gripper(mass), (0, 0, 1))
    lab.apply(AddTimedForces(tuple(
        TimedEffort(n + 1, lab.joint_rows[gripper, f"{side}_rail"], 0, FOREVER, sign * grip)
        for n, (side, sign) in enumerate((("left", 1.0), ("right", -1.0))))))
    held = lab.load(Model("held", links=[link_of(
        Box((0.05,) * 3), inertial_of_box(mass, 0.05, 0.05, 0.05), Surface(mu=MU))]), (0, 0, 1))
    lab.seconds(1.0)
    start, side = lab.pose(held).position, lab.pose(gripper, "left").position
    lab.seconds(seconds)
    now, hand = lab.pose(held).position, lab.pose(gripper, "left").position
    laws.at_most(f"a grip of 5 to 30 N for {seconds} s: how far it slips, mm",
                 1e3 * math.dist([a - b for a, b in zip(now, hand)],
                                 [a - b for a, b in zip(start, side)]), 1.0)
