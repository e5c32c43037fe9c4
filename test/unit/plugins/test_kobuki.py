"""The base of TurtleBot 2 in a world without physics."""
from __future__ import annotations

import math

import numpy as np
import pytest
from planar_pose import planar_pose, yaw_of
from robot_control import hide_package

from my_simulations.description.sensor import Imu, Ray, Sensor
from my_simulations.engine.commands import Contact
from my_simulations.geometry import Pose, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.drive.kobuki import Kobuki
from my_simulations.plugins.testing import FakeContext
from my_simulations.sensing.api import RayReturns

WHEELS = ("wheel_left_joint", "wheel_right_joint")
NAMES = {"robotNamespace": "/",
         "left_wheel_joint_name": WHEELS[0], "right_wheel_joint_name": WHEELS[1],
         "wheel_separation": "0.23", "wheel_diameter": "0.07", "torque": "18",
         "velocity_command_timeout": "0.6", "imu_name": "imu", "bumper_name": "bumpers",
         "cliff_sensor_left_name": "cliff_l", "cliff_sensor_center_name": "cliff_c",
         "cliff_sensor_right_name": "cliff_r", "cliff_detection_threshold": "0.04",
         "wheel_drop_left_sensor_name": "drop_l", "wheel_drop_right_sensor_name": "drop_r"}
SENSORS = [("base_footprint", Sensor("imu", "imu", imu=Imu())),
           ("base_footprint", Sensor("bumpers", "contact")),
           ("wheel_left", Sensor("drop_l", "contact")),
           ("wheel_right", Sensor("drop_r", "contact")),
           *(("base_footprint", Sensor(f"cliff_{side}", "ray", ray=Ray())) for side in "lcr")]


def kobuki(**more):
    inside = "".join(f"<{name}>{value}</{name}>" for name, value in {**NAMES, **more}.items())
    context = FakeContext(f"<plugin>{inside}</plugin>", joints=WHEELS)
    context.model_sensors = list(SENSORS)
    below(context, 0.02)
    plugin = Kobuki(context)
    return context, plugin


def below(context, *distances):
    context.returns = RayReturns(np.array(distances), np.zeros(1, np.float32),
                                 np.zeros(1, np.int32))


def started(**more):
    context, plugin = kobuki(**more)
    plugin.load()
    return context


def rates(context):
    return tuple(context.joints[name].motor[0] for name in WHEELS)


def test_wheels_turn_until_the_command_is_too_old():
    context = started()
    context.deliver("mobile_base/commands/velocity", linear={"x": 0.2}, angular={"z": 1.0})
    context.advance(0.1)
    assert rates(context) == pytest.approx(((0.2 - 0.115) / 0.035, (0.2 + 0.115) / 0.035))
    context.advance(0.7)
    assert rates(context) == (0.0, 0.0)


def test_a_kobuki_without_a_namespace_is_in_that_of_its_model():
    context = started(robotNamespace="")
    context.advance(0.02)
    assert {"robot/odom", "robot/joint_states"} <= set(context.published)
    assert "robot/mobile_base/sensors/imu_data" in context.published


def test_the_imu_of_a_kobuki_tells_its_turn_from_where_it_was_loaded():
    context, plugin = kobuki()
    base = context.link("base_footprint")
    base.pose = Pose(orientation=quat_from_rpy(0.0, 0.0, 1.0))
    plugin.load()
    context.advance(0.02)
    base.pose = Pose(orientation=quat_from_rpy(0.0, 0.0, 1.5))
    context.advance(0.02)
    yaws = [yaw_of(one.orientation) for one in context.published["mobile_base/sensors/imu_data"]]
    assert yaws == pytest.approx([0.0, 0.5])


def test_the_wheels_of_a_kobuki_are_told_in_the_frame_of_its_base():
    context = started()
    context.advance(0.02)
    assert context.published["joint_states"][0].header.frame_id == "base_link"


def test_a_cliff_event_has_the_reading_of_its_distance():
    context = started()
    context.advance(0.02)
    below(context, 0.5)
    context.advance(0.02)
    told = context.published["mobile_base/events/cliff"]
    assert [one.bottom for one in told] == [int(76123.0 * math.atan2(0.995, 0.5)) - 65536] * 3


