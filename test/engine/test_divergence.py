"""Models that are thrown out of the world are stopped, and the others go on."""
from __future__ import annotations

import pytest
from conftest import Lab, ball, box, ground

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.engine.timed_forces import FOREVER, AddTimedForces, TimedWrench
from my_simulations.geometry import Pose, norm

STEPS_S = (0.001, 0.002, 0.005, 0.01)


def push(lab: Lab, model: int, force, link: str = "link") -> None:
    lab.apply(AddTimedForces((TimedWrench(1, lab.rows[model, link], lab.step, FOREVER,
                                          force=force),)))


def told(lab: Lab) -> list:
    return [event for event in lab.backend.events() if event.kind == "diverged"]


@pytest.mark.parametrize("step_size", STEPS_S)
def test_a_model_that_a_force_throws_away_is_stopped_and_the_others_go_on(lab, step_size):
    lab.configure(step_size=step_size)
    lab.load(ground())
    thrown = lab.load(box("thrown", mass=1.0), (0, 0, 0.5))
    falls = lab.load(ball("falls"), (20, 0, 6.0))
    push(lab, thrown, (2000.0, 0.0, 9.81))
    lab.seconds(1.0)
    there = lab.pose(thrown)
    assert 0.0 < there.position[0] < 343.0
    lab.seconds(1.0)
    assert lab.pose(thrown) == there
    assert norm(lab.twist(thrown).linear) == 0.0
    assert lab.pose(falls).position[2] == pytest.approx(0.5, abs=0.01)
    events = told(lab)
    assert len(events) == 1, events
    assert "'thrown' became faster than the speed of sound" in events[0].message
    assert "force" in events[0].message


def test_a_stopped_model_moves_again_once_it_is_put_elsewhere(lab):
    lab.load(ground())
    thrown = lab.load(box("thrown"), (0, 0, 0.5))
    lab.push(thrown, (0.0, 0.0, 0.0))
    push(lab, thrown, (0.0, 0.0, 3000.0))
    lab.seconds(1.0)
    lab.backend.apply(AddTimedForces((TimedWrench(1, lab.rows[thrown, "link"], lab.step,
                                                  lab.step),)))
    assert len(told(lab)) == 1
    lab.push(thrown, at=Pose((0, 0, 100.0)))
    lab.steps(1)
    assert lab.twist(thrown).linear[2] != 0.0


def test_a_model_without_ground_is_told_to_fall(lab):
    falls = lab.load(box("falls"), (0, 0, 3.0))
    lab.seconds(40.0)
    assert norm(lab.twist(falls).linear) == 0.0
    message = told(lab)[0].message
    assert "'falls' became faster than the speed of sound" in message
    assert "nothing is below it, so it fell freely" in message


def test_a_velocity_that_a_command_sets_is_no_divergence(lab):
    satellite = lab.load(box("satellite", gravity=False), (4e5, 0, 0))
    lab.push(satellite, (0, 7600.0, 0))
    lab.seconds(1.0)
    assert lab.twist(satellite).linear[1] == pytest.approx(7600.0)
    assert told(lab) == []


def test_a_slow_model_that_leaves_ten_kilometres_is_stopped(lab):
    far = lab.load(box("far", gravity=False), (0, 0, 0))
    lab.push(far, (300.0, 0, 0))
    lab.seconds(35.0)
    assert lab.pose(far).position[0] == pytest.approx(1e4, abs=100.0)
    assert "'far' went further than 10 km" in told(lab)[0].message


def test_a_robot_with_an_odd_inertia_is_told_so(lab):
    links = [Link("body", inertial=Inertial(5.0, Pose(), 0.1, 0, 0, 0.1, 0, 0.1)),
             Link("wheel", Pose((0, 0, 0.2)),
                  inertial=Inertial(1.0, Pose(), 1e-9, 0, 0, 1e-9, 0, 1e-9))]
    robot = Model("robot", links=links,
                  joints=[Joint("hinge", "revolute", "body", "wheel", axis=JointAxis((0, 0, 1)))])
    number = lab.load(robot, (0, 0, 1.0))
    push(lab, number, (0.0, 5000.0, 0.0), "body")
    lab.seconds(1.0)
    message = told(lab)[0].message
    assert "inertia of link 'wheel' is far too small for its mass of 1 kg" in message
    assert norm(lab.twist(number, "wheel").linear) == 0.0
