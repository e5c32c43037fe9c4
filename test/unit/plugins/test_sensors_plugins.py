"""Plugins of sensors in a world without physics and rays."""
from __future__ import annotations

import math

import numpy as np
import pytest

from my_simulations.description.model import Link, Model
from my_simulations.description.sensor import (
    AxesNoise,
    ContactSensor,
    Imu,
    Noise,
    Ray,
    ScanAngles,
    Sensor,
)
from my_simulations.description.shapes import Collision, Sphere
from my_simulations.engine.commands import Contact
from my_simulations.geometry import Twist
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.imu_meter import ImuMeter
from my_simulations.plugins.sensors.bumper import Bumper
from my_simulations.plugins.sensors.imu import ModelImu, SensorImu
from my_simulations.plugins.sensors.laser_points import Laser
from my_simulations.plugins.sensors.range import Range
from my_simulations.plugins.state.force import Force
from my_simulations.plugins.state.joint_state_publisher import JointStatePublisher
from my_simulations.plugins.state.p3d import P3d
from my_simulations.plugins.testing import FakeContext
from my_simulations.sensing.api import RayReturns


def laser(noise=None, kind="ray", inside="<topicName>scan</topicName>", rate=10.0):
    ray = Ray(ScanAngles(4, 1.0, -1.0, 1.0), min_range=0.1, max_range=5.0, noise=noise or Noise())
    context = FakeContext(f"<plugin>{inside}<frameName>mast</frameName></plugin>",
                          sensor=Sensor("s", kind, update_rate=rate, ray=ray), sensor_link="base")
    context.returns = RayReturns(np.array([0.05, 1.0, 2.0, math.inf]), np.zeros(4), np.zeros(4))
    return context


def test_a_scan_has_the_ranges_of_gazebo():
    context = laser()
    Laser(context).load()
    context.advance(0.25)
    scans = context.published["scan"]
    assert len(scans) == 2 and scans[0].header.frame_id == "mast"
    assert scans[0].ranges == [-math.inf, 1.0, 2.0, math.inf]
    assert scans[0].angle_increment == pytest.approx(2.0 / 3.0)
    assert (scans[0].header.stamp.to_nsec(), scans[0].range_max) == (100_000_000, 5.0)


def test_a_ray_sees_collisions_and_a_gpu_ray_visuals():
    for kind, visuals in (("ray", False), ("gpu_ray", True)):
        context = laser(kind=kind)
        Laser(context).load()
        context.advance(0.1)
        (fan, seen), = context.fans
        assert seen is visuals and (fan.samples, fan.near, fan.far) == (4, 0.1, 5.0)


def test_noise_of_a_scan_repeats_and_leaves_empty_returns_alone():
    def run():
        context = laser(Noise("gaussian", stddev=0.01))
        Laser(context).load()
        context.advance(0.2)
        return [scan.ranges for scan in context.published["scan"]]

    first, second = run()
    assert first[0] == -math.inf and first[3] == math.inf and first[1] != 1.0
    assert first != second and run() == [first, second]


def test_a_range_sensor_tells_the_nearest_or_the_maximum():
    context = laser(inside="<topicName>sonar</topicName>")
    Range(context).load()
    context.advance(0.1)
    context.returns = RayReturns(np.full(4, math.inf), np.zeros(4), np.zeros(4))
    context.advance(0.1)
    assert [one.range for one in context.published["sonar"]] == pytest.approx([0.05, 5.0])


def test_a_laser_without_rays_is_the_users_fault():
    with pytest.raises(PluginError, match="<ray>"):
        Laser(FakeContext(sensor=Sensor("s", "camera"))).load()


def test_an_imu_at_rest_feels_gravity_and_in_free_fall_nothing():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>imu</topicName>"
                          "<updateRate>100</updateRate></plugin>")
    ModelImu(context).load()
    context.advance(0.01)
    context.link("base").twist = Twist((0.0, 0.0, -0.098), (0.0, 0.0, 0.5))
    context.advance(0.01)
    rest, fall = context.published["imu"]
    assert rest.linear_acceleration.z == pytest.approx(9.8)
    assert fall.linear_acceleration.z == pytest.approx(0.0)
    assert fall.angular_velocity.z == 0.5 and rest.header.frame_id == "base"


def test_an_imu_sensor_has_the_noise_of_its_block():
    block = Imu(AxesNoise(x=Noise("gaussian", mean=0.25)))
    context = FakeContext("<plugin><frameName>imu</frameName><updateRateHZ>10</updateRateHZ>"
                          "</plugin>", sensor=Sensor("i", "imu", imu=block), sensor_link="base")
    SensorImu(context).load()
    context.advance(0.1)
    (sample,) = context.published["robot/imu_data"]
    assert (sample.angular_velocity.x, sample.angular_velocity.y) == pytest.approx((0.25, 0.0))


