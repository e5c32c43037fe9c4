"""Limits, springs, dampers, efforts and rates of joint axes, from 1 g to 1000 kg."""
from __future__ import annotations

import math

import pytest
from closed_forms import oscillator
from conftest import Lab, arm, inertial_of_box, link_of
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box
from my_simulations.engine.commands import FOREVER, SetJoints
from my_simulations.engine.timed_forces import AddTimedForces, TimedEffort
from my_simulations.geometry import Pose

G = 9.8
DT = 1e-3
MASSES = pytest.mark.parametrize("mass", [1e-3, 1.0, 1000.0])
KINDS = pytest.mark.parametrize("kind", ["prismatic", "revolute"])
DAMPING = pytest.mark.parametrize("share", [0.0, 0.02, 1.0, 10.0])  # of inertia / dt


def _slider_or_hinge(lab: Lab, kind: str, mass: float, **axis: float) -> int:
    """An axis that feels `mass` in kg or kg m^2; the hinge's is vertical."""
    return lab.load(arm(kind, JointAxis((0, 0, 1), **axis), mass=mass / 1.001, length=1.0,
                        moment=1e-3 * mass / 1.001 if kind == "revolute" else 1e-3 * mass))


def _felt(kind: str, mass: float) -> float:
    return mass if kind == "revolute" else mass / 1.001


def _push(lab: Lab, model: int, effort: float) -> None:
    lab.apply(AddTimedForces((TimedEffort(model, lab.joint_rows[model, "hinge"], lab.step, FOREVER,
                             effort=effort),)))


@MASSES
@KINDS
@DAMPING
def test_a_limit_holds_against_a_constant_effort(lab: Lab, laws: Laws, mass: float, kind: str,
                                                 share: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertia = _felt(kind, mass)
    away = min(0.3, oscillator(1.0, inertia, 0.0, share * inertia / DT, 10 * inertia)[0] / 2)
    model = _slider_or_hinge(lab, kind, mass, lower=-1.0, upper=away, damping=share * inertia / DT)
    _push(lab, model, 10.0 * inertia)
    lab.seconds(2)
    for _ in range(100):
        lab.steps(10)
        laws.near("limits, 1 g to 1000 kg, damping to 10 m/dt: m or rad",
                  lab.joint(model)[0], away, abs=1e-3)


@MASSES
@KINDS
def test_a_limit_holds_a_weight_that_falls_onto_it(lab: Lab, laws: Laws, mass: float, kind: str):
    axis = (0.0, 0.0, 1.0) if kind == "prismatic" else (0.0, -1.0, 0.0)
    model = lab.load(arm(kind, JointAxis(axis, lower=-0.4, upper=0.1), mass=mass,
                         moment=1e-3 * mass))
    lab.seconds(2)
    for _ in range(100):
        lab.steps(10)
        laws.near("limits under the weight of 1 g to 1000 kg: m or rad", lab.joint(model)[0],
                  -0.4, abs=1e-3)


@MASSES
@KINDS
@pytest.mark.parametrize("share", [0.0, 0.002, 0.02, 0.04, 1.0, 10.0])
def test_a_spring_with_a_damper_moves_as_its_closed_form(lab: Lab, laws: Laws, mass: float,
                                                         kind: str, share: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertia = _felt(kind, mass)
    stiffness, damping = 400.0 * inertia, share * inertia / DT   # 20 rad/s
    model = _slider_or_hinge(lab, kind, mass, spring_stiffness=stiffness, damping=damping,
                             spring_reference=0.3)
    for n in range(1, 51):
        lab.steps(20)
        expected, _ = oscillator(n * 0.02, inertia, stiffness, damping, stiffness * 0.3)
        laws.near("springs with dampers to 10 m/dt: share of the way", lab.joint(model)[0] / 0.3,
                  expected / 0.3, abs=0.02)


@MASSES
@KINDS
@pytest.mark.parametrize("share", [0.002, 0.01, 0.04, 0.2, 1.0, 10.0])
def test_a_damper_slows_down_as_its_closed_form(lab: Lab, laws: Laws, mass: float, kind: str,
                                                share: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertia = _felt(kind, mass)
    model = _slider_or_hinge(lab, kind, mass, damping=share * inertia / DT)
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.0, 1.0),)))
    for n in range(1, 101):
        lab.steps(1)
        laws.near("dampers to 10 m/dt: rate, share of that at the start", lab.joint(model)[1],
                  math.exp(-share * n), abs=0.02)


