"""gazebo_ros_control and its controller manager, without ROS."""
from __future__ import annotations

import pytest
from robot_control import Arm

FORWARD = {"type": "position_controllers/JointPositionController", "joint": "one"}
GROUP = {"type": "position_controllers/JointGroupPositionController", "joints": ["one", "two"]}
STATE = {"type": "joint_state_controller/JointStateController", "publish_rate": 50}


def test_a_controller_is_loaded_started_stopped_and_unloaded():
    arm = Arm(forward=FORWARD)
    assert arm.load("forward")
    assert arm.states() == {"forward": "initialized"}
    assert arm.switch(["forward"])
    assert arm.states() == {"forward": "running"}
    assert not arm.ask("unload_controller", name="forward").ok
    assert arm.switch((), ["forward"])
    assert arm.states() == {"forward": "stopped"}
    assert arm.ask("unload_controller", name="forward").ok
    assert arm.states() == {}
    assert "robot/forward/command" not in arm.context._heard


def test_what_cannot_be_loaded_is_told_with_the_reason():
    arm = Arm(odd={"type": "odd_controllers/Odd"}, nothing={"joint": "one"},
              lost={**FORWARD, "joint": "three"}, wrong={**FORWARD, "joint": 3})
    for name, why in (("odd", "odd_controllers/Odd"), ("nothing", "nothing/type is missing"),
                      ("lost", "joint 'three' has no transmission"), ("wrong", "a text"),
                      ("absent", "absent/type is missing")):
        assert not arm.load(name)
        assert why in arm.context.log_messages[-1]
    assert arm.states() == {}


def test_an_interface_that_the_joint_lacks_is_named_with_the_one_it_has():
    arm = Arm(forward={"type": "effort_controllers/JointEffortController", "joint": "one"})
    assert not arm.load("forward")
    assert "PositionJointInterface" in arm.context.log_messages[-1]


def test_two_controllers_of_a_joint_cannot_run_together():
    arm = Arm(forward=FORWARD, group=GROUP)
    arm.run("forward")
    assert arm.load("group")
    assert not arm.switch(["group"])
    assert "both drive joint 'one'" in arm.context.log_messages[-1]
    assert arm.states() == {"forward": "running", "group": "initialized"}
    assert arm.switch(["group"], ["forward"])
    assert arm.states() == {"forward": "stopped", "group": "running"}


def test_strict_switches_do_all_or_nothing():
    arm = Arm(forward=FORWARD)
    assert arm.load("forward")
    assert not arm.switch(["forward", "absent"], strictness=2)
    assert arm.states() == {"forward": "initialized"}
    assert not arm.switch((), ["forward"], strictness=2)
    assert arm.switch(["forward", "absent"], strictness=1)
    assert arm.states() == {"forward": "running"}
    assert not arm.switch(["forward"], strictness=2)
    assert arm.switch(["forward"], strictness=1)


def test_listing_says_types_states_and_claimed_joints():
    arm = Arm(group=GROUP, states=STATE)
    arm.run("group", "states")
    found = {one.name: one for one in arm.ask("list_controllers").controller}
    assert found["group"].type == GROUP["type"]
    (claimed,) = found["group"].claimed_resources
    assert claimed.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claimed.resources == ["one", "two"]
    assert found["states"].claimed_resources == []
    types = arm.ask("list_controller_types")
    assert "effort_controllers/JointTrajectoryController" in types.types
    assert len(types.base_classes) == len(types.types)


def test_reloading_needs_force_while_controllers_are_loaded():
    arm = Arm(forward=FORWARD)
    arm.run("forward")
    assert not arm.ask("reload_controller_libraries", force_kill=False).ok
    assert arm.ask("reload_controller_libraries", force_kill=True).ok
    assert arm.states() == {}


def test_joint_states_come_at_their_rate_and_before_any_other_controller():
    ghost = {"name": "ghost", "position": 0.5}
    arm = Arm("EffortJointInterface", states={**STATE, "extra_joints": [ghost]})
    arm.run("states")
    arm.context.joints["two"].put(0.25)
    arm.context.advance(0.1)
    messages = arm.published("joint_states")
    assert [one.header.stamp.to_nsec() for one in messages] == [20e6, 40e6, 60e6, 80e6, 100e6]
    assert messages[-1].name == ["one", "two", "ghost"]
    assert messages[-1].position == [0.0, 0.25, 0.5]
    assert len(messages[-1].velocity) == len(messages[-1].effort) == 3


