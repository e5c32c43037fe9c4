"""Joint servos against closed forms."""
from __future__ import annotations

import math
from dataclasses import replace

import pytest
from conftest import Lab, arm

from my_simulations.description.model import JointAxis
from my_simulations.engine.api import CommandRefusedError
from my_simulations.engine.commands import FOREVER, PhysicsSettings
from my_simulations.engine.drive_commands import JointServo, PidGains, ReadEfforts, SetServos
from my_simulations.engine.spline import Spline, segment_between
from my_simulations.engine.timed_forces import (
    AddTimedForces,
    ClearTimedForces,
    JointPid,
    TimedEffort,
)

Z = (0.0, 0.0, 1.0)
Y = (0.0, 1.0, 0.0)


def level(lab: Lab, **axis):
    """An arm of 1 kg m^2 about a vertical axis, which gravity does not turn."""
    model = lab.load(arm("revolute", JointAxis(Z, **axis), moment=1e-6))
    return model, lab.joint_rows[model, "hinge"]


def upright(lab: Lab):
    """The same about a horizontal axis: gravity turns it with 9.8 N m when it is level."""
    model = lab.load(arm("revolute", JointAxis(Y), moment=1e-6))
    return model, lab.joint_rows[model, "hinge"]


def test_a_position_drive_goes_there_and_holds_a_weight(lab: Lab):
    model, row = upright(lab)
    lab.apply(SetServos((JointServo(row, "position", -0.5, most_rate=2.0),)))
    lab.seconds(0.2)
    assert lab.joint(model)[0] == pytest.approx(-0.4, abs=0.01)  # as fast as it may
    lab.seconds(1.0)
    assert lab.joint(model)[0] == pytest.approx(-0.5, abs=1e-4)


@pytest.mark.parametrize("servo", [
    JointServo(0, "position", 0.5), JointServo(0, "velocity", 0.0),
    JointServo(0, "effort", 0.5, gains=PidGains(400.0, 0.0, 40.0))], ids=lambda one: one.drive)
def test_a_servo_yields_to_the_loop_of_a_user_and_goes_on_after_it(lab: Lab, servo):
    model, row = level(lab)
    lab.apply(SetServos((replace(servo, row=row),)))
    lab.seconds(1.0)
    before = lab.joint(model)[0]
    loop = JointPid(-0.4, p=50.0, i=0.0, d=15.0)
    lab.apply(AddTimedForces((TimedEffort(7, row, lab.step, FOREVER, 0.0, loop),)))
    lab.seconds(4.0)
    assert lab.joint(model)[0] == pytest.approx(-0.4, abs=2e-3)
    lab.apply(ClearTimedForces((7,)))
    lab.seconds(1.0)
    assert lab.joint(model)[0] == pytest.approx(
        -0.4 if servo.drive == "velocity" else before, abs=2e-3)


def test_a_position_drive_is_where_its_spline_is(lab: Lab):
    model, row = upright(lab)
    spline = Spline((segment_between(0.0, (0.0, 0.0, 0.0), 1.0, (1.0, 0.0, 0.0)),
                     segment_between(1.0, (1.0, 0.0, 0.0), 2.0, (0.3, 0.0, 0.0))))
    lab.apply(SetServos((JointServo(row, "position", spline=spline),)))
    for _ in range(20):
        lab.steps(100)
        position, rate = lab.joint(model)
        wanted, wanted_rate, _ = spline.at(lab.step * 1e-3)
        assert position == pytest.approx(wanted, abs=1e-6)
        assert rate == pytest.approx(wanted_rate, abs=4e-3)  # half a step earlier


def test_a_loop_on_the_position_is_a_spring_and_a_damper(lab: Lab):
    model, row = level(lab)
    p, d = 100.0, 4.0
    lab.apply(SetServos((JointServo(row, "effort", 0.2, gains=PidGains(p, d=d), by_rates=True),)))
    lab.steps(300)
    decay, swing, t = d / 2.0, math.sqrt(p - d * d / 4.0), 0.3
    wanted = 0.2 * (1.0 - math.exp(-decay * t) * (
        math.cos(swing * t) + decay / swing * math.sin(swing * t)))
    assert lab.joint(model)[0] == pytest.approx(wanted, rel=0.02)


