"""Servos that hold or stop an axis, and the motors of other plugins."""
from __future__ import annotations

import pytest
from running_simulator import running

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.drive_commands import JointMotor, JointServo


@pytest.fixture
def drives():
    cart = Model("cart", links=[Link("base", inertial=Inertial()),
                                Link("wheel", inertial=Inertial())],
                 joints=[Joint("axle", "revolute", "base", "wheel", axis=JointAxis())])
    with running(World(models=[cart])) as made:
        yield made.drives


def row_of(drives):
    return drives._session.axis_row("cart::axle")


def servos(drives):
    return [servo for servo in drives.settings.servos if servo.drive]


def test_a_motor_ends_a_hold_and_goes_on_when_the_axis_is_only_stopped(drives):
    row = row_of(drives)
    drives.set(servos=[JointServo(row, "position", holds=True)])
    drives.set([JointMotor(row, 2.0, 1.0)])
    assert servos(drives) == []
    drives.set(servos=[JointServo(row, "velocity", most_effort=5.0)])
    assert servos(drives) == [] and drives.settings.motors == (JointMotor(row, 2.0, 1.0),)


def test_a_servo_that_moves_the_axis_begins_and_can_stop_it(drives):
    row = row_of(drives)
    drives.set([JointMotor(row, 2.0, 1.0)])
    for target in (1.0, 0.0):
        drives.set(servos=[JointServo(row, "velocity", target)])
        assert servos(drives) == [JointServo(row, "velocity", target)]


def test_a_servo_stops_an_axis_without_a_motor(drives):
    row = row_of(drives)
    drives.set([JointMotor(row, 2.0, 0.0)])
    drives.set(servos=[JointServo(row, "velocity")])
    assert servos(drives) == [JointServo(row, "velocity")]
