"""Forces that act for long on bodies without joints, which could sleep or creep meanwhile."""
from __future__ import annotations

import pytest
from conftest import Lab, box, inertial_of_box, link_of, slab
from laws import Laws

from my_simulations.description.model import Model
from my_simulations.description.shapes import Box, Surface
from my_simulations.engine.commands import FOREVER
from my_simulations.engine.timed_forces import AddTimedForces, ClearTimedForces, TimedWrench
from my_simulations.geometry import STILL

G = 9.8


def _push(lab: Lab, model: int, force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0),
          point=(0.0, 0.0, 0.0)) -> None:
    lab.apply(AddTimedForces((TimedWrench(model, lab.rows[model, "link"], lab.step, FOREVER,
                                          force, torque, point=point),)))


@pytest.mark.parametrize("acceleration", [0.01, 0.04])
def test_a_thruster_speeds_a_body_up_however_slowly(lab: Lab, laws: Laws, acceleration: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    probe = lab.load(box(mass=10.0))
    _push(lab, probe, (10.0 * acceleration, 0.0, 0.0))
    lab.seconds(10)
    laws.near("lasting force: way of a slow thruster in 10 s, m", lab.pose(probe).position[0],
              acceleration * 50, rel=2e-4)


def test_a_weak_force_moves_a_body_that_slept_on_ice(lab: Lab, laws: Laws):
    lab.load(slab("floor", (40, 40, 1)), (0, 0, -0.5))
    sled = lab.load(box(size=0.2, surface=Surface(mu=0.0)), (0, 0, 0.1))
    lab.seconds(4)
    _push(lab, sled, (0.02, 0.0, 0.0))
    lab.seconds(6)
    laws.near("lasting force: way of a sled in 6 s, m", lab.pose(sled).position[0], 0.36,
              rel=2e-3)


def test_what_happens_beside_a_pushed_body_does_not_let_it_sleep(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    probe = lab.load(box(mass=10.0))
    _push(lab, probe, (0.1, 0.0, 0.0))
    lab.seconds(1)
    lab.load(slab("wall", (1, 1, 1)), (-1.005, 0, 0))
    lab.seconds(9)
    assert lab.pose(probe).position[0] == pytest.approx(0.5, rel=1e-3)


def test_a_body_may_sleep_once_the_last_force_on_it_has_ended(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    probe = lab.load(box(mass=10.0))
    _push(lab, probe, (0.1, 0.0, 0.0))
    lab.seconds(4)
    row = lab.rows[probe, "link"]
    lab.apply(AddTimedForces((TimedWrench(77, row, lab.step, lab.step + 1000, (0.1, 0, 0)),)))
    lab.seconds(2)          # the second force has ended, the first goes on
    lab.apply(ClearTimedForces((probe,)))
    lab.seconds(1)          # slower than 0.1 m/s, but for less than 2 s
    assert lab.twist(probe).linear[0] == pytest.approx(0.07, rel=1e-3)
    lab.seconds(3)
    assert lab.twist(probe) == STILL


@pytest.mark.parametrize("size", [0.04, 0.2])
def test_what_friction_holds_against_a_force_stays(lab: Lab, laws: Laws, size: float):
    lab.load(slab("floor", (40, 40, 1)), (0, 0, -0.5))
    held = lab.load(box(size=size), (0, 0, size / 2))
    lab.seconds(1)
    start = lab.pose(held).position
    _push(lab, held, (0.6 * G, 0.0, 0.0))
    lab.seconds(30)
    laws.near("lasting force: creep of what friction holds in 30 s, m", lab.pose(held).position,
              start, abs=5e-5)


@pytest.mark.parametrize("force, torque, height", [
    ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.15), ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), -0.15),
    ((0.0, 0.0, 0.0), (0.0, 0.15, 0.0), 0.0), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.02), 0.0),
], ids=["at its top", "at its foot", "torque that tips", "torque that turns"])
@pytest.mark.parametrize("articulated", [False, True])
def test_what_friction_holds_against_a_torque_stays(lab: Lab, laws: Laws, force, torque,
                                                    height: float, articulated: bool):
    lab.load(slab("floor", (40, 40, 1)), (0, 0, -0.5))
    column = Model("column", links=[link_of(Box((0.1, 0.1, 0.3)),
                                            inertial_of_box(1.0, 0.1, 0.1, 0.3))])
    held = lab.load(column, (0, 0, 0.15), articulated=articulated)
    lab.seconds(1)
    start = lab.pose(held)
    _push(lab, held, force, torque, (0.0, 0.0, height))
    lab.seconds(4)
    laws.near("lasting torque: creep of what friction holds in 4 s, m", lab.pose(held).position,
              start.position, abs=1e-5)
    laws.near("lasting torque: how far it turns in 4 s", lab.pose(held).orientation,
              start.orientation, abs=1e-5)
