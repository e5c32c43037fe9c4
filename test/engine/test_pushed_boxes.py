"""Robots that push boxes over the floor: Coulomb's law leaves the push in the middle."""
from __future__ import annotations

import math
from typing import Tuple

import pytest
from conftest import Lab, ground, inertial_of_box, link_of
from laws import Laws
from mobile_bases import EFFORT, MobileBase, angle_between, differential

from my_simulations.description.model import Model
from my_simulations.description.shapes import Box, Surface
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.geometry import Pose, quat_from_rpy

FRONT = 0.07   # m, of the base before its origin
SIZE = 0.3     # m, of the box


def _load(lab: Lab, mass: float, mu: float, heading: float) -> Tuple[int, int, MobileBase]:
    """Load a base, and a box that touches its front."""
    lab.load(ground(1.0))
    base = differential(1.0)
    turn = quat_from_rpy(0.0, 0.0, heading)
    number = lab.load(base.model, (0, 0, 0), turn)
    ahead = FRONT + SIZE / 2 + 0.001
    c, s = math.cos(heading), math.sin(heading)
    box = lab.load(Model("box", links=[link_of(
        Box((SIZE, SIZE, SIZE)), inertial_of_box(mass, SIZE, SIZE, SIZE), Surface(mu=mu, mu2=mu))]),
        (ahead * c, ahead * s, SIZE / 2), turn)
    lab.seconds(0.5)
    return number, box, base


def _drive(lab: Lab, number: int, base: MobileBase, speed: float) -> None:
    lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[number, name], rate, EFFORT)
                              for name, rate in base.rates(speed, 0.0).items())))


def _heading(lab: Lab, number: int) -> float:
    x, y, z, w = lab.pose(number).orientation
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


@pytest.mark.parametrize("mass, mu, speed", [
    (0.1, 0.5, 0.2), (0.2, 0.5, 0.2), (0.3, 0.5, 0.2), (0.5, 0.3, 0.2), (0.2, 0.5, 0.05),
    (0.1, 0.5, 0.5)])
@pytest.mark.parametrize("step, bar", [(0.001, 0.2), (0.002, 0.2), (0.005, 0.5), (0.01, 1.0)])
@pytest.mark.parametrize("heading", [
    0.5, *(pytest.param(angle, marks=pytest.mark.long) for angle in (0.0, 2.0, -1.0))])
def test_a_base_that_pushes_a_box_keeps_its_heading(
        lab: Lab, laws: Laws, mass: float, mu: float, speed: float, step: float, bar: float,
        heading: float):
    lab.configure(step_size=step)
    number, box, base = _load(lab, mass, mu, heading)
    before = _heading(lab, number)
    _drive(lab, number, base, speed)
    lab.seconds(2.0)
    laws.near("a base pushes a box: heading lost in 2 s, degrees",
              angle_between(_heading(lab, number), before), 0.0, abs=bar)


def test_a_box_that_was_pushed_does_not_turn_where_it_is_put(lab: Lab):
    number, box, base = _load(lab, 0.3, 0.5, 0.5)
    _drive(lab, number, base, 0.2)
    lab.seconds(1.0)
    lab.push(box, at=Pose((100.0, 0.0, 10.0)))
    lab.steps(1)
    assert max(map(abs, lab.twist(box).angular)) < 1e-9