def test_the_integral_carries_a_weight(lab: Lab):
    model, row = upright(lab)
    gains = PidGains(200.0, 200.0, 30.0, -50.0, 50.0)
    lab.apply(SetServos((JointServo(row, "effort", 0.0, gains=gains),)))
    lab.seconds(6.0)
    assert lab.joint(model)[0] == pytest.approx(0.0, abs=1e-3)
    assert lab.apply(ReadEfforts((row,)))[0] == pytest.approx(-9.8, rel=1e-2)


def test_an_effort_is_kept_up_and_limited(lab: Lab):
    model, row = level(lab)
    lab.apply(SetServos((JointServo(row, "effort", 5.0, most_effort=2.0),)))
    lab.seconds(0.5)
    assert lab.joint(model)[1] == pytest.approx(1.0, rel=2e-3)  # w = T t / I
    lab.apply(SetServos((JointServo(row, "effort", 0.0),)))
    lab.seconds(0.5)
    assert lab.joint(model)[1] == pytest.approx(1.0, rel=2e-3)


def test_a_velocity_drive_with_gains_reaches_its_rate(lab: Lab):
    model, row = level(lab)
    lab.apply(SetServos((JointServo(row, "velocity", 2.0, drive_gains=PidGains(20.0)),)))
    lab.seconds(0.1)
    assert lab.joint(model)[1] == pytest.approx(2.0 * (1.0 - math.exp(-2.0)), rel=0.02)
    lab.seconds(1.0)
    assert lab.joint(model)[1] == pytest.approx(2.0, abs=1e-3)


def test_a_velocity_drive_without_gains_spends_no_more_than_its_effort(lab: Lab):
    model, row = level(lab)
    lab.apply(SetServos((JointServo(row, "velocity", 100.0, most_effort=3.0, most_rate=50.0),)))
    lab.seconds(1.0)
    assert lab.joint(model)[1] == pytest.approx(3.0, rel=2e-3)
    assert lab.apply(ReadEfforts((row,)))[0] == pytest.approx(3.0, rel=1e-3)


def test_an_axis_without_servo_has_its_friction_again(lab: Lab):
    model, row = level(lab, friction=0.5)
    lab.apply(SetServos((JointServo(row, "velocity", 1.0),)))
    lab.seconds(0.5)
    lab.apply(SetServos((JointServo(row, ""),)))
    lab.seconds(1.0)
    assert lab.joint(model)[1] == pytest.approx(0.5, rel=0.01)


def test_another_target_keeps_the_integral(lab: Lab):
    model, row = upright(lab)
    servo = JointServo(row, "effort", 0.0, gains=PidGains(200.0, 200.0, 30.0, -50.0, 50.0))
    lab.apply(SetServos((servo,)))
    lab.seconds(6.0)
    lab.apply(SetServos((JointServo(row, "effort", 1e-3, gains=servo.gains),)))
    lab.seconds(0.1)
    assert lab.joint(model)[0] == pytest.approx(0.0, abs=2e-3)  # it does not drop


def test_servos_go_on_when_the_step_size_changes(lab: Lab):
    model, row = upright(lab)
    lab.apply(SetServos((JointServo(row, "position", 0.3),)))
    lab.settings = PhysicsSettings(step_size=0.002)
    lab.backend.configure(lab.settings)
    lab.seconds(1.0)
    assert lab.joint(model)[0] == pytest.approx(0.3, abs=1e-4)


@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005, 0.01])
def test_a_motor_with_a_lag_is_where_its_time_constant_says(lab: Lab, step_size: float):
    lab.configure(step_size=step_size)
    model, row = upright(lab)
    lab.apply(SetServos((JointServo(row, "velocity", 0.5, lags=(0.2, 0.1)),)))
    lab.seconds(0.4)
    risen = 0.5 * (1.0 - math.exp(-2.0))
    assert lab.joint(model)[1] == pytest.approx(risen, rel=1e-3)
    lab.apply(SetServos((JointServo(row, "velocity", -0.5, lags=(0.2, 0.1)),)))
    lab.seconds(0.2)
    assert lab.joint(model)[1] == pytest.approx((0.5 + risen) * math.exp(-2.0) - 0.5, rel=1e-3)


def test_a_servo_of_a_joint_that_is_not_there_is_refused(lab: Lab):
    with pytest.raises(CommandRefusedError):
        lab.apply(SetServos((JointServo(7, "effort"),)))
