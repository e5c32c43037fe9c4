"""The base of the first TurtleBot in a world without physics."""
from __future__ import annotations

import math

import numpy as np
import pytest
from planar_pose import planar_pose

from my_simulations.description.sensor import Ray, Sensor
from my_simulations.engine.commands import Contact
from my_simulations.geometry import Pose, quat_from_rpy
from my_simulations.plugins.drive.create import Create
from my_simulations.plugins.testing import FakeContext
from my_simulations.sensing.api import RayReturns

WHEELS = ("left_wheel_joint", "right_wheel_joint")
RAYS = ("wall_sensor", "left_cliff_sensor", "leftfront_cliff_sensor", "rightfront_cliff_sensor",
        "right_cliff_sensor")


def create(distance=0.015, sensors=RAYS, inside=""):
    context = FakeContext("<plugin><node_namespace>turtlebot_node</node_namespace>"
                          "<wheel_separation>0.26</wheel_separation>"
                          "<wheel_diameter>0.066</wheel_diameter><torque>1</torque>"
                          f"<updateRate>40</updateRate>{inside}</plugin>", joints=WHEELS)
    context.model_sensors = [("base", Sensor(name, "ray", ray=Ray())) for name in sensors]
    seen(context, distance)
    Create(context).load()
    return context


def seen(context, distance):
    context.returns = RayReturns(np.array([distance]), np.zeros(1, np.float32),
                                 np.zeros(1, np.int32))


def test_wheels_follow_a_command_for_0_6_s_and_odometry_counts_them():
    context = create()
    context.deliver("turtlebot_node/cmd_vel", linear={"x": 0.1}, angular={"z": 1.0})
    context.advance(0.5)
    assert [context.joints[name].motor for name in WHEELS] == [
        (pytest.approx((0.1 - 0.13) / 0.033), 1.0), (pytest.approx((0.1 + 0.13) / 0.033), 1.0)]
    odom = context.published["/odom"][-1]
    assert (odom.header.frame_id, odom.child_frame_id) == ("odom", "base_footprint")
    assert odom.twist.twist.linear.x == pytest.approx(0.1)
    x, _, yaw = planar_pose(odom.pose.pose)
    assert x == pytest.approx(0.1 * math.sin(yaw), rel=1e-3)
    assert context.published["/joint_states"][-1].name == list(WHEELS)
    context.advance(0.3)
    assert context.joints[WHEELS[0]].motor == (0.0, 1.0)


def test_rays_report_the_floor_a_cliff_and_a_wall():
    context = create(0.015)
    context.advance(0.1)
    state = context.published["turtlebot_node/sensor_state"][-1]
    assert state.wall and not (state.cliff_left or state.cliff_front_right)
    seen(context, math.inf)
    context.advance(0.1)
    state = context.published["turtlebot_node/sensor_state"][-1]
    assert not state.wall and state.cliff_left and state.cliff_front_left \
        and state.cliff_front_right and state.cliff_right


@pytest.mark.parametrize(("point", "bits"), [
    ((0.16, 0.0, 0.03), 3), ((0.12, 0.1, 0.03), 2), ((0.12, -0.1, 0.03), 1),
    ((-0.16, 0.0, 0.03), 0), ((0.16, 0.0, 0.2), 0)])
def test_the_bumper_is_pressed_where_it_is_hit_in_the_base(point, bits):
    context = create()
    base = context.link("base")
    base.pose = Pose((3.0, 1.0, 0.0), quat_from_rpy(0.0, 0.0, math.pi / 2.0))
    x, y, z = point
    context.touching = [("robot::base", "wall::link", Contact(
        1, 2, (3.0 - y, 1.0 + x, z), (-1.0, 0.0, 0.0), 0.0, 5.0))]
    context.advance(0.1)
    assert context.published["turtlebot_node/sensor_state"][-1].bumps_wheeldrops == bits


def test_without_its_sensors_it_drives_and_says_so():
    context = create(sensors=())
    assert "wall_sensor" in context.log_messages[-1]
    context.deliver("turtlebot_node/cmd_vel", linear={"x": 0.1}, angular={"z": 0.0})
    context.advance(0.1)
    assert context.joints[WHEELS[0]].motor == (pytest.approx(0.1 / 0.033), 1.0)
