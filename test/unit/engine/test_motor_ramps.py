"""Ramps of motors, on joints that follow their motors at once unless something holds them."""
from __future__ import annotations

import pytest

from my_simulations.description.model import Joint, JointAxis, Link, Model
from my_simulations.engine.commands import Clear, LoadModel, RemoveModel
from my_simulations.engine.drive_commands import JointMotor, RateRamp, SetMotors
from my_simulations.engine.motor_ramps import MotorRamps
from my_simulations.engine.ring import NO_LIMIT, Clock
from my_simulations.geometry import Pose

LEFT, RIGHT = 0, 1
RAMP = RateRamp(acceleration=2.0, tolerance=0.1, hertz=50.0, group="base")
CLOCK = Clock(0, 0, 10 ** 9)


class Base:
    """Two wheels, stepped at 1 ms."""

    def __init__(self):
        self.rates = {LEFT: 0.0, RIGHT: 0.0}
        self.held = set()
        self.changes = []    # steps at which motors were set
        self.step, self.clock = 0, CLOCK
        self.ramps = MotorRamps(
            lambda rows: [value for row in rows for value in (0.0, self.rates[row])], self._set)

    def _set(self, command):
        self.changes.append(self.step)
        self.rates.update({one.row: one.rate for one in command.motors if one.row not in self.held})

    def drive(self, left, right, ramp=RAMP):
        self.ramps.set(SetMotors((JointMotor(LEFT, left, 5.0, ramp),
                                  JointMotor(RIGHT, right, 5.0, ramp))), self.step, self.clock)

    def advance(self, steps):
        for _ in range(steps):
            self.step += 1
            if self.ramps.next_step <= self.step:
                self.ramps.act(self.step, self.clock)


@pytest.fixture
def base():
    return Base()


def test_rates_change_at_the_steps_of_the_rate_by_no_more_than_the_acceleration(base):
    base.step = 7
    base.drive(1.0, -0.5)
    base.changes.clear()
    base.advance(60)
    assert base.changes == [20, 40, 60]
    assert base.rates == pytest.approx({LEFT: 0.12, RIGHT: -0.12})


def test_all_motors_have_their_rates_once_one_joint_is_near_its_own(base):
    base.drive(1.0, 0.2)
    base.advance(60)
    assert base.rates == pytest.approx({LEFT: 0.12, RIGHT: 0.12})
    base.advance(20)
    assert base.rates == {LEFT: 1.0, RIGHT: 0.2}
    assert base.ramps.next_step == NO_LIMIT


def test_a_command_for_one_motor_leaves_the_target_of_the_other(base):
    base.drive(1.0, 1.0)
    base.advance(40)
    base.ramps.set(SetMotors((JointMotor(LEFT, -1.0, 5.0, RAMP),)), base.step, CLOCK)
    base.advance(20)
    assert base.rates == pytest.approx({LEFT: 0.04, RIGHT: 0.12})


def test_wheels_that_are_held_do_not_wind_up(base):
    base.held = {LEFT, RIGHT}
    base.drive(1.0, 1.0)
    base.advance(5000)
    base.drive(-1.0, -1.0)
    base.held = set()
    base.advance(20)
    assert base.rates == pytest.approx({LEFT: 0.96, RIGHT: 0.96})


def test_a_motor_that_is_set_without_a_ramp_has_its_rate_at_once_and_stays(base):
    base.drive(1.0, 1.0)
    base.advance(30)
    base.drive(0.0, 0.0, ramp=None)
    base.advance(100)
    assert base.rates == {LEFT: 0.0, RIGHT: 0.0}
    base.drive(1.0, 1.0)
    base.advance(20)
    assert base.rates == pytest.approx({LEFT: 0.04, RIGHT: 0.04})


def test_the_last_ramp_of_a_motor_counts(base):
    base.drive(1.0, 1.0)
    base.advance(40)
    base.drive(-1.0, -1.0, ramp=RateRamp(1.0, 0.1, 25.0, "another drive"))
    base.advance(20)
    assert base.rates == pytest.approx({LEFT: 0.08, RIGHT: 0.08})
    base.advance(20)
    assert base.rates == pytest.approx({LEFT: 0.04, RIGHT: 0.04})


def test_a_ramp_begins_at_the_rate_of_the_motor_whatever_the_joint_does(base):
    base.drive(0.2, 0.2, ramp=None)
    base.rates = {LEFT: 0.1, RIGHT: 0.3}
    base.drive(1.0, 1.0)
    assert base.rates == {LEFT: 0.2, RIGHT: 0.2}


def test_a_ramp_of_a_joint_without_a_motor_begins_at_its_rate(base):
    base.rates = {LEFT: 0.5, RIGHT: 0.5}
    base.drive(1.0, 1.0)
    base.advance(20)
    assert base.rates == pytest.approx({LEFT: 0.54, RIGHT: 0.54})


@pytest.mark.parametrize("command", [RemoveModel(7), Clear()])
def test_ramps_end_with_their_model(base, command):
    spin = JointAxis((0.0, 1.0, 0.0))
    model = Model("base", links=[Link("body"), Link("l"), Link("r")], joints=[
        Joint("left", "revolute", "body", "l", axis=spin),
        Joint("right", "revolute", "body", "r", axis=spin)])
    base.ramps.note_applied(LoadModel(7, model, Pose(), 0, LEFT))
    base.drive(1.0, 1.0)
    base.ramps.note_applied(command)
    assert base.ramps.next_step == NO_LIMIT


def test_another_clock_has_other_steps(base):
    base.drive(1.0, 1.0)
    base.advance(25)
    base.clock = Clock(25, 15_000_000, 2 * 10 ** 9)
    base.ramps.set_clock(base.step, base.clock)
    base.changes.clear()
    base.advance(25)
    assert base.changes == [28, 38, 48]
