"""Joint motors and planar motion against closed forms."""
from __future__ import annotations

import math
from typing import List

import pybullet
import pytest
from conftest import Lab, arm, box, ground, inertial_of_box

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Cylinder, Surface
from my_simulations.engine.api import CommandRefusedError
from my_simulations.engine.bullet.mass_matrix import MassMatrix
from my_simulations.engine.commands import PhysicsSettings
from my_simulations.engine.drive_commands import (
    JointMotor,
    JointServo,
    PidGains,
    PlanarVelocity,
    SetMotors,
    SetPlanarVelocities,
    SetServos,
)
from my_simulations.engine.timed_forces import (
    FOREVER,
    AddTimedForces,
    ClearTimedForces,
    JointPid,
    TimedEffort,
)
from my_simulations.geometry import STILL, Pose, quat_from_rpy

Z = (0.0, 0.0, 1.0)


def wheel(lab: Lab, **axis):
    """An arm of 1 kg m^2 about a vertical axis, which gravity does not turn."""
    model = lab.load(arm("revolute", JointAxis(Z, **axis), moment=1e-6))
    return model, lab.joint_rows[model, "hinge"]


def test_a_motor_brings_an_axis_to_its_rate_and_keeps_it_there(lab: Lab):
    model, row = wheel(lab)
    lab.apply(SetMotors((JointMotor(row, 2.0, 100.0),)))
    lab.seconds(1.0)
    position, rate = lab.joint(model)
    assert rate == pytest.approx(2.0, abs=1e-6)
    assert position == pytest.approx(2.0, rel=0.03)


def test_a_motor_spends_no_more_than_its_effort(lab: Lab):
    model, row = wheel(lab)
    lab.apply(SetMotors((JointMotor(row, 100.0, 3.0),)))
    lab.seconds(1.0)
    assert lab.joint(model)[1] == pytest.approx(3.0, rel=2e-3)  # w = T t / I


def test_a_motor_that_cannot_overcome_the_damper_turns_more_slowly(lab: Lab):
    # It reaches T / d: a wheel that slows down to that, and one that speeds up.
    model, row = wheel(lab, damping=50.0)
    lab.apply(SetMotors((JointMotor(row, 2.0, 101.0),)))
    lab.seconds(0.5)
    assert lab.joint(model)[1] == pytest.approx(2.0, rel=1e-3)
    lab.apply(AddTimedForces((TimedEffort(1, row, lab.step, FOREVER, effort=-51.0),)))
    lab.seconds(0.5)
    assert lab.joint(model)[1] == pytest.approx(1.0, rel=0.01)
    lab.apply(ClearTimedForces((1,)))
    lab.seconds(0.5)
    assert lab.joint(model)[1] == pytest.approx(2.0, rel=1e-3)


def test_a_damper_that_a_motor_cancels_takes_no_time_until_the_motor_changes(
        lab: Lab, monkeypatch: pytest.MonkeyPatch):
    model, row = wheel(lab, damping=500.0)   # Bullet itself computes much weaker ones
    lab.apply(SetMotors((JointMotor(row, 2.0, 2000.0),)))
    lab.steps(50)
    looks: List[int] = []
    states = pybullet.getJointStates
    monkeypatch.setattr(pybullet, "getJointStates",
                        lambda uid, rows: looks.append(lab.step) or states(uid, rows))
    lab.steps(80)
    assert 0 < len(looks) <= 20
    lab.apply(SetMotors((JointMotor(row, 3.0, 1200.0),)))   # 1500 N m are needed
    looks.clear()
    lab.steps(80)
    assert len(looks) >= 80
    lab.seconds(2.0)
    assert lab.joint(model)[1] == pytest.approx(1200.0 / 500.0, rel=0.01)


def test_a_damper_acts_again_when_a_loop_takes_over_its_axis(lab: Lab):
    model, row = wheel(lab, damping=500.0)
    lab.apply(SetMotors((JointMotor(row, 2.0, 2000.0),)))
    lab.steps(50)
    assert lab.joint(model)[1] == pytest.approx(2.0, rel=1e-3)
    lab.apply(AddTimedForces((TimedEffort(1, row, lab.step, FOREVER, pid=JointPid(0.0)),)))
    lab.steps(50)
    assert abs(lab.joint(model)[1]) < 1e-3


