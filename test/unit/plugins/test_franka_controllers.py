"""Controllers of franka_gazebo: the joint states of the arm, and the gripper."""
from __future__ import annotations

import pytest
from robot_control import Arm, Message, Span

from my_simulations.plugins.actions import ABORTED, PREEMPTED, REJECTED, SUCCEEDED

EFFORT = "hardware_interface/EffortJointInterface"
GAINS = {"p": 100.0, "i": 25.0, "d": 20.0}
GRIPPER = {"type": "franka_gazebo/FrankaGripperSim", "finger1": {"joint": "one", "gains": GAINS},
           "finger2": {"joint": "two", "gains": GAINS}, "grasp": {"resting_threshold": 0.01}}


class Gripper(Arm):
    """Two fingers of 1 kg, which begin open."""

    def __init__(self, **settings):
        super().__init__(EFFORT, grip={**GRIPPER, **settings})
        for finger in ("one", "two"):
            self.context.joints[finger].position = 0.04
        self.run("grip")

    def send(self, position, effort=0.0, name="g"):
        self.deliver("grip/gripper_action/goal", goal_id=Message(id=name, stamp=Span()),
                     goal=Message(command=Message(position=position, max_effort=effort)))

    def stop_at(self, position):
        """Close for 3 s; an object between the fingers stops both at a position."""
        joints = [self.context.joints[finger] for finger in ("one", "two")]
        for _ in range(3000):
            self.context.advance(0.001)
            for joint in joints:
                if joint.position <= position:
                    joint.position, joint.velocity = position, 0.0

    def results(self):
        return [(one.status.status, one.result.reached_goal, round(one.result.position, 4))
                for one in self.published("grip/gripper_action/result")]


def test_fingers_close_on_an_object_and_press_it():
    arm = Gripper()
    arm.send(0.02, 10.0)
    arm.stop_at(0.02)
    assert arm.results() == [(SUCCEEDED, True, 0.04)]
    finger = arm.context.joints["one"]
    finger.velocity = 0.0
    arm.context.advance(0.01)   # released: each finger is pressed with half of the effort
    assert finger.velocity == pytest.approx(-5.0 * 0.01, rel=0.15)   # 1 kg


@pytest.mark.parametrize("effort", [0.0, 10.0])
def test_an_object_of_another_width_is_no_reached_goal_and_the_fingers_stay(effort):
    arm = Gripper()
    arm.send(0.0, effort)
    arm.stop_at(0.02)
    assert arm.results() == [(SUCCEEDED, False, 0.04)]
    arm.context.advance(2.0)
    assert arm.at("one") == pytest.approx(0.02, abs=1e-3)


def test_a_goal_without_effort_or_with_a_larger_width_ends_at_its_width():
    arm = Gripper()
    arm.send(0.02)
    arm.context.advance(3.0)
    ((status, reached, width),) = arm.results()
    assert (status, reached) == (SUCCEEDED, True) and width == pytest.approx(0.04, abs=0.006)
    arm.send(0.035, 10.0)
    arm.context.advance(3.0)
    assert arm.results()[-1][:2] == (SUCCEEDED, True)
    arm.send(0.05)
    assert arm.results()[-1][0] == ABORTED


def test_a_goal_is_replaced_and_cancelled_and_refused():
    arm = Gripper()
    arm.send(0.0, name="a")
    arm.send(0.0, name="b")
    arm.deliver("grip/gripper_action/cancel", id="b", stamp=Span())
    arm.send(float("nan"), name="c")
    assert [status for status, *_ in arm.results()] == [PREEMPTED, PREEMPTED, REJECTED]
    assert arm.switch((), ["grip"])
    arm.send(0.0, name="d")
    assert arm.results()[-1][0] == REJECTED


def test_the_engine_stops_for_the_gripper_only_while_it_has_a_goal():
    arm = Gripper()
    before = arm.context.stops
    arm.send(0.0)
    assert arm.context.stops > before
    arm.stop_at(0.0)
    assert arm.context.stops == before


def test_a_gripper_without_a_finger_or_gains_is_not_loaded():
    arm = Arm(EFFORT, grip={**GRIPPER, "finger2": {"joint": "two"}},
              other={"type": "franka_gazebo/FrankaGripperSim"})
    assert not arm.load("grip") and "finger2/gains" in arm.context.log_messages[-1]
    assert not arm.load("other") and "finger1/joint" in arm.context.log_messages[-1]


def test_joint_states_of_the_arm_and_of_the_gripper_are_below_the_names_of_the_controllers():
    arm = Arm(EFFORT, grip=GRIPPER, state={"type": "franka_control/FrankaStateController",
                                           "joint_names": ["two", "one"], "publish_rate": 10})
    arm.run("grip", "state")
    arm.context.advance(0.2)
    for topic in ("state/joint_states", "state/joint_states_desired"):
        message = arm.published(topic)[0]
        assert message.name == ["two", "one"] and len(message.effort) == 2
    assert arm.published("grip/joint_states")[-1].name == ["one", "two"]


def test_launch_files_that_wait_for_the_arm_go_on_and_a_loose_base_is_warned_of():
    arm = Arm(EFFORT, "<robotSimType>franka_gazebo/FrankaHWSim</robotSimType>")
    (message,) = arm.published("initialized")
    assert message.data is True
    assert any("gravity is not compensated" in text for text in arm.context.log_messages)
    assert not any("not simulated" in text for text in arm.context.log_messages)
