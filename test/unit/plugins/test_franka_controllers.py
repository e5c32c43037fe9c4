"""Controllers of franka_gazebo: the joint states of the arm, and the gripper."""
from __future__ import annotations

import pytest
from robot_control import Arm, Message, Span

from my_simulations.plugins.actions import ABORTED, PREEMPTED, REJECTED, SUCCEEDED

EFFORT = "hardware_interface/EffortJointInterface"
GAINS = {"p": 100.0, "i": 25.0, "d": 20.0}
GRIPPER = {"type": "franka_gazebo/FrankaGripperSim", "finger1": {"joint": "one", "gains": GAINS},
           "finger2": {"joint": "two", "gains": GAINS}, "grasp": {"resting_threshold": 0.01}}


ACTIONS = {
    "Move": ("float64 width\nfloat64 speed\n", "bool success\nstring error\n"),
    "Grasp": ("float64 width\nGraspEpsilon epsilon\nfloat64 speed\nfloat64 force\n",
              "bool success\nstring error\n"),
    "Homing": ("", "bool success\nstring error\n"), "Stop": ("", "bool success\nstring error\n")}


@pytest.fixture
def hand(tmp_path, monkeypatch):
    """A gripper in a workspace that has the messages of franka_gripper."""
    folder = tmp_path / "franka_gripper"
    (folder / "msg").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>franka_gripper</name></package>")
    files = {"GraspEpsilon": "float64 inner\nfloat64 outer\n"}
    for name, (goal, result) in ACTIONS.items():
        status = "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n"
        files.update({
            f"{name}Goal": goal, f"{name}Result": result, f"{name}Feedback": "",
            f"{name}ActionGoal": "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n"
                                 f"{name}Goal goal\n",
            f"{name}ActionResult": f"{status}{name}Result result\n",
            f"{name}ActionFeedback": f"{status}{name}Feedback feedback\n"})
    for name, text in files.items():
        (folder / "msg" / f"{name}.msg").write_text(text)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    return Gripper()


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

    def ask_for(self, action, name="g", **goal):
        """Send a goal of an action of franka_gripper."""
        self.deliver(f"grip/{action}/goal", goal_id=Message(id=name, stamp=Span()),
                     goal=Message(**goal))

    def ended(self, action):
        """Status, success and reason of the goals of an action that have ended."""
        return [(one.status.status, one.result.success, one.result.error)
                for one in self.published(f"grip/{action}/result")]

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


def test_a_hand_moves_to_a_width_at_a_speed(hand):
    hand.ask_for("move", width=0.03, speed=0.1)
    hand.context.advance(0.3)
    assert hand.ended("move") == []
    hand.context.advance(0.6)
    assert hand.ended("move") == [(SUCCEEDED, True, "")]
    assert 2.0 * hand.at("one") == pytest.approx(0.03, abs=2e-3)


def test_a_hand_grasps_an_object_of_the_wanted_width_and_presses_it(hand):
    hand.ask_for("grasp", width=0.03, epsilon=Message(inner=0.005, outer=0.005), speed=0.1,
                 force=10.0)
    hand.stop_at(0.016)
    assert hand.ended("grasp") == [(SUCCEEDED, True, "")]
    finger = hand.context.joints["one"]
    finger.velocity = 0.0
    hand.context.advance(0.01)   # released: each finger is pressed with half of the force
    assert finger.velocity == pytest.approx(-5.0 * 0.01, rel=0.15)   # 1 kg
    hand.ask_for("stop")
    assert hand.ended("stop") == [(SUCCEEDED, True, "")]
    finger.velocity = 0.0
    hand.context.advance(0.01)
    assert abs(finger.velocity) < 0.01


def test_a_grasp_of_another_width_fails_with_the_width(hand):
    hand.ask_for("grasp", width=0.03, epsilon=Message(inner=0.005, outer=0.005), speed=0.1,
                 force=10.0)
    hand.stop_at(0.01)
    ((status, success, error),) = hand.ended("grasp")
    assert (status, success) == (ABORTED, False)
    assert "rest at a width of 0.0200 m, not at 0.0300 m" in error


def test_homing_closes_and_opens_the_fingers(hand):
    hand.ask_for("homing")
    hand.stop_at(0.0)
    assert hand.ended("homing") == [] and hand.at("one") < 0.012
    hand.context.advance(6.0)
    assert hand.ended("homing") == [(SUCCEEDED, True, "")]
    assert hand.at("one") == pytest.approx(0.04, abs=1e-3)


def test_goals_of_a_hand_are_replaced_stopped_and_checked(hand):
    hand.ask_for("move", "a", width=0.0, speed=0.01)
    hand.send(0.01, name="b")
    hand.ask_for("stop", "c")
    assert hand.ended("move") == [(PREEMPTED, False, "another goal came")]
    assert [status for status, *_ in hand.results()] == [PREEMPTED]
    for goal, word in (({"width": 0.09, "speed": 0.1}, "0 to 0.08 m"),
                       ({"width": 0.01, "speed": -0.1}, "negative"),
                       ({"width": float("nan"), "speed": 0.1}, "not finite")):
        hand.ask_for("move", word, **goal)
        status, success, error = hand.ended("move")[-1]
        assert (status, success) == (ABORTED, False) and word in error


def test_without_franka_gripper_there_is_gripper_action_alone():
    arm = Gripper()
    assert "grip/move/result" not in " ".join(arm.context.published)
    assert any("move, grasp, homing and stop" in text for text in arm.context.log_messages)


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
