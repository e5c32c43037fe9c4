"""Drives in a world without physics: what they order, what they publish."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.model import Joint, Link
from my_simulations.description.shapes import Collision, Cylinder
from my_simulations.geometry import Pose, Twist, quat_from_rpy, rpy_from_quat
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.drive.diff_drive import DiffDrive
from my_simulations.plugins.drive.force_based_move import (
    ForceBasedMove,
    NexusForceBasedMove,
    RidgebackForceBasedMove,
    RobotnikForceBasedMove,
    WprForceBasedMove,
)
from my_simulations.plugins.drive.limo_ackermann import LimoAckermann
from my_simulations.plugins.drive.planar_move import PlanarMove
from my_simulations.plugins.drive.skid_steer_drive import SkidSteerDrive
from my_simulations.plugins.drive.tricycle_drive import TricycleDrive
from my_simulations.plugins.drive.wheel_slip import WheelSlip
from my_simulations.plugins.testing import FakeContext

WHEELS = ("left_joint", "right_joint")


def diff_drive(inside="", **options):
    context = FakeContext(f"<plugin>{inside}</plugin>", joints=WHEELS, **options)
    return context, context.load(DiffDrive)


def test_a_command_becomes_wheel_speeds_with_the_defaults_of_the_original():
    context, _ = diff_drive()
    context.deliver("robot/cmd_vel", linear={"x": 0.3}, angular={"z": 1.0})
    context.advance(0.01)
    left, right = (context.joints[name].motor for name in WHEELS)
    assert left == pytest.approx(((0.3 - 0.17) / 0.075, 5.0))
    assert right == pytest.approx(((0.3 + 0.17) / 0.075, 5.0))


def test_legacy_mode_does_not_exchange_the_wheels_as_in_noetic():
    context, _ = diff_drive("<legacyMode>true</legacyMode>"
                            "<odometrySource>encoder</odometrySource>")
    context.deliver("robot/cmd_vel", linear={"x": 0.0}, angular={"z": 1.0})
    context.advance(0.5)
    left, right = (context.joints[name].motor[0] for name in WHEELS)
    assert left == -right < 0.0
    assert context.published["robot/odom"][-1].twist.twist.angular.z == pytest.approx(1.0)


def test_it_publishes_at_its_rate_under_the_models_name():
    context, _ = diff_drive("<updateRate>20</updateRate>")
    context.advance(1.0)
    assert len(context.published["robot/odom"]) == 20
    assert [one.header.stamp.to_sec() for one in context.published["robot/odom"]][:2] == [0.05, 0.1]
    assert {pair[:2] for pair in context.transforms} == {("odom", "base_footprint")}


def test_encoder_odometry_of_a_circle_is_the_circle():
    context, _ = diff_drive("<odometrySource>encoder</odometrySource>")
    context.deliver("robot/cmd_vel", linear={"x": 0.5}, angular={"z": math.pi / 2})
    context.advance(1.01)  # the first command acts from the first appointment on
    odom = context.published["robot/odom"][-1]
    radius = 0.5 / (math.pi / 2)
    assert odom.pose.pose.position.x == pytest.approx(radius, abs=1e-4)
    assert odom.pose.pose.position.y == pytest.approx(radius, abs=1e-4)
    assert (odom.twist.twist.linear.x, odom.twist.twist.angular.z) == pytest.approx(
        (0.5, math.pi / 2))
    assert odom.pose.covariance[::7] == [1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3]


def test_wheels_that_are_put_somewhere_are_no_way_that_was_driven():
    """Gazebo's drive integrates the rates of its wheels."""
    context, _ = diff_drive("<odometrySource>encoder</odometrySource>")
    context.deliver("robot/cmd_vel", linear={"x": 0.5}, angular={"z": 0.0})
    context.advance(1.01)
    for name in WHEELS:
        context.joints[name].put(100.0)
    context.advance(1.0)
    odom = context.published["robot/odom"]
    assert odom[-1].pose.pose.position.x == pytest.approx(1.0, abs=1e-4)
    assert max(one.twist.twist.linear.x for one in odom) == pytest.approx(0.5)