def test_motors_that_dominate_their_dampers_do_not_need_the_mobility_of_each_new_pose(
        lab: Lab, monkeypatch: pytest.MonkeyPatch):
    axis = JointAxis(Z, damping=500.0)
    links = [Link(name, pose=Pose((x, 0.0, 0.0)),
                  inertial=Inertial(1.0, Pose((0.5, 0.0, 0.0)), 0.1, 0, 0, 0.1, 0, 0.1))
             for name, x in (("upper", 0.0), ("lower", 1.0))]
    model = lab.load(Model("arm", links=links, joints=[
        Joint("shoulder", "revolute", "world", "upper", axis=axis),
        Joint("elbow", "revolute", "upper", "lower", axis=axis)]))
    rows = [lab.joint_rows[model, name] for name in ("shoulder", "elbow")]
    computed: List[int] = []
    now = MassMatrix.compute
    monkeypatch.setattr(MassMatrix, "compute", lambda self: computed.append(lab.step) or now(self))
    for n in range(10):
        rates = [(-1) ** (n // 5) * 2.0, 1.0 + n]
        lab.apply(SetMotors(tuple(JointMotor(row, rate, 1e5) for row, rate in zip(rows, rates))))
        lab.steps(50)
        assert [lab.joint(model, name)[1] for name in ("shoulder", "elbow")] == pytest.approx(
            rates, rel=1e-3)
    assert len(computed) <= 1


def test_light_wheels_with_strong_dampers_keep_the_rate_of_their_motors(lab: Lab):
    # A base of 0.7 kg on wheels of 11 g, whose dampers would brake them by 2000 rad/s in a step.
    lab.load(ground(1.0))
    spin = JointAxis((0.0, 0.0, 1.0), damping=1.0, effort=70.0)
    links = [Link("base", Pose((0, 0, 0.042)), inertial_of_box(0.7, 0.12, 0.08, 0.08), [Collision(
        "c", Box((0.12, 0.08, 0.08)), surface=Surface(mu=0.1))])]
    joints = []
    for name, y in (("left", 0.0455), ("right", -0.0455)):
        at = Pose((0.004, y, 0.024), quat_from_rpy(-math.pi / 2, 0, 0))
        links.append(Link(name, at, Inertial(0.011, ixx=2e-6, iyy=2e-6, izz=4e-6), [
            Collision("c", Cylinder(0.024, 0.01))]))
        joints.append(Joint(name, "revolute", "base", name, axis=spin))
    base = lab.load(Model("base", links=links, joints=joints))
    lab.steps(100)
    rows = [lab.joint_rows[base, name] for name in ("left", "right")]
    for step in range(50):   # not so fast that the wheels spin
        lab.apply(SetMotors(tuple(JointMotor(row, 8.0 * (step + 1) / 50, 70.0) for row in rows)))
        lab.steps(10)
    lab.steps(1000)
    for name in ("left", "right"):
        assert lab.joint(base, name)[1] == pytest.approx(8.0, rel=1e-3)
    assert abs(lab.twist(base, "base").angular[2]) < 2e-3


def test_an_axis_without_effort_has_its_friction_again(lab: Lab):
    model, row = wheel(lab, friction=0.5)
    lab.apply(SetMotors((JointMotor(row, 1.0, 100.0),)))
    lab.seconds(0.5)
    lab.apply(SetMotors((JointMotor(row, 0.0, 0.0),)))
    lab.seconds(1.0)
    assert lab.joint(model)[1] == pytest.approx(0.5, rel=0.01)


def test_a_motor_goes_on_when_the_step_size_changes(lab: Lab):
    model, row = wheel(lab)
    lab.apply(SetMotors((JointMotor(row, 2.0, 100.0),)))
    lab.settings = PhysicsSettings(step_size=0.002)
    lab.backend.configure(lab.settings)
    lab.seconds(1.0)
    assert lab.joint(model)[1] == pytest.approx(2.0, abs=1e-6)


def test_a_motor_goes_on_beside_a_servo_that_gives_efforts_and_after_it(lab: Lab):
    """As ODE's motor beside a force: a drive plugin and gazebo_ros_control at the same wheel."""
    model, row = wheel(lab)
    lab.apply(SetMotors((JointMotor(row, 2.0, 100.0),)))
    for servo in (JointServo(row, "effort", 30.0), JointServo(row, "velocity", -1.0),
                  JointServo(row, "")):
        lab.apply(SetServos((servo,)))
        lab.seconds(0.5)
        assert lab.joint(model)[1] == pytest.approx(
            -1.0 if servo.drive == "velocity" else 2.0, abs=1e-6)


def test_a_motor_holds_a_wheel_that_a_loop_too_stiff_for_the_step_would_throw(lab: Lab):
    lab.settings = PhysicsSettings(step_size=0.01)
    lab.backend.configure(lab.settings)
    model = lab.load(arm("revolute", JointAxis(Z), mass=0.01, length=0.3, moment=1e-9))
    row = lab.joint_rows[model, "hinge"]
    lab.apply(SetMotors((JointMotor(row, 0.0, 50.0),)))
    lab.apply(SetServos((JointServo(row, "effort", 0.1, of_rate=True,
                                    gains=PidGains(1.0, 0.0, 0.01)),)))
    lab.seconds(2.0)
    assert lab.joint(model)[1] == pytest.approx(0.0, abs=1e-6)


def test_a_joint_that_a_loop_has_thrown_is_told_of_once(lab: Lab):
    lab.settings = PhysicsSettings(step_size=0.01)
    lab.backend.configure(lab.settings)
    model = lab.load(arm("revolute", JointAxis(Z), mass=0.01, length=0.3, moment=1e-9))
    row = lab.joint_rows[model, "hinge"]
    lab.apply(SetServos((JointServo(row, "effort", 0.1, of_rate=True,
                                    gains=PidGains(1.0, 0.0, 0.01)),)))
    told = []
    for _ in range(100):
        lab.steps(2)
        told += lab.backend.events()
    assert [event.kind for event in told] == ["diverged"]
    assert "a joint of model 'arm'" in told[0].message and "steps of 0.01 s" in told[0].message


def test_a_motor_of_a_joint_that_is_not_there_is_refused(lab: Lab):
    with pytest.raises(CommandRefusedError):
        lab.apply(SetMotors((JointMotor(7, 1.0, 1.0),)))


def test_a_model_drives_a_circle_as_it_is_told(lab: Lab):
    lab.load(ground(mu=0.0))
    model = lab.load(box(size=0.2), (0, 0, 0.1))
    lab.apply(SetPlanarVelocities((PlanarVelocity(model, 0.5, 0.0, math.pi / 2),)))
    lab.seconds(1.0)
    x, y, _ = lab.pose(model).position
    radius = 0.5 / (math.pi / 2)
    assert (x, y) == pytest.approx((radius, radius), abs=1e-3)
    lab.apply(SetPlanarVelocities(()))
    lab.seconds(0.1)  # without friction it goes straight on
    assert lab.pose(model).position[:2] == pytest.approx((radius, radius + 0.05), abs=2e-3)


def test_a_model_that_is_told_to_move_slowly_does_not_fall_asleep(lab: Lab):
    lab.load(ground(mu=0.0))
    model = lab.load(box(size=0.2), (0, 0, 0.1))
    lab.seconds(4)
    lab.apply(SetPlanarVelocities((PlanarVelocity(model, 0.05, 0.0, 0.0),)))
    lab.seconds(5)
    lab.apply(SetPlanarVelocities((PlanarVelocity(model, 0.04, 0.0, 0.0),)))
    lab.seconds(5)
    assert lab.pose(model).position[0] == pytest.approx(0.45, abs=1e-3)
    lab.apply(SetPlanarVelocities(()))
    lab.seconds(3)
    assert lab.twist(model) == STILL


def test_a_model_that_is_driven_level_does_not_fall(lab: Lab):
    model = lab.load(box(), (0, 0, 5))
    lab.apply(SetPlanarVelocities((PlanarVelocity(model, 0.0, 0.3, 0.0),)))
    lab.seconds(1.0)
    # Gravity acts within each step, and is taken back before the next: g dt^2 a step.
    assert lab.pose(model).position == pytest.approx((0.0, 0.3, 5.0), abs=0.011)
