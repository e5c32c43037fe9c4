"""A robot that stands is held to save time: what acts on it then moves it as if it were not."""
from __future__ import annotations

import math
from typing import Callable, Dict

import pytest
from conftest import Lab, ball, ground, inertial_of_box, link_of, slab
from test_settling import _on, _robot, _slope

from my_simulations.description.model import Joint, JointAxis, Model
from my_simulations.description.shapes import Box
from my_simulations.engine.bullet.body_events import BodyEvent
from my_simulations.engine.commands import Command, RemoveModel, SetModelState
from my_simulations.engine.drive_commands import (
    JointMotor,
    JointServo,
    PidGains,
    SetMotors,
    SetServos,
)
from my_simulations.engine.spline import Spline, segment_between
from my_simulations.engine.timed_forces import AddTimedForces, TimedEffort, TimedWrench
from my_simulations.geometry import Pose, Twist


def _holds(lab: Lab) -> bool:
    return any(tree.held is not None for tree in lab.backend._helpers.settling._trees.values())


def _standing(lab: Lab) -> int:
    lab.load(ground(1.0))
    robot = lab.load(_robot(), (0, 0, 0))
    lab.seconds(4)
    assert _holds(lab)
    return robot


def _wheels(lab: Lab, robot: int) -> "tuple[int, int]":
    return lab.joint_rows[robot, "left_joint"], lab.joint_rows[robot, "right_joint"]


def _effort(lab: Lab, robot: int) -> None:
    lab.apply(AddTimedForces(tuple(
        TimedEffort(n, row, lab.step + 5, lab.step + 10 ** 6, 0.002)
        for n, row in enumerate(_wheels(lab, robot)))))


def _wrench(lab: Lab, robot: int) -> None:
    lab.apply(AddTimedForces((TimedWrench(1, lab.rows[robot, "body"], lab.step + 5,
                                          lab.step + 10 ** 6, force=(0.1, 0.0, 0.0)),)))


def _motor(lab: Lab, robot: int) -> None:
    lab.apply(SetMotors(tuple(JointMotor(row, 0.5, 5.0) for row in _wheels(lab, robot))))


def _velocity(lab: Lab, robot: int) -> None:
    lab.apply(SetModelState(robot, lab.pose(robot, "body"), Twist((0.05, 0, 0), (0, 0, 0))))


def _gravity(lab: Lab, robot: int) -> None:
    lab.configure(gravity=(0.2, 0.0, -9.8))


def _ball_comes(lab: Lab, robot: int) -> None:
    hitting = lab.load(ball(radius=0.05, mass=1.0), (-0.4, 0, 0.08))
    lab.push(hitting, (0.5, 0, 0))


ACTS: Dict[str, Callable[[Lab, int], None]] = {
    "efforts": _effort, "a force": _wrench, "motors": _motor, "a velocity": _velocity,
    "gravity": _gravity, "a ball": _ball_comes}


@pytest.mark.parametrize("act", ACTS)
def test_a_robot_that_was_held_moves_when_something_acts_on_it(lab: Lab, act: str):
    robot = _standing(lab)
    before = lab.pose(robot, "body").position
    ACTS[act](lab, robot)
    lab.seconds(2)
    assert lab.pose(robot, "body").position[0] - before[0] > 0.01


def test_a_robot_that_was_held_moves_as_far_as_one_that_was_not(lab: Lab):
    # The second one is disturbed all the time before, so it is never held.
    lab.load(ground(1.0))
    held, free = lab.load(_robot(), (0, 0, 0)), lab.load(_robot(), (0, 2, 0))
    for _ in range(20):
        lab.seconds(0.2)
        lab.backend._helpers.settling.handle_event(
            BodyEvent.ACTIVATED, lab.backend._rows[lab.rows[free, "body"]][0])
    starts = [lab.pose(robot, "body").position for robot in (held, free)]
    for robot in (held, free):
        lab.apply(AddTimedForces(tuple(TimedEffort(
            10 * robot + n, row, lab.step, lab.step + 10 ** 6, 0.01)
            for n, row in enumerate(_wheels(lab, robot)))))
    lab.seconds(2)
    ways = [math.dist(lab.pose(robot, "body").position, start)
            for robot, start in zip((held, free), starts)]
    assert ways[0] == pytest.approx(ways[1], rel=0.01)
    assert ways[0] > 0.05


@pytest.mark.parametrize("drive", ["effort", "position"])
def test_a_robot_that_was_held_drives_along_a_spline_as_one_that_was_not(lab: Lab, drive: str):
    # Its axles have dampers. The spline begins while the first one is held.
    lab.load(ground(1.0))
    held, free = lab.load(_robot(), (0, 0, 0)), lab.load(_robot(), (0, 2, 0))
    spline = Spline((segment_between(4.0, (0.0, 0.0, 0.0), 6.0, (4.0, 0.0, 0.0)),), lab.step)
    gains = PidGains(5.0, 0.0, 0.2) if drive == "effort" else None
    lab.apply(SetServos(tuple(JointServo(row, drive, spline=spline, gains=gains, by_rates=True)
                              for robot in (held, free) for row in _wheels(lab, robot))))
    for _ in range(19):
        lab.seconds(0.2)
        lab.backend._helpers.settling.handle_event(
            BodyEvent.ACTIVATED, lab.backend._rows[lab.rows[free, "body"]][0])
    assert _holds(lab)
    lab.seconds(3.2)
    one, other = (lab.pose(robot, "body").position[0] for robot in (held, free))
    assert one == pytest.approx(other, rel=0.01)
    assert one == pytest.approx(0.2, rel=0.05)


