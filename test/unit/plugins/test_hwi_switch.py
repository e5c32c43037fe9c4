"""libhwi_switch_gazebo_ros_control.so: joints whose interface follows the controller."""
from __future__ import annotations

import pytest
from robot_control import NS, Arm, transmission

from my_simulations.description.model import Joint, Link, Model
from my_simulations.description.transmission import Actuator, Transmission, TransmissionJoint
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.control.gazebo_ros_control import PATIENCE_S, GazeboRosControl
from my_simulations.plugins.control.hwi_switch import HwiSwitchGazeboRosControl
from my_simulations.plugins.registry import PluginRegistry, plugin_class
from my_simulations.plugins.testing import FakeContext

ALL = ("hardware_interface/PositionJointInterface hardware_interface/VelocityJointInterface"
       " hardware_interface/EffortJointInterface")
CONTROLLERS = {
    "by_position": {"type": "position_controllers/JointPositionController", "joint": "one"},
    "by_velocity": {"type": "velocity_controllers/JointVelocityController", "joint": "one"},
    "by_effort": {"type": "effort_controllers/JointEffortController", "joint": "one"},
}


def arm(inside="", kind=HwiSwitchGazeboRosControl, **parameters):
    return Arm(interfaces=[ALL, ALL], inside=inside, kind=kind, parameters=parameters,
               **CONTROLLERS)


def drive_of(robot, name="one"):
    return robot.context.joints[name].servo.drive


def test_the_registry_has_the_library():
    found = PluginRegistry().locate("libhwi_switch_gazebo_ros_control.so")
    assert plugin_class(found) is HwiSwitchGazeboRosControl


def test_a_joint_is_driven_by_the_interface_that_its_controller_claims():
    robot = arm()
    assert drive_of(robot) == "position"             # the first one, until a controller runs
    robot.run("by_position")
    robot.deliver("by_position/command", data=0.5)
    robot.context.advance(0.2)
    assert robot.at() == pytest.approx(0.5, abs=1e-6)
    for name, drive in (("by_velocity", "velocity"), ("by_effort", "effort"),
                        ("by_position", "position")):
        assert name in robot.states() or robot.load(name)
        running = [one for one, state in robot.states().items() if state == "running"]
        assert robot.switch([name], running), robot.context.log_messages
        assert drive_of(robot) == drive
    robot.switch(["by_velocity"], ["by_position"])
    robot.deliver("by_velocity/command", data=1.0)
    before = robot.at()
    robot.context.advance(0.5)
    assert robot.at() - before == pytest.approx(0.5, abs=0.01)


def test_a_joint_without_controller_keeps_the_interface_of_the_last_one():
    robot = arm()
    robot.run("by_velocity")
    robot.deliver("by_velocity/command", data=1.0)
    robot.context.advance(0.1)
    assert robot.switch(stop=["by_velocity"])
    assert (drive_of(robot), robot.context.joints["one"].servo.target) == ("velocity", 0.0)
    robot.plugin.reset()
    assert drive_of(robot) == "position"  # held until a controller could have started
    robot.context.advance(PATIENCE_S + 0.1)
    assert (drive_of(robot), robot.context.joints["one"].servo.target) == ("velocity", 0.0)


def test_gains_do_not_change_the_interface():
    robot = arm(gazebo_ros_control={"pid_gains": {"one": {"p": 10.0}}})
    assert robot.context.joints["one"].servo.drive_gains is None


def test_hardware_of_pal_moves_each_joint_of_a_differential_transmission():
    robot = Arm(inside="<robotSimType>pal_hardware_gazebo/PalHardwareGazebo</robotSimType>",
                transmissions=[Transmission("wrist", joints=[
                    TransmissionJoint(name, ALL.split()) for name in ("one", "two")],
                    actuators=[Actuator("left"), Actuator("right")])], **CONTROLLERS)
    robot.run("by_velocity")
    assert (drive_of(robot), drive_of(robot, "two")) == ("velocity", "position")
    assert robot.context.log_messages == []


def test_the_default_hardware_has_the_first_interface_only():
    robot = arm(kind=GazeboRosControl)
    assert not robot.load("by_velocity")
    message = robot.context.log_messages[-1]
    assert "has no transmission with hardware_interface::VelocityJoint" in message


def test_the_hardware_can_be_named_in_the_default_library():
    robot = arm("<robotSimType>cob_gazebo_ros_control/HWISwitchRobotHWSim</robotSimType>",
                GazeboRosControl)
    robot.run("by_velocity")
    assert drive_of(robot) == "velocity"


def test_a_filter_leaves_the_other_joints_to_other_plugins():
    robot = arm("<filterJointsParam>joint_names</filterJointsParam>", joint_names=["two"])
    assert robot.context.joints["one"].servo is None
    assert drive_of(robot, "two") == "position"
    assert not robot.load("by_position")


@pytest.mark.parametrize("names", [None, "one"])
def test_a_filter_needs_a_list_of_names(names):
    context = FakeContext("<plugin><filterJointsParam>joint_names</filterJointsParam></plugin>",
                          joints=("one",))
    context.description = Model(NS, links=[Link("base"), Link("one")],
                                joints=[Joint("one", "revolute", "base", "one")],
                                transmissions=[transmission("one", *ALL.split())])
    context.ros_parameters = {NS: {} if names is None else {"joint_names": names}}
    with pytest.raises(PluginError, match="joint_names: this parameter must list"):
        HwiSwitchGazeboRosControl(context).load()


def test_an_invalid_state_stops_until_the_emergency_stop_is_released():
    robot = arm("<eStopTopic>stop</eStopTopic><stateValidTopic>valid</stateValidTopic>")
    robot.run("by_velocity")

    def turned():
        robot.deliver("by_velocity/command", data=1.0)
        before = robot.at()
        robot.context.advance(0.1)
        return robot.at() - before > 0.05

    assert turned()
    robot.deliver("valid", data=False)
    assert not turned()
    robot.deliver("stop", data=False)
    assert not turned()                              # the state is still invalid
    robot.deliver("valid", data=True)
    assert not turned()
    robot.deliver("stop", data=False)
    assert turned()
