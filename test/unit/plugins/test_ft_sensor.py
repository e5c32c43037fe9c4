"""The force-torque plugin in a world without physics."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.model import Joint
from my_simulations.description.sensor import ForceTorque, Sensor
from my_simulations.engine.commands import JointWrench
from my_simulations.geometry import Pose, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.state.ft_sensor import FtSensor
from my_simulations.plugins.testing import FakeContext

ASKED = "<jointName>wrist</jointName><topicName>ft</topicName>"


def sensor_of(inside=ASKED, **options):
    context = FakeContext(f"<plugin>{inside}</plugin>", **options)
    context.description.joints.append(Joint("wrist", "fixed", "arm", "hand",
                                            Pose(orientation=quat_from_rpy(0, 0, math.pi / 2))))
    context.joint_wrenches["wrist"] = JointWrench((1.0, 2.0, 3.0), (4.0, 5.0, 6.0),
                                            quat_from_rpy(0, 0, math.pi))
    context.load(FtSensor)
    return context


def values(message):
    force, torque = message.wrench.force, message.wrench.torque
    return (force.x, force.y, force.z, torque.x, torque.y, torque.z)


def test_it_tells_what_the_child_does_to_the_parent_in_the_childs_frame():
    context = sensor_of(ASKED + "<updateRate>50</updateRate>")
    context.advance(0.1)
    assert len(context.published["ft"]) == 5
    message = context.published["ft"][-1]
    assert values(message) == (-1, -2, -3, -4, -5, -6)
    assert message.header.frame_id == "hand" and message.header.stamp.to_nsec() == 100_000_000


def test_nothing_is_published_before_there_is_a_measurement():
    context = sensor_of()
    del context.joint_wrenches["wrist"]
    context.advance(0.01)
    assert not context.published["ft"]


@pytest.mark.parametrize("frame, direction, wanted, name", [
    ("parent", "parent_to_child", (-1, -2, 3, -4, -5, 6), "arm"),
    ("sensor", "child_to_parent", (-2, 1, -3, -5, 4, -6), "ft_sensor")])
def test_in_a_sensor_it_measures_as_the_sensor_says(frame, direction, wanted, name):
    sensor = Sensor("ft_sensor", "force_torque", update_rate=20.0,
                    force_torque=ForceTorque(frame, direction))
    context = sensor_of("<topicName>ft</topicName>", sensor=sensor, sensor_joint="wrist")
    context.advance(0.1)
    assert len(context.published["ft"]) == 2
    assert values(context.published["ft"][0]) == pytest.approx(wanted)
    assert context.published["ft"][0].header.frame_id == name


def test_noise_has_the_spread_it_is_told():
    context = sensor_of(ASKED + "<gaussianNoise>0.5</gaussianNoise>")
    context.advance(2.0)
    apart = [value - true for message in context.published["ft"]
             for value, true in zip(values(message), (-1, -2, -3, -4, -5, -6))]
    assert math.sqrt(sum(a * a for a in apart) / len(apart)) == pytest.approx(0.5, rel=0.03)


@pytest.mark.parametrize("inside, what", [
    ("<topicName>ft</topicName>", "no <jointName>"), ("<jointName>wrist</jointName>", "topicName"),
    ("<jointName>elbow</jointName><topicName>ft</topicName>", "preserveFixedJoint")])
def test_what_is_missing_is_named(inside, what):
    with pytest.raises(PluginError, match=what):
        sensor_of(inside)
