"""Wind, harness, elevator and net force with real physics, against closed forms."""
from __future__ import annotations

import math

import pytest
from conftest import box
from test_plugin_physics import case, plugin  # noqa: F401

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.surroundings import Wind
from my_simulations.geometry import Pose

MASS, G = 2.0, 9.8


def floating(name, *plugins, y=0.0):
    """A crate 3 m above nothing."""
    made = box(name, mass=MASS)
    made.pose = Pose((0.0, y, 3.0))
    made.plugins += plugins
    return made


def at(one, name):
    return one.sim.states.model_state(name)[0].position


def hung(inside):
    harness = ('<joint name="strap" type="prismatic"><parent>world</parent><child>link</child>'
               "<axis><xyz>0 0 1</xyz></axis></joint><winch><joint>strap</joint>"
               f"{inside}</winch><detach>strap</detach>")
    return floating("crate", plugin("libHarnessPlugin.so", harness))


def test_a_crate_hangs_lower_by_its_weight_over_the_winchs_gain(case):
    one = case(hung("<pos_pid><p>400</p><d>60</d></pos_pid>"))
    one.sim.clock.advance(4000)
    assert at(one, "crate")[2] == pytest.approx(3.0 - MASS * G / 400.0, abs=1e-4)
    assert at(one, "crate")[:2] == pytest.approx((0.0, 0.0), abs=1e-6)
    one.deliver("/crate/harness/detach", data=True)
    before = at(one, "crate")[2]
    one.sim.clock.advance(200)
    assert before - at(one, "crate")[2] == pytest.approx(0.5 * G * 0.04, rel=0.02)


def test_a_winch_lowers_a_crate_at_its_rate(case):
    one = case(hung("<vel_pid><p>1000</p></vel_pid>"))
    one.deliver("/crate/harness/velocity", data=-0.5)
    one.sim.clock.advance(500)
    before = at(one, "crate")[2]
    one.sim.clock.advance(1000)
    # p (rate - wanted) carries the weight
    assert at(one, "crate")[2] - before == pytest.approx(-0.5 - MASS * G / 1000.0,
                                                                      rel=1e-3)


def test_a_crate_in_the_wind_takes_its_velocity_exponentially(case):
    model, calm = floating("crate"), floating("stone", y=5.0)
    model.enable_wind = True
    one = case(model, calm, gravity=(0.0, 0.0, 0.0), wind=Wind((3.0, 0.0, 0.0)), plugins=[plugin(
        "libWindPlugin.so", "<force_approximation_scaling_factor>1"
        "</force_approximation_scaling_factor><horizontal><magnitude><time_for_rise>0"
        "</time_for_rise></magnitude></horizontal>")])
    one.sim.clock.advance(2000)
    travelled = 3.0 * (2.0 - (1.0 - math.exp(-2.0)))
    assert at(one, "crate")[0] == pytest.approx(travelled, rel=0.02)
    assert at(one, "stone") == pytest.approx((0.0, 5.0, 3.0), abs=1e-9)


def test_a_lift_stands_at_its_floor_lower_by_its_weight_over_the_gain(case):
    cabin = Link("cabin", inertial=Inertial(800.0, ixx=100.0, iyy=100.0, izz=100.0))
    door = Link("door", Pose((1.0, 0.0, 0.0)), Inertial(1.0, ixx=0.1, iyy=0.1, izz=0.1))
    lift = Model("elevator", links=[cabin, door], joints=[
        Joint("lift", "prismatic", "world", "cabin", axis=JointAxis(
            (0.0, 0.0, 1.0), lower=0.0, upper=10.0, effort=100000.0)),
        Joint("door", "prismatic", "cabin", "door", axis=JointAxis(
            (0.0, 1.0, 0.0), lower=0.0, upper=1.0, effort=10.0, damping=2.0))],
        plugins=[plugin("libgazebo_ros_elevator.so", "<lift_joint>elevator::lift</lift_joint>"
                        "<door_joint>elevator::door</door_joint><floor_height>3</floor_height>"
                        "<door_wait_time>60</door_wait_time>")])
    one = case(lift)
    one.sim.clock.advance(100)
    one.deliver("elevator", data="1")
    one.sim.clock.advance(15000)
    height = at(one, "elevator")[2]
    assert height == pytest.approx(3.0 - 801.0 * G / 1e5, abs=2e-3)
    opened = one.sim.joints.states("elevator::door")[0][0]
    assert opened == pytest.approx(1.0, abs=0.05)


def test_the_net_force_of_a_falling_body_is_its_weight(case):
    one = case(floating("crate", plugin("libgazebo_ros_f3d.so", "<bodyName>link</bodyName>"
                                        "<topicName>net</topicName>")))
    one.sim.clock.advance(10)
    force = one.last("net", one.now()).wrench.force
    assert (force.x, force.y, force.z) == pytest.approx((0.0, 0.0, -MASS * G), abs=1e-6)