def test_joint_states_are_in_alphabetical_order_of_the_joints():
    arm = Arm("EffortJointInterface", names=("shoulder", "elbow"), states=STATE)
    arm.run("states")
    arm.context.joints["elbow"].put(0.25)
    arm.context.advance(0.02)
    (message,) = arm.published("joint_states")
    assert (message.name, message.position) == (["elbow", "shoulder"], [0.25, 0.0])


def test_joint_states_are_in_the_order_that_the_controller_is_told():
    arm = Arm(states={**STATE, "joints": ["two", "one"]})
    arm.run("states")
    arm.context.advance(0.02)
    assert arm.published("joint_states")[0].name == ["two", "one"]


def test_a_rate_is_needed_for_joint_states():
    arm = Arm(states={"type": STATE["type"]})
    assert not arm.load("states")
    assert "publish_rate" in arm.context.log_messages[-1]


def test_positions_are_held_until_somebody_controls_them():
    arm = Arm()
    assert arm.context.joints["one"].servo.drive == "position"
    assert arm.context.joints["one"].servo.target == 0.0


@pytest.mark.parametrize("spelling", ["EffortJointInterface",
                                      "hardware_interface/EffortJointInterface",
                                      "hardware_interface::EffortJointInterface"])
def test_interfaces_are_known_in_all_spellings(spelling):
    arm = Arm(spelling, push={"type": "effort_controllers/JointEffortController", "joint": "one"})
    arm.run("push")
    arm.deliver("push/command", data=3.0)
    arm.context.advance(0.5)
    assert arm.context.joints["one"].velocity == pytest.approx(1.5)


def test_an_unknown_interface_leaves_the_state_of_its_joint():
    arm = Arm(interfaces=("franka_hw/FrankaStateInterface",
                          "hardware_interface/EffortJointInterface"), states=STATE)
    assert "FrankaStateInterface" in arm.context.log_messages[0]
    arm.run("states")
    arm.context.advance(0.02)
    assert arm.published("joint_states")[0].name == ["one", "two"]


def test_gains_of_the_hardware_make_a_loop_of_a_position_joint():
    gains = {"gazebo_ros_control": {"pid_gains": {"one": {"p": 100.0, "d": 20.0}}}}
    arm = Arm(parameters=gains, forward=FORWARD)
    arm.run("forward")
    arm.deliver("forward/command", data=0.5)
    arm.context.advance(3.0)
    assert arm.context.joints["one"].servo.drive_gains.p == 100.0
    assert arm.at() == pytest.approx(0.5, abs=1e-3)


def test_limits_on_the_parameter_server_come_before_those_of_the_description():
    arm = Arm(parameters={"joint_limits": {"one": {
        "has_position_limits": True, "min_position": -0.1, "max_position": 0.1}}}, forward=FORWARD)
    arm.run("forward")
    arm.deliver("forward/command", data=2.0)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(0.1, abs=1e-6)


STOP = "<eStopTopic>stop</eStopTopic>"
RATE = {"type": "velocity_controllers/JointVelocityController", "joint": "one"}
PUSH = {"type": "effort_controllers/JointEffortController", "joint": "one"}


def test_the_emergency_stop_holds_positions_until_it_is_over():
    arm = Arm(inside=STOP, forward=FORWARD)
    arm.run("forward")
    arm.deliver("forward/command", data=2.0)
    arm.context.advance(0.02)
    arm.deliver("stop", data=True)
    halted = arm.at()
    arm.deliver("forward/command", data=-1.0)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(halted, abs=1e-6)
    arm.deliver("stop", data=False)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(halted, abs=1e-6)   # restarted at the joint's position
    arm.deliver("forward/command", data=1.0)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(1.0, abs=1e-6)


def test_controllers_run_and_joint_states_come_during_the_emergency_stop():
    arm = Arm(inside=STOP, forward=FORWARD, states=STATE)
    arm.run("forward", "states")
    arm.deliver("stop", data=True)
    arm.context.advance(0.1)
    assert arm.states() == {"forward": "running", "states": "running"}
    assert [one.header.stamp.to_nsec() for one in arm.published("joint_states")] == [
        20e6, 40e6, 60e6, 80e6, 100e6]


@pytest.mark.parametrize(("interface", "controller"), [
    ("VelocityJointInterface", RATE), ("EffortJointInterface", PUSH),
    ("PositionJointInterface", FORWARD)])