def test_motors_that_are_off_stand():
    context = started()
    context.deliver("mobile_base/commands/motor_power", state=0)
    context.deliver("mobile_base/commands/velocity", linear={"x": 0.2}, angular={"z": 0.0})
    context.advance(0.1)
    assert rates(context) == (0.0, 0.0)
    context.deliver("mobile_base/commands/motor_power", state=1)
    context.advance(0.1)
    assert rates(context)[0] > 0.0


def test_wheels_of_a_kobuki_that_are_put_somewhere_move_no_odometry():
    context = started()
    context.deliver("mobile_base/commands/velocity", linear={"x": 0.2}, angular={"z": 0.0})
    context.advance(0.5)
    for name in WHEELS:
        context.joints[name].put(context.joints[name].position - 50.0)
    context.advance(0.1)
    assert context.published["odom"][-1].pose.pose.position.x == pytest.approx(0.2 * 0.58)


def test_the_odometry_takes_the_way_from_wheels_and_the_heading_from_the_gyroscope():
    context = started(publish_tf="1")
    for step in range(1, 101):
        context.deliver("mobile_base/commands/velocity", linear={"x": 0.2}, angular={"z": 0.0})
        context.link("base_footprint").pose = Pose(
            orientation=quat_from_rpy(0.0, 0.0, step * 0.02))
        context.advance(0.02)
    odom = context.published["odom"][-1]
    x, y, yaw = planar_pose(odom.pose.pose)
    assert yaw == pytest.approx(2.0)
    radius = 0.2 / 1.0
    assert (x, y) == pytest.approx(
        (radius * math.sin(2.0), radius * (1.0 - math.cos(2.0))), abs=0.005)
    assert odom.twist.twist.angular.z == pytest.approx(1.0)
    assert {one[:2] for one in context.transforms} == {("odom", "base_footprint")}
    context.deliver("mobile_base/commands/reset_odometry")
    context.advance(0.02)
    assert context.published["odom"][-1].pose.pose.position.x == pytest.approx(0.004)


def events(context, name, field):
    return [(getattr(one, field), one.state)
            for one in context.published[f"mobile_base/events/{name}"]]


def touch(angle, height=0.05):
    """A contact from a direction in the robot's frame."""
    return ("robot::base_footprint", "wall::link",
            Contact(1, 2, (0.2, 0.0, height), (-math.cos(angle), -math.sin(angle), 0.0), 0.0, 5.0))


@pytest.mark.parametrize("angle, bumper", [(0.0, 1), (0.9, 0), (-0.9, 2)])
def test_a_bumper_is_pressed_on_the_side_of_the_contact_and_released(angle, bumper):
    context = started()
    context.touching = [touch(angle)]
    context.advance(0.04)
    assert events(context, "bumper", "bumper") == [(bumper, 1)]
    context.touching = [touch(angle, height=0.5), touch(3.0)]   # too high; from behind
    context.advance(0.04)
    assert events(context, "bumper", "bumper") == [(bumper, 1), (bumper, 0)]


def test_what_is_not_below_is_a_cliff():
    context = started()
    context.advance(0.1)
    assert events(context, "cliff", "sensor") == []
    below(context, math.inf)
    context.advance(0.1)
    assert events(context, "cliff", "sensor") == [(0, 1), (1, 1), (2, 1)]
    assert context.published["mobile_base/sensors/core"][-1].cliff == 7
    below(context, 0.02)
    context.advance(0.1)
    assert events(context, "cliff", "sensor")[3:] == [(0, 0), (1, 0), (2, 0)]


def test_a_wheel_that_touches_nothing_has_dropped():
    context = started()
    context.touching = [("robot::wheel_left", "ground::link",
                         Contact(1, 2, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0, 5.0))]
    context.advance(0.04)
    assert events(context, "wheel_drop", "wheel") == [(1, 1)]
    assert context.published["mobile_base/sensors/core"][-1].wheel_drop == 1


def test_without_kobuki_msgs_it_drives():
    context, plugin = kobuki()
    hide_package(context, "kobuki_msgs")
    plugin.load()
    assert "kobuki_msgs" in context.log_messages[-1]
    context.deliver("mobile_base/commands/velocity", linear={"x": 0.2}, angular={"z": 0.0})
    context.advance(0.1)
    assert rates(context)[0] > 0.0


def test_a_parameter_that_is_missing_is_told():
    _, plugin = kobuki(imu_name="")
    with pytest.raises(PluginError, match="imu_name"):
        plugin.load()
