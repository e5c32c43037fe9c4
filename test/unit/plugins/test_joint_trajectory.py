"""joint_trajectory_controller: tracking, joining, tolerances, cancelling."""
from __future__ import annotations

import math

import pytest
from robot_control import Arm, Client, Message, Span, tolerance, trajectory

from my_simulations.description.model import JointAxis
from my_simulations.plugins.actions import ABORTED, ACTIVE, PREEMPTED, RECALLED, REJECTED, SUCCEEDED
from my_simulations.plugins.context import RequestError

NAMES = ("one", "two")
POSITION = {"type": "position_controllers/JointTrajectoryController", "joints": list(NAMES)}
EFFORT_LOOP = {"p": 400.0, "d": 40.0}
EFFORT = {"type": "effort_controllers/JointTrajectoryController", "joints": list(NAMES),
          "gains": {name: EFFORT_LOOP for name in NAMES}}


SLOW = JointAxis((0.0, 0.0, 1.0), lower=-3.0, upper=3.0, effort=100.0, velocity=0.5)


def arm_with(settings=None, **options):
    arm = Arm(arm={**POSITION, **(settings or {})}, **options)
    arm.run("arm")
    return arm, Client(arm, "arm")


def command(arm, wanted):
    arm.deliver("arm/command", **vars(wanted))


@pytest.mark.parametrize("states, law", [
    (((1.0, 2.0),), lambda t: t),
    (((1.0, 2.0), (0.0, 0.0)), lambda t: 3 * t ** 2 - 2 * t ** 3),
    (((1.0, 2.0), (0.0, 0.0), (0.0, 0.0)), lambda t: 10 * t ** 3 - 15 * t ** 4 + 6 * t ** 5),
], ids=("linear", "cubic", "quintic"))
def test_positions_follow_the_spline_that_the_point_says_enough_for(states, law):
    arm, _ = arm_with()
    command(arm, trajectory(NAMES, (1.0, *states)))
    for _ in range(10):
        arm.context.advance(0.1)
        t = arm.context.step * 1e-3
        assert arm.at("one") == pytest.approx(law(t), abs=1e-6)
        assert arm.at("two") == pytest.approx(2.0 * law(t), abs=1e-6)
    arm.context.advance(0.5)
    assert arm.at("two") == pytest.approx(2.0, abs=1e-6)
    assert arm.context.joints["one"].servo.spline is None  # nothing is computed any more


def test_an_effort_loop_follows():
    arm = Arm("hardware_interface/EffortJointInterface", arm=EFFORT)
    arm.run("arm")
    command(arm, trajectory(NAMES, (2.0, (1.0, 1.0), (0.0, 0.0), (0.0, 0.0))))
    worst = 0.0
    for _ in range(200):
        arm.context.advance(0.01)
        t = min(1.0, arm.context.step / 2000.0)
        worst = max(worst, abs(arm.at() - (10 * t ** 3 - 15 * t ** 4 + 6 * t ** 5)))
    acceleration = 10.0 / math.sqrt(3.0) / 4.0   # the greatest of the spline
    assert worst < 1.1 * acceleration / EFFORT_LOOP["p"]


def test_a_velocity_joint_follows_by_its_feedforward():
    arm = Arm("hardware_interface/VelocityJointInterface", arm={
        "type": "velocity_controllers/JointTrajectoryController", "joints": list(NAMES),
        "gains": {name: {"p": 10.0} for name in NAMES},
        "velocity_ff": {name: 1.0 for name in NAMES}})
    arm.run("arm")
    command(arm, trajectory(NAMES, (1.0, (1.0, 1.0), (0.0, 0.0))))
    arm.context.advance(0.5)
    assert arm.at() == pytest.approx(0.5, abs=2e-3)
    arm.context.advance(2.0)
    assert arm.at() == pytest.approx(1.0, abs=1e-6)


def test_a_goal_succeeds_at_its_end():
    arm, client = arm_with()
    goal = client.send(trajectory(NAMES, (0.5, (0.4, 0.4))))
    assert client.status == {goal: ACTIVE}
    arm.context.advance(0.45)
    assert client.results == []
    arm.context.advance(0.1)
    assert [one[:3] for one in client.results] == [(goal, SUCCEEDED, 0)]
    assert client.status == {goal: SUCCEEDED}
    arm.context.advance(6.0)
    assert client.status == {}


