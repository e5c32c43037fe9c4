"""Joint axes driven by PID loops."""
from __future__ import annotations

import pytest
from closed_forms import oscillator
from conftest import Lab, arm

from my_simulations.description.model import JointAxis
from my_simulations.engine.commands import FOREVER, Restart
from my_simulations.engine.timed_forces import (
    AddTimedForces,
    ClearTimedForces,
    JointPid,
    TimedEffort,
)
from my_simulations.geometry import Pose

UP = JointAxis((0, 0, 1))


def _drive(lab: Lab, model: int, servo: JointPid, number: int = 1) -> None:
    lab.apply(
        AddTimedForces(
            (
                TimedEffort(
                    number, lab.joint_rows[model, "hinge"], lab.step, FOREVER, effort=0.0, pid=servo
                ),
            )
        )
    )


@pytest.mark.parametrize("p, d", [(4.0, 0.4), (100.0, 20.0), (400.0, 8.0)])
def test_a_position_loop_swings_in_as_its_gains_say(lab, laws, p, d):
    model = lab.load(arm("revolute", UP, mass=1.0, length=1.0, moment=1e-9))
    _drive(lab, model, JointPid(0.5, p=p, i=0.0, d=d))
    off = 0.0
    for n in range(1, 201):
        lab.steps(10)
        off = max(off, abs(lab.joint(model)[0] - oscillator(0.01 * n, 1.0, p, d, p * 0.5)[0]))
    laws.at_most("position loops: off the closed form, rad", off, 0.02)


def test_a_velocity_loop_reaches_its_rate_and_keeps_it(lab):
    model = lab.load(arm("revolute", UP))
    _drive(lab, model, JointPid(-3.0, rate=True, p=5.0, i=0.0))
    lab.seconds(5.0)
    assert lab.joint(model)[1] == pytest.approx(-3.0, abs=0.01)


def test_the_integral_carries_the_weight_of_an_arm(lab):
    model = lab.load(arm("revolute", JointAxis((0, 1, 0)), mass=2.0))
    _drive(lab, model, JointPid(0.3, p=200.0, i=200.0, d=40.0))
    lab.seconds(15.0)
    assert lab.joint(model)[0] == pytest.approx(0.3, abs=1e-3)


def test_a_loop_drives_no_harder_than_the_axis_may_be_driven(lab):
    strong = lab.load(arm("revolute", UP))
    weak = lab.load(arm("revolute", JointAxis((0, 0, 1), effort=0.5)), (5, 0, 0))
    for number, model in enumerate((strong, weak), 1):
        _drive(lab, model, JointPid(9.0, p=100.0, i=0.0, d=0.0), number)
    lab.steps(100)   # w = M t / I
    assert lab.joint(weak)[1] == pytest.approx(0.5 * 0.1 / 1.001, rel=0.01)
    assert lab.joint(strong)[1] > 10 * lab.joint(weak)[1]


def test_a_loop_ends_when_it_is_cleared_or_the_world_begins_anew(lab):
    model = lab.load(arm("revolute", UP))
    for end in (lambda: lab.apply(ClearTimedForces((1,))),
                lambda: lab.apply(Restart(((model, Pose()),)))):
        _drive(lab, model, JointPid(5.0, rate=True))
        lab.steps(100)
        end()
        lab.steps(1)
        rate = lab.joint(model)[1]
        lab.steps(100)
        assert lab.joint(model)[1] == pytest.approx(rate, abs=1e-9)
