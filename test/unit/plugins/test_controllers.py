"""Controllers of single joints, groups, grippers and two-wheeled robots."""
from __future__ import annotations

import math

import pytest
from planar_pose import planar_pose
from robot_control import Arm, Message, Span

from my_simulations.description.model import JointAxis, SoftLimits
from my_simulations.plugins.actions import ABORTED, PREEMPTED, REJECTED, SUCCEEDED

EFFORT = "hardware_interface/EffortJointInterface"
VELOCITY = "hardware_interface/VelocityJointInterface"
PD = {"p": 100.0, "d": 20.0}   # critically damped on 1 kg m^2


def test_a_position_command_is_followed_no_faster_than_the_joint_may():
    slow = JointAxis((0.0, 0.0, 1.0), lower=-3.0, upper=3.0, effort=10.0, velocity=0.5)
    arm = Arm(axis=slow, go={"type": "position_controllers/JointPositionController",
                             "joint": "one"})
    arm.run("go")
    arm.deliver("go/command", data=1.0)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(0.5, abs=1e-3)


def test_a_group_takes_a_value_for_each_joint():
    arm = Arm(VELOCITY, group={"type": "velocity_controllers/JointGroupVelocityController",
                               "joints": ["one", "two"]})
    arm.run("group")
    arm.deliver("group/command", data=[1.0, -2.0])
    arm.context.advance(0.5)
    assert (arm.at("one"), arm.at("two")) == pytest.approx((0.5, -1.0))
    arm.deliver("group/command", data=[1.0])
    assert "of 1" in arm.context.log_messages[-1]


def test_stopping_a_velocity_controller_stops_the_joint():
    arm = Arm(VELOCITY, turn={"type": "velocity_controllers/JointVelocityController",
                              "joint": "one"})
    arm.run("turn")
    arm.deliver("turn/command", data=1.0)
    arm.context.advance(0.5)
    arm.switch((), ["turn"])
    arm.context.advance(0.5)
    assert arm.at() == pytest.approx(0.5)


def test_a_loop_about_a_position_is_a_spring_and_a_damper():
    arm = Arm(EFFORT, go={"type": "effort_controllers/JointPositionController", "joint": "one",
                          "pid": PD})
    arm.run("go")
    arm.context.advance(0.001)
    arm.deliver("go/command", data=0.5)
    arm.context.advance(0.2)
    t = 0.2
    assert arm.at() == pytest.approx(0.5 * (1.0 - (1.0 + 10.0 * t) * math.exp(-10.0 * t)),
                                     rel=0.15)
    arm.context.advance(3.0)
    assert arm.at() == pytest.approx(0.5, abs=1e-6)
    state = arm.published("go/state")[-1]
    assert (state.set_point, state.p, state.d) == (0.5, 100.0, 20.0)
    assert state.process_value == pytest.approx(0.5, abs=1e-6)


def test_a_loop_about_a_position_keeps_within_the_limits():
    arm = Arm(EFFORT, go={"type": "effort_controllers/JointPositionController", "joint": "one",
                          "pid": PD})
    arm.run("go")
    arm.deliver("go/command", data=9.0)
    arm.context.advance(5.0)
    assert arm.at() == pytest.approx(3.0, abs=1e-3)


def test_a_loop_about_a_rate_reaches_it():
    arm = Arm(EFFORT, turn={"type": "effort_controllers/JointVelocityController", "joint": "one",
                            "pid": {"p": 20.0}})
    arm.run("turn")
    arm.deliver("turn/command", data=2.0)
    arm.context.advance(0.1)
    assert arm.context.joints["one"].velocity == pytest.approx(2.0 * (1.0 - math.exp(-2.0)),
                                                               rel=0.02)


def test_a_group_of_positions_with_loops():
    arm = Arm(EFFORT, go={"type": "effort_controllers/JointGroupPositionController",
                          "joints": ["one", "two"], "one": {"pid": PD}, "two": {"pid": PD}})
    arm.run("go")
    arm.deliver("go/command", data=[0.5, -0.5])
    arm.context.advance(3.0)
    assert (arm.at("one"), arm.at("two")) == pytest.approx((0.5, -0.5), abs=1e-4)