def test_a_controller_that_is_started_during_the_emergency_stop_drives_after_it(
        interface, controller):
    arm = Arm(interface, inside=STOP, late=controller)
    arm.deliver("stop", data=True)
    arm.run("late")
    arm.deliver("late/command", data=2.0)
    arm.context.advance(0.5)
    assert arm.at() == pytest.approx(0.0, abs=1e-9)
    arm.deliver("stop", data=False)
    arm.deliver("late/command", data=2.0)
    arm.context.advance(0.5)
    assert arm.at() > 0.1


@pytest.mark.parametrize("event", ["reset", "clock_set"])
def test_a_reset_during_the_emergency_stop_leaves_controllers_running_and_joints_at_rest(event):
    arm = Arm(inside=STOP, forward=FORWARD)
    arm.run("forward")
    arm.deliver("forward/command", data=2.0)
    arm.context.advance(0.02)
    arm.deliver("stop", data=True)
    if event == "reset":
        arm.context.joints["one"].position = 0.0
    getattr(arm.plugin, event)()
    begun = arm.at()
    arm.deliver("forward/command", data=1.0)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(begun, abs=1e-6)
    assert arm.states() == {"forward": "running"}
    arm.deliver("stop", data=False)
    arm.deliver("forward/command", data=1.0)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(1.0, abs=1e-6)


def test_a_controller_that_is_loaded_anew_during_the_emergency_stop_is_the_one_that_goes_on():
    arm = Arm(inside=STOP, forward=FORWARD)
    arm.run("forward")
    arm.deliver("stop", data=True)
    assert arm.switch((), ["forward"])
    assert arm.ask("unload_controller", name="forward").ok
    arm.run("forward")
    arm.deliver("stop", data=False)
    arm.deliver("forward/command", data=1.0)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(1.0, abs=1e-6)


def test_loops_between_interface_and_joint_hold_still_during_the_emergency_stop():
    gains = {"gazebo_ros_control": {"pid_gains": {"one": {"p": 100.0, "d": 20.0}}}}
    arm = Arm(inside=STOP, parameters=gains, forward=FORWARD)
    arm.run("forward")
    arm.deliver("stop", data=True)
    arm.deliver("forward/command", data=0.5)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(0.0, abs=1e-6)
    assert arm.context.joints["one"].servo.drive_gains.p == 100.0


def test_a_reset_starts_controllers_anew_where_joints_are():
    arm = Arm(forward=FORWARD)
    arm.run("forward")
    arm.deliver("forward/command", data=2.0)
    arm.context.advance(1.0)
    arm.context.joints["one"].position = 0.0
    arm.plugin.reset()
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(0.0, abs=1e-9)
    assert arm.states() == {"forward": "running"}


def test_a_transmission_without_an_actuator_works_and_is_reported():
    assert not any("<actuator>" in text for text in Arm().context.log_messages)
    arm = Arm(actuated=False, lift={"type": "position_controllers/JointPositionController",
                                    "joint": "one"})
    assert [text for text in arm.context.log_messages if "<actuator>" in text] == [
        f"transmission '{joint}_trans' of joint '{joint}' has no <actuator>; here controllers can"
        " move the joint, but gazebo_ros_control ignores such a transmission"
        for joint in ("one", "two")]
    assert arm.load("lift") and arm.switch(["lift"])


def test_a_robot_without_transmissions_is_told_so():
    arm = Arm(interfaces=(), joint_state_controller=STATE)
    assert "no <transmission>" in arm.context.log_messages[0]
    arm.run("joint_state_controller")
    arm.context.advance(0.1)
    assert [one.name for one in arm.published("joint_states")] == [[]] * 5


def test_what_comes_while_a_controller_does_not_run_is_told_once():
    arm = Arm(forward=FORWARD)
    assert arm.load("forward")
    for _ in range(3):
        arm.deliver("forward/command", data=2.0)
    assert sum("is not running" in text for text in arm.context.log_messages) == 1


@pytest.mark.parametrize(("inside", "place"), [
    ("", "robot/controller_manager"), ("<robotNamespace/>", "controller_manager"),
    ("<robotNamespace> </robotNamespace>", "controller_manager"),
    ("<robotNamespace>left</robotNamespace>", "left/controller_manager")])
def test_the_manager_is_in_the_namespace_that_the_element_says(inside, place):
    arm = Arm(inside=inside)
    assert f"{place}/list_controllers" in arm.context.services
