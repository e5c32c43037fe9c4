"""What is not finite does not reach motors, bodies and divisions of plugins."""
from __future__ import annotations

import math

import pytest
from geometry_msgs.msg import Twist, Vector3
from std_msgs.msg import Float64MultiArray

from my_simulations.plugins.context import PluginError
from my_simulations.plugins.drive.diff_drive import DiffDrive
from my_simulations.plugins.drive.kobuki import Kobuki
from my_simulations.plugins.drive.skid_steer_drive import SkidSteerDrive
from my_simulations.plugins.drive.tricycle_drive import TricycleDrive
from my_simulations.plugins.finite_messages import is_all_finite
from my_simulations.plugins.sensors.hector import pressure_at
from my_simulations.plugins.state.force import Force
from my_simulations.plugins.state.hand_of_god import HandOfGod
from my_simulations.plugins.state.p3d import P3d
from my_simulations.plugins.testing import FakeContext

WHEELS = ("left_joint", "right_joint", "front_steering_joint", "front_wheel_joint",
          "left_wheel_joint", "right_wheel_joint", "left_front_joint", "right_front_joint",
          "left_rear_joint", "right_rear_joint")
NOT_FINITE = (math.nan, math.inf, -math.inf, 1e308)


@pytest.mark.parametrize("value", NOT_FINITE)
def test_a_drive_passes_over_a_command_that_is_not_finite_and_says_so_once(value):
    context = FakeContext(joints=WHEELS)
    DiffDrive(context).load()
    context.deliver("robot/cmd_vel", linear={"x": 0.3}, angular={"z": 0.0})
    for _ in range(3):
        context.deliver("robot/cmd_vel", linear={"x": 0.0}, angular={"z": value})
    context.advance(0.02)
    assert context.joints["left_joint"].motor[0] == pytest.approx(4.0)
    (text,) = context.log_messages
    assert "cmd_vel" in text and "NaN" in text


def test_a_wrench_that_is_not_finite_leaves_the_last_one():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>push</topicName></plugin>")
    Force(context).load()
    none = {"x": 0.0, "y": 0.0, "z": 0.0}
    context.deliver("push", force={**none, "x": 1.0}, torque=none)
    context.deliver("push", force={**none, "x": math.inf}, torque=none)
    assert context.wrenches["base"] == ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_numbers_of_messages_are_looked_at_wherever_they_are():
    assert is_all_finite(Twist()) and is_all_finite(Float64MultiArray(data=(1.0, 2.0)))
    assert not is_all_finite(Twist(angular=Vector3(z=math.nan)))
    assert not is_all_finite(Float64MultiArray(data=(1.0, math.inf)))


@pytest.mark.parametrize("made, name", [
    (DiffDrive, "wheelDiameter"), (DiffDrive, "wheelSeparation"), (SkidSteerDrive, "wheelDiameter"),
    (TricycleDrive, "actuatedWheelDiameter"), (TricycleDrive, "encoderWheelSeparation")])
@pytest.mark.parametrize("text", ["0", "-1", "1e-320", "nan"])
def test_wheels_of_no_size_are_those_of_the_default(made, name, text):
    context = FakeContext(f"<plugin><{name}>{text}</{name}></plugin>", joints=WHEELS)
    made(context).load()
    context.advance(0.02)
    assert name in context.log_messages[0] and "above 0" in context.log_messages[0]


def test_a_kobuki_without_a_usable_wheel_is_refused():
    context = FakeContext("<plugin><left_wheel_joint_name>left_joint</left_wheel_joint_name>"
                          "<right_wheel_joint_name>right_joint</right_wheel_joint_name>"
                          "<wheel_separation>wide</wheel_separation></plugin>", joints=WHEELS)
    with pytest.raises(PluginError, match="wheel_separation"):
        Kobuki(context).load()


@pytest.mark.parametrize("text, number", [("inf", 1e16), ("-1e999", -1e16), ("nan", 2.0)])
def test_a_parameter_without_an_end_is_the_number_that_stands_for_no_limit(text, number):
    context = FakeContext(f"<plugin><a>{text}</a></plugin>")
    assert context.parameters.number("a", 2.0) == number
    assert context.parameters.integer("a", 2) == int(number)


def test_springs_of_negative_stiffness_and_endless_noise_end_no_plugin():
    HandOfGod(FakeContext("<plugin><linkName>base</linkName><kl>-1</kl><ka>-1</ka></plugin>")).load()
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>p</topicName>"
                          "<gaussianNoise>1e308</gaussianNoise></plugin>")
    P3d(context).load()
    context.advance(0.002)
    assert context.published["p"]


def test_there_is_no_pressure_above_the_atmosphere():
    assert pressure_at(44330.0 * 2, 1013.25) == 0.0
    assert pressure_at(0.0, 1013.25) == pytest.approx(1013.25)