def gripper(**settings):
    arm = Arm(grip={"type": "position_controllers/GripperActionController", "joint": "one",
                    **settings})
    arm.run("grip")

    def send(position, effort=0.0, name="g"):
        arm.deliver("grip/gripper_cmd/goal", goal_id=Message(id=name, stamp=Span()),
                 goal=Message(command=Message(position=position, max_effort=effort)))

    def results():
        return [(one.status.status, one.result.reached_goal, one.result.stalled)
                for one in arm.published("grip/gripper_cmd/result")]
    return arm, send, results


def test_a_gripper_reaches_its_goal():
    arm, send, results = gripper()
    send(0.2)
    arm.context.advance(0.5)
    assert results() == [(SUCCEEDED, True, False)]
    assert arm.at() == pytest.approx(0.2, abs=0.01)


def test_a_gripper_stops_the_engine_only_while_it_has_a_goal():
    arm, send, results = gripper()
    before = arm.context.stops
    send(0.2)
    assert arm.context.stops == before + 1
    arm.context.advance(2.0)
    assert arm.context.stops == before


def test_a_gripper_that_holds_something_stalls():
    arm, send, results = gripper(stall_timeout=0.3)
    send(0.2, effort=5.0)
    joint = arm.context.joints["one"]
    assert joint.servo.most_effort == 5.0
    arm.context.advance(0.002)
    joint.stuck = True
    arm.context.advance(0.25)
    assert results() == []
    arm.context.advance(0.25)
    assert results() == [(ABORTED, False, True)]


@pytest.mark.parametrize("position, effort", [
    (math.nan, 0.0), (math.inf, 0.0), (0.2, math.nan)])
def test_a_gripper_rejects_what_is_no_number_and_goes_on(position, effort):
    arm, send, results = gripper()
    send(0.2)
    send(position, effort, name="bad")
    assert results() == [(REJECTED, False, False)]
    arm.context.advance(0.5)
    assert results()[1:] == [(SUCCEEDED, True, False)]
    assert arm.at() == pytest.approx(0.2, abs=0.01)


def test_a_gripper_stalls_no_step_before_its_time():
    """0.3 s are 300000000 ns, whose product with 1e-9 is above 0.3."""
    arm, send, results = gripper(stall_timeout=0.3)
    arm.context.joints["one"].stuck = True
    send(0.2)
    arm.context.advance(0.3)
    assert results() == []
    arm.context.advance(0.01)
    assert results() == [(ABORTED, False, True)]


def test_a_gripper_stalls_also_when_the_clock_is_set_back():
    arm, send, results = gripper(stall_timeout=0.3)
    arm.context.advance(60.0)
    arm.context.joints["one"].stuck = True
    send(0.2)
    arm.context.step = 0
    arm.context.advance(0.35)
    assert results() == [(ABORTED, False, True)]


def test_another_goal_takes_over_from_the_first():
    arm, send, results = gripper()
    send(0.2, name="a")
    send(0.1, name="b")
    assert results() == [(PREEMPTED, False, False)]
    arm.context.advance(0.5)
    assert results()[1] == (SUCCEEDED, True, False)


def base(**settings):
    drive = {"type": "diff_drive_controller/DiffDriveController", "left_wheel": "one",
             "right_wheel": ["two"], "wheel_separation": 0.5, "wheel_radius": 0.1, **settings}
    free = JointAxis((0.0, 1.0, 0.0))
    arm = Arm(VELOCITY, axis=free, drive=drive)
    arm.run("drive")
    return arm


def go(arm, x, yaw, seconds):
    for _ in range(round(seconds / 0.1)):
        arm.deliver("drive/cmd_vel", linear={"x": x}, angular={"z": yaw})
        arm.context.advance(0.1)


def test_wheels_turn_as_the_command_says():
    arm = base()
    go(arm, 0.3, 1.0, 0.2)
    one, two = (arm.context.joints[name].velocity for name in ("one", "two"))
    assert (one, two) == pytest.approx(((0.3 - 0.25) / 0.1, (0.3 + 0.25) / 0.1))