def _lift(slow: JointAxis) -> Model:
    """A light platform on a column that stands on the ground."""
    foot = link_of(Box((0.6, 0.6, 0.2)), inertial_of_box(20.0, 0.6, 0.6, 0.2), None, "foot",
                   Pose((0.0, 0.0, 0.1)))
    top = link_of(Box((0.2, 0.2, 0.1)), inertial_of_box(1.0, 0.2, 0.2, 0.1), None, "top",
                  Pose((0.0, 0.0, 0.5)))
    return Model("lift", links=[foot, top],
                 joints=[Joint("hinge", "prismatic", "foot", "top", axis=slow)])


SLOW = 2e-4  # m/s
DRIVES: Dict[str, Callable[[int], Command]] = {
    "motor": lambda row: SetMotors((JointMotor(row, SLOW, 500.0),)),
    "servo": lambda row: SetServos((JointServo(row, "velocity", SLOW, most_effort=500.0),)),
    "loop": lambda row: SetServos((JointServo(row, "effort", SLOW, of_rate=True,
                                              gains=PidGains(500.0, 5000.0, 0.0, -100.0, 100.0)),)),
    "way": lambda row: SetServos((JointServo(row, "position", 1.0, most_rate=SLOW,
                                             most_effort=500.0),))}


@pytest.mark.parametrize("drive", DRIVES)
def test_a_slow_axis_of_a_robot_that_stands_is_not_held(lab: Lab, drive: str):
    lab.configure(gravity=(0.0, 0.0, -9.8))
    lab.load(ground(1.0))
    lift = lab.load(_lift(JointAxis((0.0, 0.0, 1.0))))
    row = lab.joint_rows[lift, "hinge"]
    lab.apply(DRIVES[drive](row))
    lab.seconds(2)
    start = lab.joint(lift)[0]
    lab.seconds(8)
    assert lab.joint(lift)[0] - start == pytest.approx(8 * SLOW, rel=0.05)
    lab.apply(SetServos((JointServo(row, ""),)))
    lab.apply(SetMotors((JointMotor(row, 0.0, 500.0),)))
    lab.seconds(2)
    assert _holds(lab)


def test_a_robot_whose_driven_wheels_are_blocked_is_held(lab: Lab):
    lab.load(ground(1.0))
    robot = lab.load(_robot(), (0, 0, 0))
    lab.apply(SetMotors(tuple(JointMotor(row, 1.0, 0.002) for row in _wheels(lab, robot))))
    lab.load(slab("wall", (0.1, 2.0, 2.0)), (0.3, 0, 0))
    lab.seconds(15)
    assert _holds(lab)


def test_a_robot_that_was_held_falls_when_its_floor_goes(lab: Lab):
    floor = lab.load(slab("floor", (4, 4, 1)), (0, 0, -0.5))
    robot = lab.load(_robot(), (0, 0, 0))
    lab.seconds(4)
    assert _holds(lab)
    lab.apply(RemoveModel(floor))
    lab.seconds(0.5)
    assert lab.pose(robot, "body").position[2] < -1.0


def test_a_robot_that_was_held_on_a_slope_rolls_when_its_brakes_are_released(lab: Lab):
    tilt = _slope(lab, 10.0)
    robot = lab.load(_robot(), _on(tilt, 0.0, 0.0), tilt)
    wheels = _wheels(lab, robot)
    lab.apply(SetMotors(tuple(JointMotor(row, 0.0, 5.0) for row in wheels)))
    lab.seconds(4)
    assert _holds(lab)
    start = lab.pose(robot, "body").position
    lab.apply(SetMotors(tuple(JointMotor(row, 0.0, 1e-6) for row in wheels)))
    lab.seconds(0.5)
    assert math.dist(lab.pose(robot, "body").position, start) > 0.05


def test_holding_does_not_depend_on_how_many_steps_are_made_at_once():
    def run(burst: int) -> "list[list[float]]":
        lab = Lab()
        try:
            robot = _standing(lab)
            _effort(lab, robot)
            found = []
            for _ in range(4):
                for _ in range(1000 // burst):
                    lab.backend.step(lab.step, burst)
                    lab.step += burst
                lab.backend.read()
                found.append(lab.row(robot, "body"))
            return found
        finally:
            lab.backend.close()

    assert run(1) == run(8) == run(1000)


def test_a_pose_that_is_set_is_kept(lab: Lab):
    robot = _standing(lab)
    lab.apply(SetModelState(robot, Pose((1.0, 2.0, 0.05)), Twist((0, 0, 0), (0, 0, 0))))
    lab.seconds(3)
    x, y, _ = lab.pose(robot, "body").position
    assert (x, y) == pytest.approx((1.0, 2.0), abs=1e-3)
