"""Servos that point a sensor, against rotation matrices."""
from __future__ import annotations

import math

import numpy as np
import pytest

from my_simulations.geometry import quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.state.hector_servo import HectorServo
from my_simulations.plugins.testing import FakeContext, Message

PLACES = ("first", "second", "third")
VECTORS = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


def servos(axes, inside=""):
    named = "".join(f"<{place}ServoName>{axis}</{place}ServoName>"
                    f"<{place}ServoAxis>{VECTORS[axis]}</{place}ServoAxis>"
                    for place, axis in zip(PLACES, axes))
    context = FakeContext(f"<plugin>{named}{inside}</plugin>", joints=tuple(axes))
    HectorServo(context).load()
    return context


def stabilized(roll=0.0, pitch=0.0, yaw=0.0):
    """The frame base_stabilized of a base that is tilted."""
    x, y, z, w = quat_from_rpy(roll, pitch, yaw)
    return [Message(header=Message(frame_id="base_link"), child_frame_id="base_stabilized",
                    transform=Message(translation={"x": 0.0, "y": 0.0, "z": 0.0},
                                      rotation={"x": x, "y": y, "z": z, "w": w}))]


def point(context, roll, pitch, yaw, frame="base_stabilized"):
    x, y, z, w = quat_from_rpy(roll, pitch, yaw)
    context.deliver("drive", header=Message(frame_id=frame),
                    quaternion={"x": x, "y": y, "z": z, "w": w})


def about(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array({"x": [[1, 0, 0], [0, c, -s], [0, s, c]],
                     "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
                     "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis])


def orientation(roll, pitch, yaw):
    return about("z", yaw) @ about("y", pitch) @ about("x", roll)


@pytest.mark.parametrize("axes", ["xyz", "zyx"])
def test_three_servos_reach_an_orientation_in_the_stabilized_frame_of_a_tilted_base(axes):
    context = servos(axes)
    context.deliver("/tf", transforms=stabilized(0.1, -0.3, 0.2))
    point(context, 0.2, 0.4, -0.7)
    context.advance(3.0)
    reached = np.eye(3)
    for axis in axes:
        reached = reached @ about(axis, context.joints[axis].position)
    wanted = orientation(0.1, -0.3, 0.2) @ orientation(0.2, 0.4, -0.7)
    assert reached == pytest.approx(wanted, abs=1e-6)


def test_a_single_servo_takes_the_pitch_and_two_take_yaw_and_pitch():
    one, two = servos("y"), servos("zy")
    for context in (one, two):
        context.deliver("/tf", transforms=stabilized())
        point(context, 0.0, 0.3, 0.0)
        context.advance(3.0)
    assert one.joints["y"].position == pytest.approx(0.3, abs=1e-6)
    assert two.joints["y"].position == pytest.approx(0.3, abs=1e-6)
    assert two.joints["z"].position == pytest.approx(0.0, abs=1e-6)


def test_a_servo_keeps_a_sensor_level_without_a_command_and_stands_without_tf():
    context = servos("y", "<maxVelocity>0.5</maxVelocity>")
    context.advance(0.1)
    assert context.joints["y"].position == 0.0
    context.deliver("/tf", transforms=stabilized(0.0, 0.4, 0.0))
    context.advance(0.1)
    assert context.joints["y"].velocity == pytest.approx(0.5)
    context.advance(3.0)
    assert context.joints["y"].position == pytest.approx(0.4, abs=1e-6)
    before = context.joints["y"].position
    point(context, 0.0, 1.0, 0.0, frame="unknown")
    context.advance(0.5)
    assert context.joints["y"].position == before


def test_limits_and_gains_come_from_the_file():
    context = servos("y", "<torque>3</torque><proportionalControllerGain>2"
                     "</proportionalControllerGain><derivativeControllerGain>0.5"
                     "</derivativeControllerGain>")
    context.deliver("/tf", transforms=stabilized())
    servo = context.joints["y"].servo
    assert (servo.most_effort, servo.gains.p, servo.gains.d) == (3.0, 2.0, 0.5)
    assert servo.most_rate == math.inf


def test_joint_states_have_positions_at_the_control_rate():
    context = servos("zy", "<controlRate>10</controlRate>")
    context.deliver("/tf", transforms=stabilized())
    point(context, 0.0, 0.2, 0.1)
    context.advance(1.0)
    states = context.published["joint_states"]
    assert len(states) == 10 and states[-1].name == ["z", "y"]
    assert states[-1].position == pytest.approx([0.1, 0.2], abs=1e-3)


@pytest.mark.parametrize(("axes", "inside", "message"), [
    ("x", "", "axes"), ("yz", "", "axes"),
    ("", "<secondServoName>y</secondServoName>", "in order")])
def test_other_servos_are_refused(axes, inside, message):
    with pytest.raises(PluginError, match=message):
        servos(axes, inside)


def test_a_reset_forgets_the_command():
    context = servos("y")
    plugin = context.load(HectorServo)
    context.deliver("/tf", transforms=stabilized())
    point(context, 0.0, 0.7, 0.0)
    context.advance(0.01)
    assert context.joints["y"].servo.target == pytest.approx(0.7)
    plugin.reset()
    assert context.joints["y"].servo.target == pytest.approx(0.0)