def test_feedback_tells_desired_actual_and_error():
    arm, client = arm_with()
    client.send(trajectory(NAMES, (1.0, (1.0, 1.0))))
    arm.context.advance(1.0)
    found = arm.published("arm/follow_joint_trajectory/feedback")
    assert 19 <= len(found) <= 21
    assert found[10].feedback.joint_names == list(NAMES)
    assert found[10].feedback.error.positions == pytest.approx([0.0, 0.0], abs=1e-6)


def test_a_path_that_cannot_be_followed_ends_the_goal_with_joint_and_error():
    arm, client = arm_with({"constraints": {"one": {"trajectory": 0.1}}}, axis=SLOW)
    goal = client.send(trajectory(NAMES, (1.0, (2.0, 0.0))))
    arm.context.advance(0.5)
    (result,) = client.results
    assert result[:3] == (goal, ABORTED, -4)
    assert result[3].startswith("one path error 0.1")


def test_a_goal_that_is_missed_ends_after_the_time_tolerance():
    arm, client = arm_with({"constraints": {"goal_time": 0.5, "one": {"goal": 0.01}}}, axis=SLOW)
    client.send(trajectory(NAMES, (0.5, (2.0, 0.0))))
    arm.context.advance(0.95)
    assert client.results == []
    arm.context.advance(0.1)
    (result,) = client.results
    assert result[1:3] == (ABORTED, -5)
    assert result[3].startswith("one goal error")


def test_tolerances_of_a_goal_come_before_those_of_the_parameters():
    arm, client = arm_with({"constraints": {"one": {"trajectory": 0.1}}}, axis=SLOW)
    client.send(trajectory(NAMES, (0.5, (0.5, 0.0))), path=[tolerance("one", -1.0)], late=5.0)
    arm.context.advance(2.0)
    assert client.results[0][1] == SUCCEEDED
    client.send(trajectory(NAMES, (0.5, (0.0, 2.0))), path=[tolerance("two", 0.01)])
    arm.context.advance(0.5)
    assert client.results[1][1:3] == (ABORTED, -4)


def test_another_goal_takes_over_smoothly():
    arm, client = arm_with()
    first = client.send(trajectory(NAMES, (1.0, (1.0, 1.0), (0.0, 0.0), (0.0, 0.0))))
    arm.context.advance(0.5)
    rate = arm.context.joints["one"].velocity
    second = client.send(trajectory(NAMES, (1.0, (0.0, 0.0), (0.0, 0.0), (0.0, 0.0))))
    assert client.results[0][:2] == (first, PREEMPTED)
    arm.context.advance(0.001)
    assert arm.context.joints["one"].velocity == pytest.approx(rate, rel=0.02)
    arm.context.advance(1.2)
    assert client.results[1][:2] == (second, SUCCEEDED)
    assert arm.at() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("end", [lambda arm, client, goal: client.cancel(goal),
                                 lambda arm, client, goal: arm.switch((), ["arm"])],
                         ids=("cancelled goal", "stopped controller"))
def test_a_goal_that_is_ended_stops_where_the_joints_are(end):
    arm, client = arm_with()
    goal = client.send(trajectory(NAMES, (1.0, (1.0, 1.0))))
    arm.context.advance(0.3)
    end(arm, client, goal)
    assert client.results[0][:2] == (goal, PREEMPTED)
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(0.3, abs=2e-3)


def test_a_cancel_waits_five_seconds_for_its_goal():
    for seconds, status in ((4.9, RECALLED), (5.3, ACTIVE)):
        arm, client = arm_with()
        client.cancel("g1")
        arm.context.advance(seconds)
        assert client.send(trajectory(NAMES, (1.0, (1.0, 1.0)))) == "g1"
        assert client.status == {"g1": status}


def test_cancels_of_goals_that_are_gone_are_forgotten():
    arm, client = arm_with()
    for n in range(5):
        client.cancel(f"old-{n}")
    arm.context.advance(5.3)
    action = arm.plugin._manager.controllers["arm"]._action
    assert action._early == []
    client.cancel("of a later clock")
    arm.context.step = 0
    arm.context.advance(0.2)
    assert action._early == []