@pytest.mark.parametrize(("rate", "seconds"), [(100.0, 0.01), (0.0, 0.001)])
def test_the_acceleration_of_an_imu_sensor_is_over_the_period_of_its_sensor(rate, seconds):
    context = FakeContext("<plugin><frameName>imu</frameName><updateRateHZ>10</updateRateHZ>"
                          "</plugin>", sensor=Sensor("i", "imu", update_rate=rate),
                          sensor_link="base")
    plugin = context.load(SensorImu)
    for _ in range(2):
        context.advance(0.1 - seconds)
        speed = context.link("base").twist.linear[0]
        context.link("base").twist = Twist((speed + 0.05, 0.0, 0.0))
        context.advance(seconds)
        assert context.published["robot/imu_data"][-1].linear_acceleration.x == pytest.approx(
            0.05 / seconds)
        plugin.reset()


def test_an_imu_sensor_that_nobody_listens_to_looks_at_nothing(monkeypatch):
    context = FakeContext("<plugin><frameName>imu</frameName><updateRateHZ>10</updateRateHZ>"
                          "</plugin>", sensor=Sensor("i", "imu", update_rate=100.0),
                          sensor_link="base")
    context.unwanted = {"robot/imu_data"}
    looks = []
    monkeypatch.setattr(ImuMeter, "restart", lambda meter: looks.append(context.now_ns))
    SensorImu(context).load()
    assert looks == [0]
    context.advance(1.0)
    assert looks == [0]


@pytest.mark.parametrize(("inside", "namespace"), [
    ("", "/robot"), ("<robotNamespace></robotNamespace>", "/"),
    ("<robotNamespace>left</robotNamespace>", "left")])
def test_an_imu_sensor_is_in_the_namespace_of_its_model_the_root_or_the_one_given(
        inside, namespace, monkeypatch):
    context = FakeContext(f"<plugin><frameName>imu</frameName>{inside}</plugin>",
                          sensor=Sensor("i", "imu"), sensor_link="base")
    used = []
    monkeypatch.setattr(context, "use_namespace", used.append)
    SensorImu(context).load()
    assert used == [namespace]


@pytest.mark.parametrize(("sensor", "plugin", "rate"), [
    (20.0, 100.0, 20), (100.0, 20.0, 20), (0.0, 20.0, 20), (20.0, 0.0, 20), (0.0, 0.0, 1000)])
def test_imu_and_range_sensors_are_no_faster_than_their_sensor_and_plugin(sensor, plugin, rate):
    imu = FakeContext("<plugin><frameName>imu</frameName><topicName>data</topicName>"
                      f"<updateRateHZ>{plugin}</updateRateHZ></plugin>",
                      sensor=Sensor("i", "imu", update_rate=sensor), sensor_link="base")
    SensorImu(imu).load()
    sonar = laser(inside=f"<topicName>data</topicName><updateRate>{plugin}</updateRate>",
                  rate=sensor)
    Range(sonar).load()
    for context, topic in ((imu, "robot/data"), (sonar, "data")):
        context.advance(1.0)
        assert len(context.published[topic]) == rate


def test_a_bumper_tells_of_its_link_alone_as_the_force_on_it():
    context = FakeContext(sensor=Sensor("b", "contact", update_rate=10.0,
                                        contact=ContactSensor(["c"])), sensor_link="base")
    ground = Link("link", collisions=[Collision("floor", Sphere(1.0)), Collision("b", Sphere(1.0))])
    context.others = {"ground": Model("ground", links=[ground])}
    Bumper(context).load()
    up = (0.0, 0.0, 1.0)
    context.touching = [
        ("ground::link", "robot::base", Contact(0, 1, (0.1, 0, 0), (0.0, 0.0, -1.0), 1e-4, 4.0)),
        ("robot::base", "ground::link", Contact(1, 0, (-0.1, 0, 0), up, 1e-4, 6.0)),
        ("a::b", "c::d", Contact(5, 6, (0, 0, 0), up, 0.0, 9.0))]
    context.advance(0.1)
    (state,) = context.published["bumper_states"][0].states
    assert (state.collision1_name, state.collision2_name) == (
        "robot::base::c", "ground::link::floor")
    assert state.total_wrench.force.z == pytest.approx(10.0)
    assert state.total_wrench.torque.y == pytest.approx(0.2)
    context.touching = []
    context.advance(0.1)
    assert context.published["bumper_states"][1].states == []


def test_a_bumper_without_a_collision_of_its_own_names_the_first_of_its_link():
    context = FakeContext(sensor=Sensor("b", "contact", update_rate=10.0), sensor_link="base")
    context.others = {"robot": Model("robot", links=[
        Link("base", collisions=[Collision("shell", Sphere(1.0))])])}
    Bumper(context).load()
    context.touching = [("robot::base", "gone::link",
                         Contact(1, 0, (0, 0, 0), (0.0, 0.0, 1.0), 1e-4, 6.0))]
    context.advance(0.1)
    (state,) = context.published["bumper_states"][0].states
    assert (state.collision1_name, state.collision2_name) == ("robot::base::shell", "gone::link")


