"""The quadrotor of sjtu_drone: its states, commands and topics, against its formulas."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.model import Inertial
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.plugins.flight.filtered_pid import FilteredPid
from my_simulations.plugins.flight.sjtu_drone import SjtuDrone
from my_simulations.plugins.parameters import Parameters
from my_simulations.plugins.testing import FakeContext

MASS = 1.5
OFF = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def drone(inside=""):
    context = FakeContext(f"<plugin>{inside}</plugin>")
    context.link("").inertial = Inertial(MASS, ixx=0.01, iyy=0.02, izz=0.03)
    return context, context.load(SjtuDrone)


def flying(inside=""):
    context, plugin = drone(inside)
    context.deliver("drone/takeoff")
    context.advance(0.6)
    return context, plugin


def command(context, linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0), topic="/cmd_vel"):
    context.deliver(topic, linear=dict(zip("xyz", linear)), angular=dict(zip("xyz", angular)))
    context.advance(0.001)
    return context.wrenches["base"]


def test_it_takes_off_flies_and_lands_with_the_thrust_of_each_state():
    context, _ = drone()
    assert command(context, (0.0, 0.0, 1.0)) == OFF
    command(context)
    assert context.stops == 0   # the engine waits for it only while it flies
    context.deliver("drone/takeoff")
    context.advance(0.4)
    assert context.wrenches["base"][0][2] == pytest.approx(1.5 * MASS * 9.8)
    context.advance(0.2)
    assert context.wrenches["base"][0][2] == pytest.approx(MASS * 9.8)
    context.deliver("drone/land")
    context.advance(0.9)
    assert context.wrenches["base"][0][2] == pytest.approx(0.8 * MASS * 9.8)
    context.advance(0.2)
    assert context.wrenches["base"] == OFF and context.stops == 0


def test_velocity_commands_rise_pitch_roll_and_turn():
    context, _ = flying()
    force, torque = command(context, (1.0, 0.0, 0.5), (0.0, 0.0, 0.2))
    assert force[2] == pytest.approx(MASS * (9.8 + 5.0 * 0.5))
    assert torque == pytest.approx((0.0, 0.02 * 5.0 * (5.0 / 9.8), 0.03 * 5.0 * 0.2))
    assert command(context, (0.0, 1.0, 0.0))[1] == pytest.approx((-0.01 * 5.0 * (5.0 / 9.8),
                                                                   0.0, 0.0))


def test_the_thrust_acts_at_the_centre_of_mass():
    context, _ = flying()
    context.link("").inertial = Inertial(MASS, Pose((0.02, 0.0, 0.01)), 0.01, iyy=0.02,
                                         izz=0.03)
    assert command(context)[1] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_a_position_command_is_a_place_in_the_world():
    context, _ = flying("<positionXYProportionalGain>2</positionXYProportionalGain>"
                        "<positionZProportionalGain>2</positionZProportionalGain>")
    context.link("").pose = Pose((1.0, 0.0, 3.0), quat_from_rpy(0.0, 0.0, math.pi / 2))
    context.deliver("drone/posctrl", data=True)
    context.advance(0.001)     # the change of its place has passed
    force, torque = command(context, (1.0, 0.5, 3.5), (0.0, 0.0, 1.0))
    assert force[2] == pytest.approx(MASS * (9.8 + 5.0 * 2.0 * 0.5))
    # It looks along y: a pitch of 0.51 rad about the body's y axis, which is -x of the world.
    assert torque == pytest.approx((-0.02 * 5.0 * (5.0 * 1.0 / 9.8), 0.0, 0.0), abs=1e-9)


def test_angular_commands_tilt_while_it_takes_off():
    context, _ = drone()
    context.deliver("drone/takeoff")
    torque = command(context, angular=(0.0, 0.1, 0.0))[1]
    assert torque == pytest.approx((0.0, 1.5 * 0.02 * 5.0 * 0.1, 0.0))
    context.deliver("/drone/vel_mode", data=True)
    torque = command(context, angular=(0.1, 0.0, 0.0))[1]    # along x
    assert torque == pytest.approx((0.0, 1.5 * 0.02 * 5.0 * 5.0 * 0.1 / 9.8, 0.0))


def test_ground_truth_is_in_the_axes_of_the_body():
    context, _ = drone()
    context.link("").pose = Pose((1.0, 2.0, 3.0), quat_from_rpy(0.0, 0.0, math.pi / 2))
    context.link("").twist = Twist((0.0, 2.0, 0.0))
    context.advance(0.001)
    assert context.published["drone/gt_pose"][-1].position.y == 2.0
    assert context.published["drone/gt_vel"][-1].linear.x == pytest.approx(2.0)
    assert context.published["drone/gt_acc"][-1].linear.x == pytest.approx(2000.0)


def test_a_namespace_names_all_topics():
    context, _ = drone("<rosNamespace>drone7</rosNamespace>")
    context.deliver("drone7/takeoff")
    context.advance(0.6)
    assert command(context, (0.0, 0.0, 0.1), topic="drone7/cmd_vel")[0][2] > MASS * 9.8
    assert "drone7/gt_pose" in context.published


def test_noise_is_within_its_bounds_and_repeats_after_a_reset():
    context, plugin = flying("<motionSmallNoise>0.05</motionSmallNoise>"
                             "<motionDriftNoise>0.02</motionDriftNoise>"
                             "<motionDriftNoiseTime>0.1</motionDriftNoiseTime>")

    def thrusts():
        return [command(context)[0][2] for _ in range(200)]

    first = thrusts()
    assert 0.0 < max(abs(one - MASS * 9.8) for one in first) <= MASS * 5.0 * 0.07 + 1e-9
    plugin.reset()
    context.deliver("drone/takeoff")
    context.advance(0.6)
    assert thrusts() == first


def test_a_reset_lands_it():
    context, plugin = flying()
    plugin.reset()
    context.advance(0.1)
    assert context.wrenches["base"] == OFF


def test_the_limit_of_the_thrust_holds_before_the_factor_of_the_take_off():
    context, _ = drone("<maxForce>10</maxForce>")
    context.deliver("drone/takeoff")
    context.advance(0.1)
    assert context.wrenches["base"][0][2] == pytest.approx(15.0)


def test_a_jump_of_an_unfiltered_command_gives_no_rate():
    pid = FilteredPid(Parameters("<plugin/>"), "a", (0.0, 0.0, 1.0), filters_rate=True)
    assert pid.update(1.0, 0.0, 0.0, 0.001) == 0.0