def test_a_stop_may_take_its_time():
    arm, client = arm_with({"stop_trajectory_duration": 0.5})
    client.send(trajectory(NAMES, (1.0, (1.0, 1.0))))
    arm.context.advance(0.3)
    client.cancel()
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(0.3 + 0.25, abs=2e-3)   # v t / 2


@pytest.mark.parametrize("wanted, code, why", [
    (trajectory(("one",), (1.0, (1.0,))), -2, "joint 'two' is missing"),
    (trajectory(("one", "three"), (1.0, (1.0, 1.0))), -2, "'three' is not a joint"),
    (trajectory(NAMES, (1.0, (1.0,))), -1, "positions of 2 joints"),
    (trajectory(NAMES, (1.0, (1.0, 1.0), (0.0,))), -1, "velocities of 2 joints"),
    (trajectory(NAMES, (1.0, (1.0, 1.0, 1.0), (0.0, 0.0))), -1, "velocities of 3 joints"),
    (trajectory((), (1.0, (1.0, 1.0))), -2, "joint 'one' is missing"),
    (trajectory(()), -2, "joint 'one' is missing"),
    (trajectory(("one",)), -2, "joint 'two' is missing"),
    (trajectory(NAMES, (1.0, (1.0, 1.0)), (0.5, (1.0, 1.0))), -1, "do not increase"),
    (trajectory(NAMES, (1.0, (math.nan, 1.0))), -1, "not finite"),
    (trajectory(NAMES, (1.0, (1.0, 1.0)), stamp=-5.0), -3, "lie in the past"),
])
def test_goals_that_make_no_sense_are_rejected_with_the_reason(wanted, code, why):
    arm, client = arm_with()
    client.send(wanted)
    (result,) = client.results
    assert result[1:3] == (REJECTED, code)
    assert why in result[3]
    arm.context.advance(1.0)
    assert arm.at() == 0.0


def test_goals_are_rejected_while_the_controller_does_not_run():
    arm, client = arm_with()
    arm.switch((), ["arm"])
    client.send(trajectory(NAMES, (1.0, (1.0, 1.0))))
    assert client.results[0][1] == REJECTED


def test_some_joints_may_move_alone_where_that_is_allowed():
    arm, _ = arm_with({"allow_partial_joints_goal": True})
    command(arm, trajectory(NAMES, (1.0, (1.0, 1.0))))
    arm.context.advance(0.5)
    command(arm, trajectory(("two",), (0.5, (0.0,))))
    arm.context.advance(0.5)
    assert (arm.at("one"), arm.at("two")) == pytest.approx((1.0, 0.0), abs=1e-6)


def test_values_of_joints_that_a_partial_trajectory_does_not_name_are_ignored():
    arm, client = arm_with({"allow_partial_joints_goal": True})
    goal = client.send(trajectory(("two",), (0.5, (1.0, 9.0), (0.0, 9.0), (0.0, 9.0))))
    arm.context.advance(0.6)
    assert [one[:3] for one in client.results] == [(goal, SUCCEEDED, 0)]
    assert (arm.at("one"), arm.at("two")) == pytest.approx((0.0, 1.0), abs=1e-6)
    assert "ignores the last 1 positions" in arm.context.log_messages[-1]


def test_a_partial_goal_does_not_judge_the_other_joints():
    arm, client = arm_with({"allow_partial_joints_goal": True, "constraints": {
        "one": {"trajectory": 0.1, "goal": 0.1}}}, axis=SLOW)
    command(arm, trajectory(("one",), (0.2, (2.0,))))   # joint one stays behind
    goal = client.send(trajectory(("two",), (0.5, (0.1,))))
    arm.context.advance(0.6)
    assert [one[:3] for one in client.results] == [(goal, SUCCEEDED, 0)]
    assert arm.at("one") < 0.5


