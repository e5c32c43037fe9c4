"""cob_omni_drive_controller: wheels that are driven and steered."""
from __future__ import annotations

import math

import pytest
from planar_pose import planar_pose
from robot_control import Arm, Message

from my_simulations.description.model import JointAxis
from my_simulations.plugins.control.hwi_switch import HwiSwitchGazeboRosControl
from my_simulations.plugins.control.omni_wheels import (
    OmniWheel,
    Steering,
    WheelState,
    base_displacement,
)

WHEELS = ("fl", "b", "fr")
AT = {"fl": (0.12, 0.22, 0.08), "b": (-0.25, 0.0, 0.08), "fr": (0.12, -0.22, 0.08)}
STEERS, DRIVES = (tuple(f"{name}_{kind}" for name in WHEELS) for kind in ("steer", "drive"))
STEER_CTRL = {"spring": 15.0, "damp": 2.75, "virt_mass": 0.1, "d_phi_max": 10.0,
              "dd_phi_max": 40.0}
LIST = [{"steer": steer, "drive": drive} for steer, drive in zip(STEERS, DRIVES)]
BOTH = "hardware_interface/PositionJointInterface hardware_interface/VelocityJointInterface"
TURN = {"type": "cob_omni_drive_controller/OdometryController", "publish_rate": 50, "wheels": LIST}


def base(offset=0.0, wheels=LIST, axis=None, odometry=None, run=True, **settings):
    """Wheels beside their steering axes by `offset` m to the right."""
    places = {f"{name}_steer": at for name, at in AT.items()}
    places.update({f"{name}_drive": (x, y - offset, z) for name, (x, y, z) in AT.items()})
    robot = Arm(axis=axis or JointAxis((0.0, 0.0, 1.0)), names=STEERS + DRIVES,
                interfaces=[BOTH] * 3 + ["hardware_interface/VelocityJointInterface"] * 3,
                places=places, kind=HwiSwitchGazeboRosControl,
                drive={"type": "cob_omni_drive_controller/WheelController", "wheels": wheels,
                       "defaults": {"steer_ctrl": STEER_CTRL}, **settings},
                odom={**TURN, "wheels": wheels, **(odometry or {})})
    if run:
        robot.run("drive", "odom")
    return robot


def go(robot, seconds, x=0.0, y=0.0, yaw=0.0):
    for _ in range(round(seconds / 0.1)):
        robot.deliver("drive/command", linear={"x": x, "y": y}, angular={"z": yaw})
        robot.context.advance(0.1)


def odometry(robot):
    robot.context.advance(0.04)
    return planar_pose(robot.published("odom/odometry")[-1].pose.pose)


@pytest.mark.parametrize("offset", [0.0, 0.03])
@pytest.mark.parametrize("motion", [(0.2, 0.0, 0.0), (0.0, 0.2, 0.0), (-0.1, 0.15, 0.0),
                                    (0.0, 0.0, 0.4), (0.2, 0.0, 0.3)])
def test_the_wheels_make_the_motion_that_is_commanded(motion, offset):
    """Rolling does not slip: each wheel's contact moves along the wheel, as fast as it rolls."""
    robot = base(offset)
    go(robot, 2.0, *motion)
    x, y, yaw = motion
    for name, (px, py, radius) in AT.items():
        angle = robot.at(f"{name}_steer")
        cx, cy = px + offset * math.sin(angle), py - offset * math.cos(angle)
        u, v = x - yaw * cy, y + yaw * cx
        rim = radius * robot.context.joints[f"{name}_drive"].velocity
        assert (rim * math.cos(angle), rim * math.sin(angle)) == pytest.approx((u, v), abs=2e-3)


@pytest.mark.parametrize("offset", [0.0, 0.03])
def test_the_odometry_tells_what_the_wheels_have_rolled(offset):
    robot = base(offset)
    go(robot, 1.0, y=1e-9)                            # steer first
    go(robot, 2.0, y=0.25)
    go(robot, 0.5)
    x, y, yaw = odometry(robot)
    # While wheels turn on the spot they are where they are by their own geometry alone.
    assert (x, y, yaw) == pytest.approx((0.0, 0.5, 0.0), abs=0.01)
    go(robot, 1.0, yaw=1e-9)
    before = odometry(robot)
    go(robot, 2.0, yaw=0.5)
    go(robot, 0.5)
    assert odometry(robot)[2] - before[2] == pytest.approx(1.0, abs=0.01)
    message = robot.published("odom/odometry")[-1]
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_footprint")
    assert message.pose.covariance[::7] == [0.1] * 6
    assert robot.context.transforms[-1][:2] == ("odom", "base_footprint")


def test_a_steered_wheel_beside_its_axis_does_not_move_the_base():
    """A turn about the vertical axis rolls the wheel by the offset; the odometry knows."""
    wheels = [OmniWheel("", "", x, y, 0.08, 0.03, coupling=0.2) for x, y, _ in AT.values()]
    before = [WheelState(0.1, 0.0)] * 3
    after = [WheelState(0.6, 0.5 * (0.03 / 0.08 - 0.2))] * 3
    assert base_displacement(wheels, before, after) == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


def test_a_wheel_rolls_backward_rather_than_turn_round():
    robot = base()
    go(robot, 1.0, x=-0.2)
    assert [robot.at(name) for name in STEERS] == pytest.approx([0.0] * 3, abs=1e-6)
    assert robot.context.joints["b_drive"].velocity == pytest.approx(-2.5)