def test_a_circle_closes_in_the_odometry():
    arm = base()
    go(arm, 0.2, 0.4, 2.0)
    x, y, yaw = planar_pose(arm.published("drive/odom")[-1].pose.pose)
    assert (x, y) == pytest.approx(
        (0.5 * math.sin(yaw), 0.5 * (1.0 - math.cos(yaw))), abs=1e-6)
    twist = arm.published("drive/odom")[-1].twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((0.2, 0.4))
    assert {one[:2] for one in arm.context.transforms} == {("odom", "base_link")}


def test_states_of_the_wheels_are_published_if_they_are_asked_for():
    topic = "drive/wheel_joint_controller_state"
    plain = base()
    go(plain, 0.3, 1.0, 0.2)
    assert not any(name.endswith(topic) for name in plain.context.published)
    arm = base(publish_wheel_joint_controller_state=True)
    go(arm, 0.3, 1.0, 0.5)
    message = arm.published(topic)[-1]
    assert message.joint_names == ["one", "two"]
    assert message.desired.velocities == pytest.approx([0.5, 5.5])
    assert message.actual.velocities == pytest.approx([0.5, 5.5])
    assert message.desired.positions == pytest.approx([0.25, 2.75], rel=0.05)
    assert message.error.positions == pytest.approx(
        [a - b for a, b in zip(message.desired.positions, message.actual.positions)])
    assert message.actual.accelerations == pytest.approx([0.0, 0.0], abs=1e-9)


def test_accelerations_are_limited_and_old_commands_forgotten():
    arm = base(linear={"x": {"has_acceleration_limits": True, "max_acceleration": 1.0,
                             "has_velocity_limits": True, "max_velocity": 0.4}},
               publish_cmd=True)
    go(arm, 2.0, 0.0, 0.3)
    assert arm.context.joints["one"].velocity == pytest.approx(3.0, abs=0.11)
    go(arm, 2.0, 0.0, 0.5)
    assert arm.context.joints["one"].velocity == pytest.approx(4.0)
    arm.context.advance(1.1)
    assert arm.context.joints["one"].velocity == 0.0
    assert max(one.twist.linear.x for one in arm.published("drive/cmd_vel_out")) == 0.4


@pytest.mark.parametrize("seconds", [0.29, 0.3])
def test_a_base_heeds_a_command_to_the_last_step_of_its_time(seconds):
    """Their nanoseconds times 1e-9 are above them."""
    arm = base(cmd_vel_timeout=seconds)
    arm.deliver("drive/cmd_vel", linear={"x": 0.4}, angular={"z": 0.0})
    arm.context.advance(seconds)
    assert arm.context.joints["one"].servo.target == pytest.approx(4.0)
    arm.context.advance(0.01)
    assert arm.context.joints["one"].servo.target == 0.0


def test_a_jerk_is_limited():
    arm = base(linear={"x": {"has_jerk_limits": True, "max_jerk": 5.0}}, publish_cmd=True)
    go(arm, 1.0, 0.0, 0.1)
    speeds = [one.twist.linear.x for one in arm.published("drive/cmd_vel_out")]
    ramps = [b - a for a, b in zip([0.0, *speeds], speeds)]
    assert max(b - a for a, b in zip(ramps, ramps[1:])) <= 2.0 * 5.0 * 0.01 ** 2 + 1e-12


def test_wheels_without_a_radius_are_told():
    arm = Arm(VELOCITY, drive={"type": "diff_drive_controller/DiffDriveController",
                               "left_wheel": "one", "right_wheel": "two",
                               "wheel_separation": 0.5})
    assert not arm.load("drive")
    assert "wheel_radius" in arm.context.log_messages[-1]


@pytest.mark.parametrize("kind", ["Velocity", "Position", "Effort"])
def test_soft_limits_do_not_hold_a_joint_without_position_limits(kind):
    """As `<safety_controller k_velocity="10"/>` of wheels: it has soft limits of 0, and no gain."""
    robot = Arm(f"hardware_interface/{kind}JointInterface",
                axis=JointAxis((0.0, 0.0, 1.0), velocity=20.0, effort=5.0,
                               soft=SoftLimits(0.0, 0.0, 0.0, 10.0)),
                go={"type": f"{kind.lower()}_controllers/Joint{kind}Controller", "joint": "one"})
    robot.run("go")
    robot.deliver("go/command", data=2.0)
    robot.context.advance(1.0)
    assert robot.at() == pytest.approx(1.0 if kind == "Effort" else 2.0, rel=0.01)
