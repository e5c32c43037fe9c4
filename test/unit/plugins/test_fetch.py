"""The controllers of Fetch in a world without physics."""
from __future__ import annotations

import math

import pytest
from robot_control import Message, Span, trajectory

from my_simulations.description.model import Joint, JointAxis, Link, Model
from my_simulations.plugins.actions import ABORTED, PREEMPTED, SUCCEEDED
from my_simulations.plugins.control.fetch import FetchGazebo
from my_simulations.plugins.testing import FakeContext

ARM = ("shoulder_pan_joint", "elbow_flex_joint")
FINGERS = ("l_gripper_finger_joint", "r_gripper_finger_joint")
HEAD = ("head_pan_joint", "head_tilt_joint")
WHEELS = ("l_wheel_joint", "r_wheel_joint")
NAMES = (*WHEELS, "torso_lift_joint", "bellows_joint", *HEAD, *ARM, *FINGERS)
TRAJECTORY = "robot_controllers/FollowJointTrajectoryController"
CONTROLLERS = {
    "arm_controller": {
        "follow_joint_trajectory": {"type": TRAJECTORY, "joints": list(ARM)},
        "gravity_compensation": {"type": "robot_controllers/GravityCompensation"}},
    "arm_with_torso_controller": {"follow_joint_trajectory": {
        "type": TRAJECTORY, "joints": ["torso_lift_joint", *ARM]}},
    "head_controller": {"point_head": {"type": "robot_controllers/PointHeadController"}},
    "base_controller": {"type": "robot_controllers/DiffDriveBaseController",
                        "max_acceleration_x": 1.5},
    "gripper_controller": {"gripper_action": {
        "type": "robot_controllers/ParallelGripperController"}},
    "bellows_controller": {"type": "robot_controllers/ScaledMimicController", "mimic_scale": 0.5}}
DEFAULTS = ["arm_controller/follow_joint_trajectory", "arm_controller/gravity_compensation",
            "arm_with_torso_controller/follow_joint_trajectory", "head_controller/point_head",
            "base_controller", "gripper_controller/gripper_action", "bellows_controller"]


class Fetch:
    def __init__(self, defaults=DEFAULTS, **more):
        self.context = FakeContext("<plugin/>", joints=NAMES)
        wide = JointAxis((0.0, 0.0, 1.0), lower=-1e16, upper=1e16, effort=20.0, velocity=20.0)
        narrow = JointAxis((0.0, 0.0, 1.0), lower=-2.0, upper=2.0, effort=20.0, velocity=2.0)
        links = {"head_pan_joint": ("torso", "pan"), "head_tilt_joint": ("pan", "tilt")}
        joints = [Joint(name, "revolute", *links.get(name, ("base", name)),
                        axis=wide if name in WHEELS else narrow) for name in NAMES]
        self.context.description = Model("fetch", joints=joints, links=[
            Link("base"), *(Link(joint.child) for joint in joints)])
        for joint in joints:
            found = self.context.joints[joint.name]
            found.spec, found.parent, found.child = joint, joint.parent, joint.child
        gains = {"position": {"p": 50.0, "i": 0.0, "d": 0.1}}
        self.context.ros_parameters = {
            **CONTROLLERS, **more,
            "gazebo": {"default_controllers": defaults, **dict.fromkeys(NAMES, gains)}}
        self.plugin = self.context.load(FetchGazebo)

    def at(self, *names):
        return [self.context.joints[name].position for name in names]

    def move(self, controller, names, *points, goal="g"):
        self.context.deliver(
            f"{controller}/follow_joint_trajectory/goal", goal_id=Message(id=goal, stamp=Span()),
            goal=Message(trajectory=trajectory(names, *points), path_tolerance=[],
                         goal_tolerance=[], goal_time_tolerance=Span()))

    def results(self, action):
        return [(one.status.goal_id.id, one.status.status)
                for one in self.context.published.get(f"{action}/result", [])]

    def last(self, topic):
        return self.context.published[topic][-1]


def test_an_arm_follows_a_trajectory_by_rates():
    fetch = Fetch()
    fetch.move("arm_controller", ARM, (1.0, (0.5, -0.4), (0.0, 0.0)))
    fetch.context.advance(0.5)
    assert fetch.at(*ARM) == pytest.approx([0.25, -0.2], abs=1e-3)
    fetch.context.advance(1.0)
    assert fetch.at(*ARM) == pytest.approx([0.5, -0.4], abs=1e-3)
    assert fetch.results("arm_controller/follow_joint_trajectory") == [("g", SUCCEEDED)]


def test_a_controller_stops_others_that_use_its_joints():
    fetch = Fetch()
    fetch.move("arm_controller", ARM, (4.0, (1.0, 1.0)))
    fetch.context.advance(0.5)
    names = ("torso_lift_joint", *ARM)
    fetch.move("arm_with_torso_controller", names, (1.0, (0.3, 0.0, 0.0)), goal="h")
    fetch.context.advance(2.0)
    assert fetch.results("arm_controller/follow_joint_trajectory") == [("g", PREEMPTED)]
    assert fetch.results("arm_with_torso_controller/follow_joint_trajectory") == [
        ("h", SUCCEEDED)]
    assert fetch.at(*names) == pytest.approx([0.3, 0.0, 0.0], abs=1e-3)