def test_backwards_is_negative():
    context, _ = diff_drive("<odometrySource>encoder</odometrySource>")
    context.deliver("robot/cmd_vel", linear={"x": -0.2}, angular={"z": 0.0})
    context.advance(0.5)
    assert context.published["robot/odom"][-1].twist.twist.linear.x == pytest.approx(-0.2)


def test_odometry_of_the_world_turns_velocities_into_the_base():
    context, _ = diff_drive()
    context.pose = Pose((1.0, 2.0, 0.1), quat_from_rpy(0, 0, math.pi / 2))
    context.twist = Twist((0.0, 0.4, 0.0), (0.0, 0.0, 0.3))
    context.advance(0.01)
    odom = context.published["robot/odom"][-1]
    assert odom.pose.pose.position.y == 2.0
    assert (odom.twist.twist.linear.x, odom.twist.twist.linear.y,
            odom.twist.twist.angular.z) == pytest.approx((0.4, 0.0, 0.3))


def test_wheels_accelerate_no_faster_than_they_may():
    context, _ = diff_drive("<wheelAcceleration>0.5</wheelAcceleration>")
    context.deliver("robot/cmd_vel", linear={"x": 1.0}, angular={"z": 0.0})
    context.advance(0.1)
    assert context.joints["left_joint"].motor[0] * 0.075 == pytest.approx(0.05)


def test_without_publish_tf_there_is_neither_odometry_nor_tf():
    context, _ = diff_drive("<publishTf>false</publishTf>")
    context.advance(0.1)
    assert not context.published and not context.transforms


def test_flags_add_wheel_frames_and_joint_states():
    context, _ = diff_drive("<publishWheelTF>1</publishWheelTF><publishWheelJointState>true"
                            "</publishWheelJointState><publishOdomTF>false</publishOdomTF>")
    context.advance(0.01)
    assert [pair[:2] for pair in context.transforms] == [
        ("base", "left_joint"), ("base", "right_joint")]
    assert context.published["robot/joint_states"][0].name == list(WHEELS)


def test_namespace_prefix_and_topics_are_those_of_the_file():
    context = FakeContext("<plugin><robotNamespace>/r1</robotNamespace>"
                          "<commandTopic>/go</commandTopic></plugin>", joints=WHEELS)
    context.ros_parameters["tf_prefix"] = "/r1"
    DiffDrive(context).load()
    context.deliver("/go", linear={"x": 0.1}, angular={"z": 0.0})
    context.advance(0.01)
    assert context.published["r1/odom"][0].child_frame_id == "r1/base_footprint"


def test_a_reset_stands_still_and_counts_from_there():
    context, plugin = diff_drive("<odometrySource>encoder</odometrySource>")
    context.deliver("robot/cmd_vel", linear={"x": 0.5}, angular={"z": 0.0})
    context.advance(0.5)
    plugin.reset()
    assert context.joints["left_joint"].motor[0] == 0.0
    context.advance(0.1)
    assert context.published["robot/odom"][-1].pose.pose.position.x == 0.0


def test_a_joint_that_is_not_there_is_named():
    with pytest.raises(PluginError, match="right_joint"):
        DiffDrive(FakeContext(joints=("left_joint",))).load()


def test_a_value_that_is_no_number_is_told_and_the_default_used():
    context, plugin = diff_drive("<wheelDiameter>big</wheelDiameter>")
    assert "wheelDiameter" in context.log_messages[0] and plugin._radius == 0.075


def test_skid_steering_drives_both_wheels_of_a_side_alike():
    corners = ("left_front_joint", "right_front_joint", "left_rear_joint", "right_rear_joint")
    context = FakeContext(joints=corners)
    SkidSteerDrive(context).load()
    context.deliver("cmd_vel", linear={"x": 0.2}, angular={"z": 1.0})
    context.advance(0.01)
    speeds = [context.joints[name].motor[0] * 0.075 for name in corners]
    assert speeds == pytest.approx([0.0, 0.4, 0.0, 0.4])
    assert not context.transforms  # broadcastTF is false by default
    assert context.published["odom"][0].pose.covariance[::7] == [1e-4, 1e-4, 1e12, 1e12, 1e12,
                                                                 1e-2]