@pytest.mark.parametrize("share", [0.005, 0.02, 0.04, 0.2])
def test_wheels_of_a_free_base_slow_down_as_their_closed_form(lab: Lab, laws: Laws, share: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    rim = 5e-4
    base = link_of(Box((0.3, 0.2, 0.1)), inertial_of_box(3.0, 0.3, 0.2, 0.1), name="base")
    wheels = [Link(name, pose=Pose((0.0, y, 0.0)), inertial=Inertial(
        0.2, Pose(), 0.6 * rim, 0.0, 0.0, rim, 0.0, 0.6 * rim))
        for name, y in (("left", 0.12), ("right", -0.12))]
    joints = [Joint(wheel.name, "revolute", "base", wheel.name,
                    axis=JointAxis((0, 1, 0), damping=share * rim / DT)) for wheel in wheels]
    model = lab.load(Model("robot", links=[base, *wheels], joints=joints), (0, 0, 1))
    lab.apply(SetJoints(tuple((lab.joint_rows[model, joint.name], 0.0, 1.0) for joint in joints)))
    # Both wheels turn the base back: 1 / rim for each, and 2 / its own moment.
    ease = 1.0 / rim + 2.0 / (3.0 / 12.0 * (0.3 ** 2 + 0.1 ** 2))
    for n in range(1, 101):
        lab.steps(1)
        laws.near("dampers of wheels to 0.2 m/dt: rate, share of that at the start",
                  lab.joint(model, "left")[1], math.exp(-share * rim * ease * n), abs=0.002)


@MASSES
@KINDS
@DAMPING
def test_efforts_act_up_to_their_limit(lab: Lab, laws: Laws, mass: float, kind: str, share: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertia = _felt(kind, mass)
    damping = share * inertia / DT
    model = _slider_or_hinge(lab, kind, mass, effort=2.0 * inertia, damping=damping)
    _push(lab, model, 50.0 * inertia)
    lab.steps(500)
    laws.near("effort limits: rate after 0.5 s, m/s or rad/s", lab.joint(model)[1],
              oscillator(0.5, inertia, 0.0, damping, 2.0 * inertia)[1], rel=0.02)


@MASSES
@KINDS
@DAMPING
def test_efforts_drive_no_faster_than_the_rate_limit(lab: Lab, laws: Laws, mass: float,
                                                     kind: str, share: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertia = _felt(kind, mass)
    model = _slider_or_hinge(lab, kind, mass, velocity=0.5, damping=share * inertia / DT)
    # 10 rad/s^2 against the damper's drag at the limit, so that it would go faster.
    _push(lab, model, (10.0 + 0.5 * share / DT) * inertia)
    fastest = 0.0
    for _ in range(500):
        lab.steps(1)
        fastest = max(fastest, lab.joint(model)[1])
    laws.near("rate limits: the fastest, m/s or rad/s", fastest, 0.5, rel=0.02)


@MASSES
def test_a_spring_carries_a_weight(lab: Lab, laws: Laws, mass: float):
    model = lab.load(arm("prismatic", JointAxis((0, 0, 1), spring_stiffness=400.0 * mass,
                                                damping=20.0 * mass), mass=mass))
    lab.seconds(2)
    laws.near("springs: how far a weight pulls them, m", lab.joint(model)[0], -G / 400, rel=0.02)


@MASSES
@pytest.mark.parametrize("share", [0.02, 1.0, 10.0])
def test_a_damper_carries_a_weight_at_its_speed(lab: Lab, laws: Laws, mass: float, share: float):
    model = lab.load(arm("prismatic", JointAxis((0, 0, 1), damping=share * mass / DT), mass=mass))
    lab.seconds(1)
    laws.near("dampers: the speed at which a weight sinks, m/s", lab.joint(model)[1],
              -G * DT / share, rel=0.02)


def test_an_undamped_spring_keeps_swinging(lab: Lab, laws: Laws):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = _slider_or_hinge(lab, "prismatic", 1.001, spring_stiffness=400.0)
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.1, 0.0),)))
    lab.steps(round(20 * 2 * math.pi / 20 * 1000))   # 20 periods
    swing = math.hypot(lab.joint(model)[0], lab.joint(model)[1] / 20)
    laws.at_most("springs: swing lost in 20 periods, share", abs(1 - swing / 0.1), 0.02)


@pytest.mark.parametrize("dt", [1e-3, 4e-3])
def test_a_two_link_arm_with_stiff_springs_and_dampers_stays_put(lab: Lab, laws: Laws, dt: float):
    lab.configure(step_size=dt)
    inertial = Inertial(1.0, Pose((0.5, 0, 0)), 0.01, 0, 0, 0.1, 0, 0.1)
    axis = JointAxis((0, 1, 0), spring_stiffness=5e6, damping=1e4)
    model = lab.load(Model("arm", links=[Link("a", inertial=inertial),
                                         Link("b", Pose((1, 0, 0)), inertial)],
                           joints=[Joint("hinge", "revolute", "world", "a", axis=axis),
                                   Joint("elbow", "revolute", "a", "b", axis=axis)]))
    lab.steps(2000)
    laws.near("springs of 5e6 N m/rad: sag, rad", lab.joint(model)[0], 0.0, abs=1e-4)
    laws.near("springs of 5e6 N m/rad: sag, rad", lab.joint(model, "elbow")[0], 0.0, abs=1e-4)