def test_joints_without_a_goal_stay_and_the_bellows_follow_the_torso():
    fetch = Fetch()
    assert all(fetch.context.joints[name].servo.holds for name in (*ARM, "torso_lift_joint"))
    assert fetch.context.followers == {"bellows_joint": ("torso_lift_joint", 0.5, 0.0)}
    assert fetch.context.joints["bellows_joint"].servo is None


def test_the_base_follows_commands_for_a_quarter_of_a_second_within_its_acceleration():
    fetch = Fetch()
    for _ in range(10):
        fetch.context.deliver("base_controller/command", linear={"x": 0.6}, angular={"z": 0.0})
        fetch.context.advance(0.02)
    assert fetch.context.joints["l_wheel_joint"].velocity == pytest.approx(
        0.2 * 1.5 * 16.5289, rel=0.15)
    for _ in range(30):
        fetch.context.deliver("base_controller/command", linear={"x": 0.6}, angular={"z": 0.5})
        fetch.context.advance(0.02)
    left, right = (fetch.context.joints[name].velocity for name in WHEELS)
    assert (left + right) / 2.0 == pytest.approx(0.6 * 16.5289)
    assert (right - left) == pytest.approx(0.5 * 0.37476 * 16.5289)
    odom = fetch.last("odom")
    assert (odom.header.frame_id, odom.child_frame_id) == ("odom", "base_link")
    assert odom.pose.pose.position.x > 0.3
    fetch.context.advance(1.0)
    assert fetch.context.joints["l_wheel_joint"].velocity == 0.0


def grip(fetch, position, effort=0.0):
    fetch.context.deliver("gripper_controller/gripper_action/goal",
                          goal_id=Message(id="g", stamp=Span()),
                          goal=Message(command=Message(position=position, max_effort=effort)))


def test_the_gripper_opens_both_fingers_and_succeeds():
    fetch = Fetch()
    grip(fetch, 0.08, 5.0)
    fetch.context.advance(1.0)
    assert fetch.at(*FINGERS) == pytest.approx([0.04, 0.04], abs=1e-3)
    assert fetch.context.joints[FINGERS[0]].servo.most_effort == 5.0
    result = fetch.last("gripper_controller/gripper_action/result")
    assert result.status.status == SUCCEEDED and result.result.reached_goal


def test_a_gripper_that_is_blocked_succeeds_as_stalled():
    fetch = Fetch()
    for name in FINGERS:
        fetch.context.joints[name].stuck = True
    grip(fetch, 0.08)
    fetch.context.advance(1.9)
    assert fetch.results("gripper_controller/gripper_action") == []
    fetch.context.advance(0.3)
    result = fetch.last("gripper_controller/gripper_action/result").result
    assert result.stalled and not result.reached_goal
    assert fetch.context.joints[FINGERS[0]].servo.most_effort == 10.0


def look(fetch, frame, x, y, z):
    fetch.context.deliver(
        "head_controller/point_head/goal", goal_id=Message(id="g", stamp=Span()),
        goal=Message(target=Message(header=Message(frame_id=frame),
                                    point={"x": x, "y": y, "z": z}),
                     min_duration=Span(0.5), max_velocity=0.0))


def test_the_head_faces_a_point():
    fetch = Fetch()
    still = {"translation": {"x": 0.0, "y": 0.0, "z": 0.0},
             "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
    fetch.context.deliver("/tf", transforms=[
        Message(header=Message(frame_id=parent), child_frame_id=child, transform=Message(**still))
        for parent, child in (("base", "torso"), ("torso", "pan"))])
    look(fetch, "base", 1.0, 1.0, -math.sqrt(2.0))
    fetch.context.advance(0.4)
    assert fetch.results("head_controller/point_head") == []
    fetch.context.advance(0.8)
    assert fetch.at(*HEAD) == pytest.approx([math.pi / 4.0, math.pi / 4.0], abs=1e-3)
    assert fetch.results("head_controller/point_head") == [("g", SUCCEEDED)]


def test_a_point_without_a_transform_is_an_abort():
    fetch = Fetch()
    look(fetch, "nowhere", 1.0, 0.0, 0.0)
    fetch.context.advance(0.1)
    assert fetch.results("head_controller/point_head") == [("g", ABORTED)]


def test_joint_states_have_all_joints_and_angles_that_wrap():
    fetch = Fetch()
    fetch.context.joints["l_wheel_joint"].put(7.0)
    fetch.context.advance(0.05)
    states = fetch.last("joint_states")
    assert set(states.name) == set(NAMES)
    assert states.position[states.name.index("l_wheel_joint")] == pytest.approx(
        7.0 - 2.0 * math.pi)


def test_a_reset_ends_goals():
    fetch = Fetch()
    fetch.move("arm_controller", ARM, (4.0, (1.0, 1.0)))
    fetch.context.advance(0.5)
    fetch.plugin.reset()
    assert fetch.results("arm_controller/follow_joint_trajectory") == [("g", PREEMPTED)]
    assert fetch.context.joints[ARM[0]].servo.holds


def test_an_unknown_controller_is_named_and_the_others_run():
    fetch = Fetch([*DEFAULTS, "spin"], spin={"type": "robot_controllers/Spin"})
    assert "Spin" in fetch.context.log_messages[-1]
    fetch.move("arm_controller", ARM, (0.1, (0.1, 0.1)))
    fetch.context.advance(0.5)
    assert fetch.results("arm_controller/follow_joint_trajectory") == [("g", SUCCEEDED)]