@pytest.mark.parametrize("seconds", [0.1, 0.3, 1.001])
def test_planar_move_applies_a_command_to_the_last_step_of_its_time(seconds):
    context = FakeContext(f"<plugin><cmdTimeout>{seconds}</cmdTimeout></plugin>")
    PlanarMove(context).load()
    context.deliver("cmd_vel", linear={"x": 0.2, "y": 0.1}, angular={"z": 0.5})
    context.advance(seconds)
    assert context.level == (0.2, 0.1, 0.5)
    context.advance(0.001)
    assert context.level == (0.0, 0.0, 0.0)


def test_a_command_is_forgotten_also_when_the_clock_is_set_back():
    context = FakeContext("<plugin><cmdTimeout>0.1</cmdTimeout></plugin>")
    plugin = context.load(PlanarMove)
    context.advance(60.0)
    context.deliver("cmd_vel", linear={"x": 0.2, "y": 0.1}, angular={"z": 0.5})
    context.step = 0
    plugin.clock_set()
    context.advance(0.05)
    assert context.level == (0.2, 0.1, 0.5)
    context.advance(0.2)
    assert context.level == (0.0, 0.0, 0.0)


def test_planar_move_tells_the_velocity_since_the_last_message():
    context = FakeContext("<plugin><odometryRate>10</odometryRate></plugin>")
    PlanarMove(context).load()
    context.advance(0.099)
    context.pose = Pose((0.02, 0.0, 0.3), quat_from_rpy(0, 0, 0.0))
    context.advance(0.001)
    odom = context.published["odom"][-1]
    assert odom.twist.twist.linear.x == pytest.approx(0.2)
    assert rpy_from_quat(context.transforms[-1][2].orientation)[2] == 0.0


TRICYCLE = ("front_steering_joint", "front_wheel_joint", "left_wheel_joint", "right_wheel_joint")


def tricycle(inside=""):
    context = FakeContext(f"<plugin>{inside}</plugin>", joints=TRICYCLE)
    return context, context.load(TricycleDrive)


def test_a_tricycle_drives_and_steers_its_front_wheel():
    context, _ = tricycle()
    context.deliver("robot/cmd_vel", linear={"x": 0.3}, angular={"z": 0.5})
    context.advance(0.01)
    assert context.joints["front_wheel_joint"].motor == pytest.approx((4.0, 5.0))
    assert context.joints["front_steering_joint"].position == 0.5
    context.deliver("robot/cmd_vel", linear={"x": 0.0}, angular={"z": -2.0})
    context.advance(0.01)
    assert context.joints["front_steering_joint"].position == pytest.approx(-math.pi / 2)


def test_a_tricycle_steers_no_faster_than_it_may_and_stops_at_the_angle():
    context, _ = tricycle("<steeringSpeed>0.4</steeringSpeed>")
    context.deliver("robot/cmd_vel", linear={"x": 0.0}, angular={"z": 0.2})
    context.advance(0.26)
    assert context.joints["front_steering_joint"].position == pytest.approx(0.1)
    context.advance(0.4)
    assert context.joints["front_steering_joint"].position == pytest.approx(0.2, abs=0.01)
    assert context.joints["front_steering_joint"].velocity == pytest.approx(0.0, abs=0.01)


def test_a_tricycle_goes_on_in_the_step_of_a_reset():
    context, plugin = tricycle("<steeringSpeed>0.4</steeringSpeed>")
    context.deliver("robot/cmd_vel", linear={"x": 0.0}, angular={"z": 0.5})
    context.advance(0.5)
    plugin.reset()  # joints keep their angles here
    context.advance(1.3)
    assert context.joints["front_steering_joint"].position == pytest.approx(0.0, abs=0.01)


