"""Bases on two wide wheels turn as Coulomb's law says for wheels that load a line."""
from __future__ import annotations

import math
from typing import Callable

import numpy as np
import pytest
from conftest import Lab, ground
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Collision, Cylinder, Sphere, Surface
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.geometry import Pose, quat_from_rpy

RADIUS = 0.05
LAW = "a base turns in place on wheels 2 to 10 cm wide: share of Coulomb's rate"
BAR = 0.07   # slip below 1.5 mu g dt meets less friction, so bases turn up to 6 % faster


def _base(width: float, aside: float, casters: bool = True, mu: float = 1.0) -> Model:
    """Two wheels and two balls without friction, or no casters and a low centre of mass."""
    links = [Link("link", Pose((0.0, 0.0, RADIUS)), Inertial(
        3.0, Pose((0.0, 0.0, 0.0 if casters else -0.02)), ixx=0.02, iyy=0.02, izz=0.03))]
    if casters:
        links[0].collisions = [Collision(f"c{x}", Sphere(0.02), Pose((x, 0.0, 0.02 - RADIUS)),
                                         surface=Surface(mu=0.0, mu2=0.0)) for x in (0.12, -0.12)]
    joints = []
    for side, y in (("left", aside), ("right", -aside)):
        links.append(Link(side, Pose((0.0, y, RADIUS), quat_from_rpy(-math.pi / 2, 0.0, 0.0)),
                          Inertial(0.5, ixx=5e-4, iyy=5e-4, izz=6e-4),
                          [Collision("c", Cylinder(RADIUS, width), surface=Surface(mu=mu))]))
        joints.append(Joint(f"{side}_joint", "revolute", "link", side,
                            axis=JointAxis((0.0, 0.0, 1.0))))
    return Model("base", links=links, joints=joints)


def _share_by_coulomb(width: float, aside: float) -> float:
    """Return the rate of turn, as a share of v / b, at which the friction has no moment.

    A wheel loads a line evenly. Each piece of it has mu N against its slip.
    """
    places = aside + width * ((np.arange(20000) + 0.5) / 20000 - 0.5)
    slow, fast = 0.5, 1.5
    for _ in range(50):
        share = (slow + fast) / 2.0
        drives = float((places * np.sign(aside - share * places)).sum())
        slow, fast = (share, fast) if drives > 0.0 else (slow, share)
    return share


def _drive(lab: Lab, base: int, aside: float, rate: float) -> None:
    lab.apply(SetMotors(tuple(
        JointMotor(lab.joint_rows[base, f"{side}_joint"], sign * rate * aside / RADIUS, 5.0)
        for side, sign in (("left", -1.0), ("right", 1.0)))))


def _mean_turn(lab: Lab, base: int, seconds: float, each: Callable[[int], None] = lambda _: None,
               ) -> float:
    angle, size = 0.0, lab.settings.step_size
    count = round(seconds / size)
    for step in range(count):
        each(step)
        lab.steps(1)
        angle += size * lab.twist(base).angular[2]
    return angle / seconds


def test_the_sum_over_a_line_has_its_closed_form():
    assert _share_by_coulomb(0.05, 0.07) == pytest.approx(0.07 / math.hypot(0.07, 0.025), rel=1e-4)


@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005])
@pytest.mark.parametrize("rate", [0.2, 1.0, 3.0])
@pytest.mark.parametrize("width, aside", [(0.02, 0.0675), (0.025, 0.0675), (0.04, 0.1),
                                          (0.06, 0.1), (0.1, 0.15)])
def test_a_base_on_two_wide_wheels_turns_in_place(lab: Lab, laws: Laws, width: float,
                                                  aside: float, rate: float, step_size: float):
    lab.configure(step_size=step_size)
    lab.load(ground(1.0))
    base = lab.load(_base(width, aside))
    lab.seconds(0.5)
    _drive(lab, base, aside, rate)
    lab.seconds(0.5)
    laws.near(LAW, _mean_turn(lab, base, 1.0) / rate, _share_by_coulomb(width, aside), rel=BAR)


@pytest.mark.parametrize("mu", [0.3, 1.0])
@pytest.mark.parametrize("casters", [True, False])
@pytest.mark.parametrize("hertz", [20, 100])
def test_a_base_on_two_wide_wheels_turns_under_renewed_commands(
        lab: Lab, laws: Laws, hertz: int, casters: bool, mu: float):
    # Another robot stands and turns beside it.
    width, aside, rate = 0.05, 0.08, 1.0
    lab.load(ground(1.0))
    base = lab.load(_base(width, aside, casters, mu))
    other = lab.load(_base(0.1, 0.15), (1.0, 0.0, 0.0))
    lab.seconds(0.5)
    _drive(lab, other, 0.15, -0.5)
    every = round(1.0 / hertz / lab.settings.step_size)

    def renew(step: int) -> None:
        if step % every == 0:
            _drive(lab, base, aside, rate * (1.0 + 1e-3 * (step // every % 2)))
    _mean_turn(lab, base, 0.5, renew)
    laws.near(LAW, _mean_turn(lab, base, 1.0, renew) / rate, _share_by_coulomb(width, aside),
              rel=BAR)


def test_a_base_on_two_wide_wheels_turns_under_a_command_that_grows_slowly(lab: Lab, laws: Laws):
    # No wheel slides as the command grows, so only its slip later shows that it turns.
    width, aside, rate = 0.05, 0.08, 1.0
    lab.load(ground(1.0))
    base = lab.load(_base(width, aside))
    lab.seconds(0.5)
    _mean_turn(lab, base, 1.0, lambda step: _drive(lab, base, aside, rate * step * 1e-3))
    _drive(lab, base, aside, rate)
    lab.seconds(0.5)
    laws.near(LAW, _mean_turn(lab, base, 1.0) / rate, _share_by_coulomb(width, aside), rel=BAR)


@pytest.mark.parametrize("turn", [0.05, 0.3, 1.0])
def test_a_base_on_two_wide_wheels_follows_arcs(lab: Lab, laws: Laws, turn: float):
    width, aside, speed = 0.05, 0.08, 0.3
    lab.load(ground(1.0))
    base = lab.load(_base(width, aside))
    lab.seconds(0.5)
    lab.apply(SetMotors(tuple(
        JointMotor(lab.joint_rows[base, f"{side}_joint"], (speed + sign * turn * aside) / RADIUS,
                   5.0) for side, sign in (("left", -1.0), ("right", 1.0)))))
    lab.seconds(0.5)
    laws.near("a base on two wheels 5 cm wide drives arcs: share of the commanded turn",
              _mean_turn(lab, base, 1.0) / turn, 1.0, rel=0.07)
    laws.near("the same: speed, m/s", math.hypot(*lab.twist(base).linear[:2]), speed, rel=0.02)