def test_path_tolerances_count_from_the_start_of_the_goals_trajectory():
    arm, client = arm_with({"constraints": {"one": {"trajectory": 0.1}}}, axis=SLOW)
    command(arm, trajectory(NAMES, (0.4, (0.5, 0.0)), (1.5, (0.5, 0.0))))   # too fast for it
    goal = client.send(trajectory(NAMES, (1.0, (0.6, 0.0)), stamp=1.2))
    arm.context.advance(2.5)
    assert [one[:3] for one in client.results] == [(goal, SUCCEEDED, 0)]


def test_a_trajectory_may_begin_later_and_what_moves_goes_on_until_then():
    arm, _ = arm_with()
    command(arm, trajectory(NAMES, (1.0, (1.0, 1.0))))
    arm.context.advance(0.2)
    command(arm, trajectory(NAMES, (0.5, (0.0, 0.0)), stamp=0.7))
    arm.context.advance(0.5)
    assert arm.at() == pytest.approx(0.7, abs=1e-6)
    arm.context.advance(0.5)
    assert arm.at() == pytest.approx(0.0, abs=1e-6)


def test_points_that_are_past_are_left_out():
    arm, _ = arm_with()
    arm.context.advance(1.0)
    command(arm, trajectory(NAMES, (0.2, (2.0, 2.0)), (1.0, (1.0, 1.0)), stamp=0.5))
    arm.context.advance(0.25)
    assert arm.at() == pytest.approx(0.5, abs=1e-6)
    arm.context.advance(0.25)
    assert arm.at() == pytest.approx(1.0, abs=1e-6)


def test_an_empty_trajectory_stops():
    arm, _ = arm_with()
    command(arm, trajectory(NAMES, (1.0, (1.0, 1.0))))
    arm.context.advance(0.4)
    command(arm, trajectory(NAMES))
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(0.4, abs=2e-3)


def test_a_goal_without_points_stops_and_succeeds_whatever_its_tolerances():
    arm, client = arm_with({"constraints": {"one": {"trajectory": 1e-9, "goal": 1e-9}}})
    command(arm, trajectory(NAMES, (1.0, (1.0, 1.0))))
    arm.context.advance(0.4)
    goal = client.send(trajectory(NAMES))
    arm.context.advance(0.1)
    assert [one[:3] for one in client.results] == [(goal, SUCCEEDED, 0)]
    arm.context.advance(0.5)
    assert arm.at() == pytest.approx(0.4, abs=2e-3)


def test_the_state_of_a_stopped_controller_cannot_be_asked_for():
    arm, _ = arm_with()
    arm.switch((), ["arm"])
    with pytest.raises(RequestError, match="'arm' is not running"):
        arm.context.services["robot/arm/query_state"](Message(time=Span(0.0)), Message())


def test_a_joint_without_limits_takes_the_shorter_way():
    arm, _ = arm_with(axis=JointAxis((0.0, 0.0, 1.0)))
    arm.context.joints["one"].position = 3.0
    arm.plugin.reset()
    command(arm, trajectory(NAMES, (1.0, (-3.0, 0.0))))
    arm.context.advance(1.0)
    assert arm.at() == pytest.approx(2.0 * math.pi - 3.0, abs=1e-6)


def test_the_state_is_told_and_can_be_asked_for():
    arm, _ = arm_with({"state_publish_rate": 10})
    command(arm, trajectory(NAMES, (1.0, (1.0, 2.0))))
    arm.context.advance(0.5)
    states = arm.published("arm/state")
    assert len(states) == 5
    assert states[-1].desired.positions == pytest.approx([0.5, 1.0])
    assert states[-1].actual.positions == pytest.approx([0.5, 1.0], abs=1e-6)
    assert (states[-1].actual.time_from_start.secs,
            states[-1].actual.time_from_start.nsecs) == (0, 500_000_000)
    response = Message()
    arm.context.services["robot/arm/query_state"](Message(time=Span(0.75)), response)
    assert response.name == list(NAMES)
    assert response.position == pytest.approx([0.75, 1.5])
    assert response.velocity == pytest.approx([1.0, 2.0])


def test_gains_are_needed_for_effort_joints():
    arm = Arm("hardware_interface/EffortJointInterface", arm={**EFFORT, "gains": {}})
    assert not arm.load("arm")
    assert "arm/gains/one/p" in arm.context.log_messages[-1]