def test_a_tricycle_accelerates_and_brakes_as_it_is_told():
    context, _ = tricycle("<wheelAcceleration>2</wheelAcceleration>"
                          "<wheelDeceleration>4</wheelDeceleration>")
    wheel = context.joints["front_wheel_joint"]
    context.deliver("robot/cmd_vel", linear={"x": 0.75}, angular={"z": 0.0})
    context.advance(0.5)
    assert wheel.motor[0] == pytest.approx(1.0, abs=0.03)
    context.advance(5.0)
    assert wheel.motor[0] == pytest.approx(10.0)
    context.deliver("robot/cmd_vel", linear={"x": 0.0}, angular={"z": 0.0})
    context.advance(0.5)
    assert wheel.motor[0] == pytest.approx(8.0, abs=0.05)


def test_a_tricycle_counts_a_turn_to_the_left_as_one():
    context, _ = tricycle("<odometrySource>encoder</odometrySource>"
                          "<publishWheelJointState>1</publishWheelJointState>"
                          "<publishWheelTF>1</publishWheelTF>")
    context.joints["right_wheel_joint"].motor = (1.0, 1.0)
    context.advance(1.0)
    odom = context.published["robot/odom"][-1]
    assert 2.0 * math.asin(odom.pose.pose.orientation.z) == pytest.approx(0.15)
    assert odom.child_frame_id == "base_link"
    states = context.published["robot/joint_states"][-1]
    assert states.name == list(TRICYCLE) and states.velocity[3] == 1.0
    assert ("base", "front_wheel_joint") in {pair[:2] for pair in context.transforms}


def test_forces_move_a_base_as_it_is_told():
    context = FakeContext("<plugin><yaw_velocity_p_gain>10</yaw_velocity_p_gain></plugin>",
                          links=("base_footprint",))
    context.description.links.append(Link("base_footprint"))
    ForceBasedMove(context).load()
    context.links["base_footprint"].pose = Pose((0, 0, 0), quat_from_rpy(0, 0, math.pi / 2))
    context.links["base_footprint"].twist = Twist((0.0, 0.1, 0.0), (0.0, 0.0, 0.2))
    context.deliver("cmd_vel", linear={"x": 0.3, "y": 0.0}, angular={"z": 0.5})
    context.advance(0.001)
    force, torque = context.wrenches["base_footprint"]
    assert force == pytest.approx((0.0, 2000.0, 0.0)) and torque == pytest.approx((0, 0, 3.0))
    context.advance(10.0)  # a command holds for ever
    assert context.wrenches["base_footprint"][0] == pytest.approx((0.0, 2000.0, 0.0))


def moved_by_forces(library, inside=""):
    context = FakeContext(f"<plugin>{inside}</plugin>", links=("base_footprint",))
    context.description.links.append(Link("base_footprint"))
    library(context).load()
    return context


@pytest.mark.parametrize("library, inside, seconds", [
    (ForceBasedMove, "<commandTimeoutDuration>0.3</commandTimeoutDuration>", 0.3),
    (RobotnikForceBasedMove, "", 2.0),
    (RobotnikForceBasedMove, "<commandWatchdog>0.5</commandWatchdog>", 0.5),
    (RidgebackForceBasedMove, "", 0.25),
    (RidgebackForceBasedMove, "<cmdVelTimeOut>0.2</cmdVelTimeOut>", 0.2),
])
def test_a_base_moved_by_forces_stops_after_the_time_of_its_library(library, inside, seconds):
    context = moved_by_forces(library, inside)
    context.deliver("cmd_vel", linear={"x": 0.3, "y": 0.0}, angular={"z": 0.0})
    context.advance(seconds)
    assert context.wrenches["base_footprint"][0] == pytest.approx((3000.0, 0.0, 0.0))
    context.advance(0.001)
    assert context.wrenches["base_footprint"][0] == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize("library, element", [
    (RobotnikForceBasedMove, "commandWatchdog"), (RidgebackForceBasedMove, "cmdVelTimeOut")])
