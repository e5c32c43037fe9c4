"""States that are set from outside: joints whose position is more than one number in Bullet."""
from __future__ import annotations

import math

import pybullet
import pytest
from conftest import STILL

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.engine.commands import FOREVER, LinkState, ModelState, SetJoints, SetModelState
from my_simulations.engine.timed_forces import AddTimedForces, TimedWrench
from my_simulations.geometry import Pose

PITCH = 10.0


def mass(at=(0, 0, 0), kg=1.0):
    return Inertial(kg, Pose(at), 0.01, 0, 0, 0.01, 0, 0.01)


SCREW = Model("m", links=[Link("bob", inertial=mass())], joints=[
    Joint("hinge", "screw", "world", "bob", axis=JointAxis(), thread_pitch=PITCH)])
SWING = Model("m", links=[Link("base", inertial=mass(kg=5.0)),
                          Link("bob", inertial=mass((0, 0, -1)))],
              joints=[Joint("socket", "ball", "base", "bob")])


@pytest.fixture
def weightless(lab):
    lab.configure(gravity=(0, 0, 0))
    return lab


def height(lab, model):
    return lab.pose(model, "bob").position[2]


@pytest.mark.parametrize("position, rate", [(1.0, 0.0), (-2.0, 0.0), (0.5, 10.0)])
def test_a_screw_is_set_with_its_slide(weightless, position, rate):
    lab, model = weightless, weightless.load(SCREW)
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], position, rate),)))
    for after in (0, 200):
        lab.steps(after)
        turned = position + rate * after * 1e-3
        assert lab.joint(model) == pytest.approx((turned, rate), abs=1e-6)
        assert height(lab, model) == pytest.approx(-turned / PITCH, abs=1e-6)


def test_a_screw_that_begins_turned_goes_on(weightless):
    lab, model = weightless, weightless.load(SCREW)
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.0, 10.0),)))
    lab.steps(1000)
    state = ModelState((LinkState(lab.pose(model, "bob"), lab.twist(model, "bob")),),
                       (lab.joint(model),))
    again = lab.load(SCREW, state=state)
    lab.steps(300)
    assert lab.joint(again) == pytest.approx(lab.joint(model), abs=1e-6)
    assert height(lab, again) == pytest.approx(height(lab, model), abs=1e-6)


def test_a_screw_stops_where_it_is(weightless):
    lab, model = weightless, weightless.load(SCREW)
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 5.0, 10.0),)))
    lab.apply(SetModelState(model, lab.pose(model, "bob"), STILL))
    lab.steps(100)
    assert lab.joint(model) == pytest.approx((5.0, 0.0), abs=1e-6)


def test_a_model_that_is_stopped_swings_on_no_ball_joint(weightless):
    lab = weightless
    states = (LinkState(Pose()), LinkState(Pose(orientation=(math.sin(0.4), 0, 0, math.cos(0.4)))))
    model = lab.load(SWING, state=ModelState(states, ()))
    lab.push(model, (0.0, 0.0, 0.0), (0.0, 3.0, 0.0), lab.pose(model, "base"))
    lab.configure(gravity=(0, 0, -9.8))
    lab.steps(200)
    lab.configure(gravity=(0, 0, 0))
    turn = lab.pose(model, "bob").orientation
    assert max(map(abs, lab.twist(model, "bob").angular)) > 0.1
    lab.apply(SetModelState(model, lab.pose(model, "base"), STILL))
    lab.steps(100)
    assert lab.twist(model, "bob").angular == pytest.approx((0, 0, 0), abs=1e-9)
    assert lab.pose(model, "bob").orientation == pytest.approx(turn, abs=1e-9)


def test_a_ball_joint_that_is_no_number_is_put_back_once(weightless):
    lab, nan = weightless, math.nan
    model = lab.load(SWING)
    body = next(one for one in lab.backend._bodies.values() if one.model_id == model)
    pybullet.resetJointStateMultiDof(body.uid, body.ball_joints[0].index, targetValue=(nan,) * 4,
                                     targetVelocity=(nan,) * 3)
    lab.backend._readout.mark_changed(body)
    lab.steps(1)
    assert [event.kind for event in lab.backend.events()] == ["diverged"]
    lab.steps(100)
    assert lab.backend.events() == []
    assert lab.pose(model, "bob").orientation == pytest.approx((0, 0, 0, 1), abs=1e-9)


def test_an_axis_that_is_no_number_is_put_back_where_it_was(weightless):
    lab = weightless
    model = lab.load(Model("m", links=[Link("base", inertial=mass(kg=5.0)),
                                       Link("bob", inertial=mass((0, 0, -1)))],
                           joints=[Joint("hinge", "revolute", "base", "bob", axis=JointAxis())]))
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.7, 0.0),)))
    lab.steps(1)
    body = next(one for one in lab.backend._bodies.values() if one.model_id == model)
    pybullet.resetJointState(body.uid, body.axes[0].index, math.nan, math.nan)
    lab.backend._readout.mark_changed(body)
    lab.steps(1)
    assert [event.kind for event in lab.backend.events()] == ["diverged"]
    lab.steps(10)
    assert lab.joint(model)[0] == pytest.approx(0.7, abs=1e-3)


def test_what_is_thrown_away_in_each_step_is_told_of_once_until_it_is_put_elsewhere(weightless):
    lab = weightless
    model = lab.load(Model("m", links=[Link("link", inertial=mass())]))
    row = lab.rows[model, "link"]
    push = TimedWrench(1, row, 0, FOREVER, force=(1e308, 1e308, 0.0), torque=(0.0, 0.0, 1e308))
    lab.apply(AddTimedForces((push,)))
    told = []
    for _ in range(50):
        lab.steps(1)
        told += lab.backend.events()
    assert [event.kind for event in told] == ["diverged"]
    lab.apply(SetModelState(model, Pose((0.0, 0.0, 1.0))))
    for _ in range(50):
        lab.steps(1)
        told += lab.backend.events()
    assert [event.kind for event in told] == ["diverged"] * 2