def test_after_a_stop_wheels_keep_their_angles():
    robot = base()
    go(robot, 1.0, y=0.2)
    angles = [robot.at(name) for name in STEERS]
    go(robot, 1.0)
    assert [robot.at(name) for name in STEERS] == pytest.approx(angles, abs=1e-3)
    assert robot.context.joints["b_drive"].velocity == 0.0


def test_a_command_ends_after_its_timeout():
    robot = base(timeout=0.3)
    robot.deliver("drive/command", linear={"x": 0.2, "y": 0.0}, angular={"z": 0.0})
    robot.context.advance(0.28)
    assert robot.context.joints["b_drive"].velocity > 0.0
    robot.context.advance(0.04)
    assert robot.context.joints["b_drive"].velocity == 0.0


def test_zero_is_no_timeout():
    robot = base(timeout=0.0)
    robot.deliver("drive/command", linear={"x": 0.2, "y": 0.0}, angular={"z": 0.0})
    robot.context.advance(5.0)
    assert robot.context.joints["b_drive"].velocity == pytest.approx(2.5)


def test_a_command_that_is_not_finite_stops_the_base():
    robot = base(timeout=0.0)
    go(robot, 0.5, x=0.2)
    go(robot, 0.2, x=math.nan)
    assert robot.context.joints["b_drive"].velocity == 0.0
    assert "not finite" in robot.context.log_messages[-1]


def test_velocities_stay_within_the_limits():
    robot = base(max_trans_velocity=0.1, max_rot_velocity=0.2)
    go(robot, 1.0, x=5.0)
    assert robot.context.joints["b_drive"].velocity == pytest.approx(0.1 / 0.08)
    go(robot, 1.0, yaw=-9.0)
    assert abs(robot.context.joints["b_drive"].velocity) == pytest.approx(0.2 * 0.25 / 0.08)
    slow = base(axis=JointAxis((0.0, 0.0, 1.0), velocity=1.0))
    go(slow, 0.5, y=0.4)
    assert {slow.context.joints[name].servo.target <= 1.0 for name in STEERS} == {True}
    assert slow.context.joints["b_drive"].servo.target == 1.0


def test_a_steering_angle_follows_its_virtual_spring():
    """In steps of 1 ms, as the original on a joint that follows at once."""
    spring = Steering(15.0, 2.75, 0.1, 10.0, 40.0)
    angle = rate = 0.0
    for _ in range(40):
        turned, rate = spring.advance(1.0 - angle, rate, 0.01, 10)
        angle += turned
    at_once, end = spring.advance(1.0, 0.0, 0.4, 400)
    assert (angle, rate) == pytest.approx((at_once, end), abs=1e-9)
    assert 0.8 < angle < 1.01


def test_parameters_of_a_wheel_come_before_defaults_and_the_description():
    wheels = [{**one, "steer_ctrl": {"virt_mass": 0.2}, "x_pos": 1.0} if n == 1 else one
              for n, one in enumerate(LIST)]
    robot = base(wheels=wheels, defaults={"steer_ctrl": STEER_CTRL, "wheel_radius": 0.1})
    go(robot, 1.0, x=0.2)
    assert robot.context.joints["b_drive"].velocity == pytest.approx(2.0)
    go(robot, 2.0, yaw=0.2)
    assert abs(robot.context.joints["b_drive"].velocity) == pytest.approx(0.2 * 1.0 / 0.1, rel=0.01)


@pytest.mark.parametrize(("settings", "words"), [
    ({"wheels": LIST[:2]}, "lists 2 wheels; at least 3 are needed"),
    ({"wheels": "fl"}, "wheels must list the wheels"),
    ({"defaults": {}}, "steer_ctrl/spring is missing"),
    ({"defaults": {"steer_ctrl": {**STEER_CTRL, "virt_mass": 0}}}, "virt_mass must be positive"),
    ({"wheels": [{"steer": "fl_steer"}] * 3}, "wheels/0/drive is missing"),
    ({"timeout": -1.0}, "timeout must not be negative"),
    ({"defaults": {"steer_ctrl": STEER_CTRL, "wheel_radius": 0}}, "wheel_radius must not be 0"),
    ({"odometry": {"publish_rate": 0}}, "publish_rate must be positive"),
])
def test_what_is_wrong_is_told(settings, words):
    robot = base(run=False, **settings)
    assert not (robot.load("drive") and robot.load("odom"))
    assert words in robot.context.log_messages[-1]


def test_the_odometry_can_be_set_to_the_origin():
    robot = base()
    go(robot, 1.0, x=0.2)
    answer = Message()
    robot.context.services["robot/odom/reset_odometry"](Message(), answer)
    assert answer.success
    assert odometry(robot)[0] == pytest.approx(0.2 * 0.04, abs=0.003)
    robot.switch(stop=["odom"])
    robot.context.services["robot/odom/reset_odometry"](Message(), answer)
    assert (answer.success, answer.message) == (False, "not running")


def test_commands_of_wheels_are_published_if_they_are_asked_for():
    robot = base(pub_divider=1)
    go(robot, 1.0, x=0.2)
    message = robot.published("drive/wheel_commands")[-1]
    assert message.drive_target_velocity == pytest.approx([2.5] * 3)
    assert message.steer_target_position == pytest.approx([0.0] * 3)