def test_a_watchdog_of_no_time_lets_a_robot_stand(library, element):
    """In both originals no value switches it off; hector's 0 does."""
    for seconds in (0.0, -1.0):
        context = moved_by_forces(library, f"<{element}>{seconds}</{element}>")
        context.deliver("cmd_vel", linear={"x": 0.3, "y": 0.0}, angular={"z": 0.0})
        context.advance(0.002)
        assert context.wrenches["base_footprint"][0] == pytest.approx((0.0, 0.0, 0.0))
    context = moved_by_forces(
        ForceBasedMove, "<commandTimeoutDuration>0</commandTimeoutDuration>")
    context.deliver("cmd_vel", linear={"x": 0.3, "y": 0.0}, angular={"z": 0.0})
    context.advance(30.0)
    assert context.wrenches["base_footprint"][0] == pytest.approx((3000.0, 0.0, 0.0))


def test_the_commands_of_nexus_have_upper_limits():
    context = moved_by_forces(NexusForceBasedMove, "<max_x_velocity>0.5</max_x_velocity>")
    for x, yaw, force, torque in ((0.8, 0.7, 7.5, 0.5), (0.2, 0.3, 3.0, 0.3),
                                  (-0.8, -0.7, -12.0, -0.7)):
        context.deliver("cmd_vel", linear={"x": x, "y": 0.9}, angular={"z": yaw})
        context.advance(0.001)
        found = context.wrenches["base_footprint"]
        assert found[0] == pytest.approx((force, 7.5, 0.0))
        assert found[1] == pytest.approx((0.0, 0.0, torque))


def test_a_base_moved_by_forces_goes_sideways_unless_it_must_not():
    for inside, force in (("", 3000.0),
                          ("<allowLateralMotion>false</allowLateralMotion>", 0.0)):
        context = moved_by_forces(ForceBasedMove, inside)
        context.deliver("cmd_vel", linear={"x": 0.0, "y": 0.3}, angular={"z": 0.0})
        context.advance(0.1)
        assert context.wrenches["base_footprint"][0] == pytest.approx((0.0, force, 0.0))


def test_the_base_of_wpr_simulation_has_gains_of_its_own_and_keeps_its_command():
    context = moved_by_forces(WprForceBasedMove)
    context.deliver("cmd_vel", linear={"x": 0.2, "y": 0.1}, angular={"z": 0.5})
    context.advance(10.0)
    force, torque = context.wrenches["base_footprint"]
    assert force == pytest.approx((8000.0, 3000.0, 0.0))
    assert torque == pytest.approx((0.0, 0.0, 250.0))
    assert context.published["odom"]


def test_forces_push_the_base_of_a_nested_model_and_not_the_first_link():
    context = FakeContext("<plugin/>", links=("frame", "base_footprint"))
    context.description.links += [Link("frame"), Link("inner::base_footprint")]
    ForceBasedMove(context).load()
    context.advance(0.001)
    assert list(context.wrenches) == ["base_footprint"]


def test_a_base_moved_by_forces_trusts_its_yaw_while_it_does_not_turn():
    context = moved_by_forces(ForceBasedMove)
    context.advance(0.1)
    context.twist = Twist((0.0, 0.0, 0.0), (0.0, 0.0, 0.2))
    context.advance(0.1)
    still, turning = context.published["odom"][1], context.published["odom"][-1]
    for message, yaw in ((still, 0.01), (turning, 100.0)):
        assert message.pose.covariance[::7] == [1e-3, 1e-3, 1e12, 1e12, 1e12, yaw]
        assert message.twist.covariance[::7] == [1e-3, 1e-3, 1e-3, 1e12, 1e12, yaw]


def test_a_tricycle_whose_wheels_have_the_names_of_the_other_side_counts_a_left_turn_as_one():
    context = FakeContext("<plugin><odometrySource>encoder</odometrySource></plugin>",
                          joints=TRICYCLE)
    context.link("right_wheel_joint").pose = Pose((0.0, 0.25, 0.0))
    TricycleDrive(context).load()
    context.joints["left_wheel_joint"].motor = (1.0, 1.0)
    context.advance(1.0)
    odom = context.published["robot/odom"][-1]
    assert odom.twist.twist.angular.z == pytest.approx(0.15)