def test_joint_states_of_a_list_with_blanks():
    context = FakeContext("<plugin><jointName>a, b</jointName></plugin>", joints=("a", "b"))
    JointStatePublisher(context).load()
    context.joints["b"].position = 0.5
    context.advance(0.01)
    (state,) = context.published["robot/joint_states"]
    assert (state.name, state.position) == (["a", "b"], [0.0, 0.5])


def test_a_joint_that_is_not_there_leaves_the_states_of_the_others():
    context = FakeContext("<plugin><jointName>none, b</jointName></plugin>", joints=("b",))
    JointStatePublisher(context).load()
    assert "no joint 'none'" in context.log_messages[-1]
    context.advance(0.01)
    assert context.published["robot/joint_states"][-1].name == ["b"]


def test_ground_truth_with_an_offset():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>truth</topicName>"
                          "<updateRate>50</updateRate><xyzOffset>1 2 3</xyzOffset></plugin>")
    P3d(context).load()
    context.link("base").twist = Twist((0.5, 0, 0))
    context.advance(0.02)
    (odom,) = context.published["truth"]
    assert odom.pose.pose.position.y == 2.0 and odom.twist.twist.linear.x == 0.5
    assert (odom.header.frame_id, odom.child_frame_id) == ("world", "base")


def test_the_tf_prefix_of_ground_truth_is_before_its_frame_alone():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>truth</topicName></plugin>")
    context.ros_parameters["tf_prefix"] = "r1"
    P3d(context).load()
    context.advance(0.001)
    (odom,) = context.published["truth"]
    assert (odom.header.frame_id, odom.child_frame_id) == ("r1/world", "base")


BODY = "<bodyName>base</bodyName>"


@pytest.mark.parametrize(("plugin", "inside"), [
    (P3d, BODY), (Force, BODY), (Force, f"{BODY}<topicName/>")])
def test_a_plugin_without_a_topic_name_is_the_users_fault(plugin, inside):
    with pytest.raises(PluginError, match="it has no <topicName>"):
        plugin(FakeContext(f"<plugin>{inside}</plugin>")).load()


def test_a_plugin_with_an_empty_topic_name_publishes_nothing():
    for plugin in (P3d, ModelImu):
        context = FakeContext(f"<plugin>{BODY}<topicName></topicName></plugin>")
        plugin(context).load()
        context.advance(0.1)
        assert context.published == {}


def test_a_force_holds_until_the_next_one():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>force</topicName></plugin>")
    context.load(Force)
    context.deliver("force", force={"x": 1.0, "y": 0.0, "z": 2.0},
                    torque={"x": 0, "y": 0, "z": 3.0})
    assert context.wrenches["base"] == ((1.0, 0.0, 2.0), (0, 0, 3.0))


def test_an_imu_that_nobody_listened_to_begins_anew():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>imu</topicName>"
                          "<updateRate>100</updateRate></plugin>")
    context.unwanted = {"imu"}
    ModelImu(context).load()
    context.advance(1.0)
    context.link("base").twist = Twist((5.0, 0.0, 0.0))
    context.unwanted = set()
    context.advance(0.02)
    (sample,) = context.published["imu"]
    assert sample.linear_acceleration.x == pytest.approx(0.0)


def test_the_noise_of_a_scan_does_not_depend_on_scans_before():
    def second(first_wanted):
        context = laser(Noise("gaussian", stddev=0.01))
        Laser(context).load()
        context.unwanted = set() if first_wanted else {"scan"}
        context.advance(0.1)
        context.unwanted = set()
        context.advance(0.1)
        return context.published["scan"][-1].ranges

    assert second(True) == second(False)


def noisy(kind):
    """Of a plugin with noise of its own: a reset, and what it has published in the next 0.2 s."""
    noise = "<gaussianNoise>0.5</gaussianNoise><topicName>told</topicName>"
    if kind is Range:
        context = laser(inside=noise)
    else:
        context = FakeContext(f"<plugin>{BODY}{noise}<updateRate>50</updateRate></plugin>")
    plugin = context.load(kind)

    def told():
        context.published["told"].clear()
        context.advance(0.2)
        return [NUMBERS[kind](message) for message in context.published["told"]]

    def reset():
        context.step = 0
        plugin.reset()

    return reset, told


NUMBERS = {
    Range: lambda message: message.range,
    ModelImu: lambda message: (message.linear_acceleration.x, message.angular_velocity.z),
    P3d: lambda message: (message.twist.twist.linear.x, message.twist.twist.angular.z)}


@pytest.mark.parametrize("kind", list(NUMBERS))
def test_the_noise_of_a_run_after_a_reset_is_that_of_the_first(kind):
    reset, told = noisy(kind)
    first = told()
    assert len(first) > 1 and told() != first
    reset()
    assert told() == first
