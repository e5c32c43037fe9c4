"""Cars that are driven by torques, in a world without physics, against their formulas."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.model import JointAxis
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.drive.audibot import Audibot
from my_simulations.plugins.drive.prius import PriusHybrid
from my_simulations.plugins.drive.wheels import FASTEST, apply_torque
from my_simulations.plugins.state.world_odometry import CatVehicle
from my_simulations.plugins.testing import FakeContext, FakeJoint

PRIUS = ("fl", "fr", "bl", "br", "sl", "sr", "hand")
MPH = 1.0 / 2.23694   # m/s


def wheel(velocity=0.0, friction=0.0):
    joint = FakeJoint("wheel")
    joint.velocity, joint.spec.axis = velocity, JointAxis(friction=friction)
    return joint


@pytest.mark.parametrize("velocity, torque, friction, motor", [
    (0.0, 50.0, 20.0, (FASTEST, 30.0)),      # accelerates
    (-1.0, -50.0, 20.0, (-FASTEST, 30.0)),
    (5.0, 20.0, 50.0, (0.0, 30.0)),          # stops
    (5.0, -20.0, 50.0, (-FASTEST, 70.0)),    # torque and friction both act against the motion
    (0.0, 0.0, 0.0, (0.0, 0.0))])            # turns freely
def test_a_torque_acts_against_friction(velocity, torque, friction, motor):
    joint = wheel(velocity)
    apply_torque(joint, torque, friction)
    assert joint.motor == motor


def test_the_friction_of_the_joint_stays():
    joint = wheel(friction=3.0)
    apply_torque(joint, 0.0, 2.0)
    assert joint.motor == (0.0, 5.0)


def prius(**more):
    names = {"chassis": "chassis", "front_left_wheel": "fl", "front_right_wheel": "fr",
             "back_left_wheel": "bl", "back_right_wheel": "br", "front_left_wheel_steering": "sl",
             "front_right_wheel_steering": "sr", "steering_wheel": "hand", "front_torque": "800",
             "back_torque": "0", "front_brake_torque": "1000", "back_brake_torque": "600",
             "max_speed": "30", "max_steer": "0.6", "flwheel_steering_p_gain": "1e4", **more}
    inside = "".join(f"<{name}>{value}</{name}>" for name, value in names.items())
    context = FakeContext(f"<plugin>{inside}</plugin>", joints=PRIUS)
    for name, x, y in (("fl", 2.8, 0.8), ("fr", 2.8, -0.8), ("bl", 0.0, 0.8), ("br", 0.0, -0.8)):
        context.link(name).pose = Pose((x, y, 0.3))
    return context, context.load(PriusHybrid)


def control(context, **fields):
    context.deliver("prius", **fields)
    context.advance(0.02)


def rolling(context, speed):
    context.link("chassis").twist = Twist((speed, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_the_hand_brake_holds_a_prius_until_the_pedal_is_pressed():
    context, _ = prius()
    context.advance(0.1)
    assert context.joints["fl"].motor == (0.0, pytest.approx(1000.0 - 80.0))
    assert context.joints["bl"].motor == (0.0, 600.0)
    control(context, throttle=0.5)
    for name in ("fl", "fr"):
        assert context.joints[name].motor == (pytest.approx(30.0 / 0.3), pytest.approx(400.0))
    assert context.joints["bl"].motor == (0.0, 0.0)
    context.advance(0.5)   # no command: it creeps
    assert context.joints["fl"].motor[1] == pytest.approx(80.0)


def test_a_prius_reverses_and_rolls_in_neutral():
    context, _ = prius()
    control(context, throttle=0.5, shift_gears=3)
    assert context.joints["fl"].motor == (pytest.approx(-30.0 / 0.3), pytest.approx(400.0))
    control(context, throttle=0.5, shift_gears=1)
    assert context.joints["fl"].motor == (0.0, 0.0)
    control(context, throttle=0.5)   # no change of gear
    assert context.joints["fl"].motor == (0.0, 0.0)


def test_a_prius_without_pedals_creeps_when_slow_and_brakes_a_little_when_fast():
    context, _ = prius()
    control(context, throttle=0.1)
    for speed, motor in ((3.5 * MPH, (100.0, 40.0)), (7.5 * MPH, (0.0, 12.5)),
                         (20.0 * MPH, (0.0, 25.0))):
        rolling(context, speed)
        context.advance(0.5)
        assert context.joints["fl"].motor == pytest.approx(motor)


def test_a_prius_steers_by_ackermann_with_servos():
    context, _ = prius()
    control(context, steer=0.5)
    tangent = math.tan(0.3)
    for name, side in (("sl", -1.0), ("sr", 1.0)):
        assert context.joints[name].servo.target == pytest.approx(
            math.atan2(tangent, 1.0 + side * 0.8 / 2.8 * tangent))
    assert context.joints["sl"].servo.gains.p == 1e4
    assert context.joints["hand"].servo.target == pytest.approx(0.5 * 7.85)
    context.advance(0.5)
    assert context.joints["sl"].servo.target == 0.0


def test_drag_slows_the_chassis_of_a_prius_and_a_reset_brakes_it():
    context, plugin = prius(chassis_aero_force_gain="0.5")
    control(context, throttle=1.0)
    rolling(context, 10.0)
    context.advance(0.01)
    assert context.wrenches["chassis"][0] == pytest.approx((-50.0, 0.0, 0.0))
    plugin.reset()
    assert context.joints["bl"].motor == (0.0, 600.0)


def test_a_prius_names_the_joint_that_is_missing():
    with pytest.raises(PluginError, match="nothing"):
        prius(steering_wheel="nothing")


AUDI = [f"{kind}_{place}_joint" for kind, places in (
    ("wheel", ("fl", "fr", "rl", "rr")), ("steer", ("fl", "fr"))) for place in places]
ROLLING = 0.25 * 0.01 * 1700.0 * 9.81


def audibot(inside=""):
    context = FakeContext(f"<plugin>{inside}</plugin>", joints=AUDI)
    return context, context.load(Audibot)


def audi_rolls(context, speed, yaw=0.0):
    link = context.link("base_footprint")
    link.pose = Pose((1.0, 2.0, 0.0), quat_from_rpy(0.0, 0.0, yaw))
    link.twist = Twist((speed * math.cos(yaw), speed * math.sin(yaw), 0.0), (0.0, 0.0, 0.1))


def test_an_audibot_accelerates_by_its_throttle_for_a_quarter_of_a_second():
    context, _ = audibot()
    audi_rolls(context, 10.0, yaw=1.0)
    context.deliver("throttle_cmd", data=0.5)
    context.advance(0.02)
    friction = ROLLING + 0.25 * 0.35 * 100.0 * 0.36
    assert context.joints["wheel_rl_joint"].motor == (
        FASTEST, pytest.approx(0.5 * (2000.0 - 401.0) - friction))
    assert context.joints["wheel_fl_joint"].motor == (0.0, pytest.approx(friction))
    context.advance(0.4)
    assert context.joints["wheel_rl_joint"].motor == (0.0, pytest.approx(friction))


def test_an_audibot_brakes_before_it_accelerates_and_has_a_reverse_gear():
    context, _ = audibot()
    context.deliver("throttle_cmd", data=1.0)
    context.deliver("brake_cmd", data=9999.0)
    context.advance(0.02)
    assert context.joints["wheel_rr_joint"].motor == (0.0, pytest.approx(ROLLING + 2000.0))
    context.deliver("brake_cmd", data=0.0)
    context.deliver("gear_cmd", data=1)
    context.advance(0.02)
    assert context.joints["wheel_rr_joint"].motor == (-FASTEST, pytest.approx(2000.0 - ROLLING))
    context.deliver("gear_cmd", data=7)
    assert any("no gear 7" in text for text in context.log_messages)


def test_an_audibot_that_rolled_over_stops_its_wheels():
    context, _ = audibot()
    context.deliver("throttle_cmd", data=1.0)
    context.advance(0.015)
    spinning = context.joints["wheel_rl_joint"]
    assert spinning.velocity == FASTEST
    context.link("base_footprint").pose = Pose(orientation=quat_from_rpy(1.0, 0.0, 0.0))
    context.advance(0.01)
    assert spinning.motor == (0.0, 1000.0 * FASTEST)


def test_an_audibot_turns_its_wheels_at_a_limited_rate_and_reports_its_motion():
    context, _ = audibot("<robotName>audi</robotName>")
    audi_rolls(context, 3.0, yaw=0.5)
    context.deliver("audi/steering_cmd", data=3.46)
    context.advance(0.1)
    rate = math.radians(800.0) / 17.3
    state = context.published["audi/steering_state"][-1].data / 17.3
    assert 0.02 < state <= 0.1 * rate + 1e-9
    context.advance(1.0)
    tangent = math.tan(0.2)
    for place, side in (("fl", -1.0), ("fr", 1.0)):
        assert context.joints[f"steer_{place}_joint"].servo.target == pytest.approx(math.atan(
            2.65 * tangent / (2.65 + side * 0.819 * tangent)))
    odom, twist = (context.published[f"audi/{topic}"][-1] for topic in ("odom", "twist"))
    assert odom.header.frame_id == twist.header.frame_id == "audi/base_footprint"
    assert (odom.pose.pose.position.x, odom.pose.pose.position.y) == (1.0, 2.0)
    assert (twist.twist.linear.x, twist.twist.angular.z) == pytest.approx((3.0, 0.1))


def test_a_catvehicle_reports_its_velocity_its_steering_and_its_place():
    joints = ("front_left_steering_joint", "front_right_steering_joint")
    context = FakeContext("<plugin><robotNamespace>/cat</robotNamespace><updateRate>50"
                          "</updateRate></plugin>", joints=joints)
    context.pose = Pose((4.0, 5.0, 0.0), quat_from_rpy(0.0, 0.0, math.pi / 2.0))
    context.twist = Twist((0.0, 2.0, 0.0), (0.0, 0.0, 0.3))
    CatVehicle(context).load()
    for name, angle in zip(joints, (0.3, 0.2)):
        context.joints[name].position = angle
    context.advance(0.1)
    velocity, steering, odom = (context.published[f"cat/{topic}"][-1]
                                for topic in ("vel", "steering", "odom"))
    assert (velocity.linear.x, velocity.linear.y, velocity.angular.z) == pytest.approx(
        (2.0, 0.0, 0.3), abs=1e-12)
    assert steering.torque.z == pytest.approx(0.25)
    assert (odom.header.frame_id, odom.child_frame_id) == ("cat/odom", "cat/base_link")
    assert (odom.pose.pose.position.y, odom.twist.twist.linear.y) == (5.0, 2.0)