def slipping(inside):
    context = FakeContext(f"<plugin>{inside}</plugin>", joints=("axle", "other"))
    context.description.links.append(Link("rear", collisions=[Collision("c", Cylinder(0.3, 0.1))]))
    context.description.joints.append(Joint("axle", "revolute", "base", "rear"))
    context.description.links.append(Link("twin", collisions=[
        Collision(name, Cylinder(0.3, 0.1)) for name in "ab"]))
    context.description.joints.append(Joint("other", "revolute", "base", "twin"))
    WheelSlip(context).load()
    return context.slips


def test_a_wheel_slips_by_its_compliances_and_the_radius_of_its_collision():
    force = "<wheel_normal_force>77</wheel_normal_force>"
    assert slipping(f'<wheel link_name="rear"><slip_compliance_lateral>1</slip_compliance_lateral>'
                    f"<slip_compliance_longitudinal>2</slip_compliance_longitudinal>{force}"
                    "</wheel>") == {"rear": ("axle", 0.3, 77.0, 1.0, 2.0)}
    assert slipping(f'<wheel link_name="rear">{force}<wheel_radius>0.25</wheel_radius>'
                    "</wheel>") == {"rear": ("axle", 0.25, 77.0, 0.0, 0.0)}
    with pytest.raises(PluginError, match="none of its"):
        slipping('<wheel link_name="rear"/>')


@pytest.mark.parametrize("bad", [
    '<wheel link_name="none"><wheel_normal_force>77</wheel_normal_force></wheel>',
    '<wheel link_name="rear"><wheel_normal_force>0</wheel_normal_force></wheel>',
    '<wheel link_name="twin"><wheel_normal_force>77</wheel_normal_force></wheel>',
    "<wheel><wheel_normal_force>77</wheel_normal_force></wheel>"])
def test_a_wheel_that_cannot_slip_leaves_the_others_slipping(bad):
    """Gazebo logs an error and continues; a wheel must have one collision and one joint."""
    good = '<wheel link_name="rear"><wheel_normal_force>77</wheel_normal_force></wheel>'
    for both in (bad + good, good + bad):
        assert slipping(both) == {"rear": ("axle", 0.3, 77.0, 0.0, 0.0)}


# -- a car with four driven wheels ---------------------------------------------------------------

CAR = ("left_front_joint", "right_front_joint", "left_rear_joint", "right_rear_joint")


@pytest.mark.parametrize("speed, yaw", [(0.5, 0.4), (-0.5, 0.4), (0.4, -0.8), (0.5, 0.0)])
def test_all_wheels_of_a_limo_roll_about_one_centre(speed, yaw):
    context = FakeContext("<plugin><wheelDiameter>0.09</wheelDiameter></plugin>", joints=CAR)
    LimoAckermann(context).load()
    context.deliver("cmd_vel", linear={"x": speed}, angular={"z": yaw})
    context.advance(0.02)
    angles = [context.published[f"limo_{side}_steering_hinge_controller/command"][-1].data
              for side in ("fl", "fr")]
    # Steering turns with the yaw rate; backwards, the robot turns the other way.
    turn = yaw if speed >= 0.0 else -yaw
    for y, front, rear, angle in zip((0.086, -0.086), CAR[:2], CAR[2:], angles):
        assert context.joints[rear].motor[0] * 0.045 == pytest.approx(speed - turn * y)
        rim = context.joints[front].motor[0] * 0.045
        assert (rim * math.cos(angle), rim * math.sin(angle)) == pytest.approx(
            (speed - turn * y, turn * 0.2))


def test_a_limo_steers_no_further_than_it_can():
    context = FakeContext("<plugin/>", joints=CAR)
    LimoAckermann(context).load()
    context.deliver("cmd_vel", linear={"x": 0.1}, angular={"z": 9.0})
    context.advance(0.02)
    left = context.published["limo_fl_steering_hinge_controller/command"][-1].data
    assert left == pytest.approx(math.radians(30.0))
    context.deliver("cmd_vel", linear={"x": 0.0}, angular={"z": 9.0})
    context.advance(0.02)
    assert context.published["limo_fl_steering_hinge_controller/command"][-1].data == 0.0
    assert context.joints["left_rear_joint"].motor[0] == 0.0
