"""What dynamic_reconfigure can change: rates of cameras, gains of loops, slip of wheels."""
from __future__ import annotations

import pytest
from robot_control import NS, Arm, Client, trajectory
from test_cameras import RAW, camera

from my_simulations.description.model import Joint, JointAxis, Link
from my_simulations.description.shapes import Collision, Sphere
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.drive.wheel_slip import RosWheelSlip
from my_simulations.plugins.reconfigure import Option, Reconfigure
from my_simulations.plugins.sensors.camera import MultiCamera
from my_simulations.plugins.testing import FakeContext, Message

EFFORT = "hardware_interface/EffortJointInterface"
POSITION = "hardware_interface/PositionJointInterface"
VELOCITY = "hardware_interface/VelocityJointInterface"
OPTIONS = (Option("rate", 2.0, 1.0, 50.0, "Hz"), Option("on", True, False, True, ""),
           Option("count", 3, 0, 9, ""))
VALUES = {"rate": 10.0, "on": False, "count": 4}


def element(name, value):
    return Message(name=name, value=value)


def ask(context, service, doubles=(), ints=(), bools=()):
    """The values after a request, by name."""
    request = Message(config=Message(strs=[], **{
        field: [element(*one) for one in found]
        for field, found in (("doubles", doubles), ("ints", ints), ("bools", bools))}))
    response = Message()
    context.services[f"{service}/set_parameters"](request, response)
    return values_of(response.config)


def values_of(config):
    return {one.name: one.value for one in (*config.doubles, *config.ints, *config.bools)}


def offered():
    context, seen = FakeContext(), []
    Reconfigure(context, "it", OPTIONS, VALUES, seen.append)
    return context, seen


def test_names_types_ranges_and_values_are_told_at_once():
    context, _ = offered()
    (description,), (update,) = (context.published[f"it/parameter_{what}"]
                                 for what in ("descriptions", "updates"))
    (group,) = description.groups
    assert [(one.name, one.type) for one in group.parameters] == [
        ("rate", "double"), ("on", "bool"), ("count", "int")]
    assert values_of(description.max) == {"rate": 50.0, "on": True, "count": 9}
    assert values_of(description.min) == {"rate": 1.0, "on": False, "count": 0}
    assert values_of(description.dflt) == {"rate": 2.0, "on": True, "count": 3}
    assert values_of(update) == VALUES


def test_a_request_changes_what_it_names_within_its_range():
    context, seen = offered()
    assert ask(context, "it", doubles=[("rate", 99.0)]) == {**VALUES, "rate": 50.0}
    assert ask(context, "it", bools=[("on", True)]) == {"rate": 50.0, "on": True, "count": 4}
    assert seen[-1] == {"rate": 50.0, "on": True, "count": 4}
    assert values_of(context.published["it/parameter_updates"][-1]) == seen[-1]


@pytest.mark.parametrize("fault", [{"doubles": [("speed", 1.0)]}, {"ints": [("rate", 1)]},
                                   {"doubles": [("rate", float("nan"))]}])
def test_a_request_that_makes_no_sense_changes_nothing(fault):
    context, seen = offered()
    with pytest.raises(PluginError):
        ask(context, "it", **fault)
    assert seen == []


def test_a_camera_takes_pictures_at_the_rate_that_was_set():
    context = camera()
    context.advance(0.25)
    assert len(context.published[RAW]) == 2
    assert values_of(context.published["cam/parameter_updates"][0]) == {"imager_rate": 10.0}
    ask(context, "cam", doubles=[("imager_rate", 50.0)])
    context.advance(0.2)
    assert len(context.published[RAW]) == 12


def test_cameras_of_a_pair_have_one_rate():
    from my_simulations.description.sensor import Camera as CameraBlock

    blocks = [CameraBlock(name=name, width=8, height=6) for name in ("left", "right")]
    context = camera(block=blocks[0], more=blocks[1:], kind="multicamera", cls=MultiCamera)
    ask(context, "cam/left", doubles=[("imager_rate", 20.0)])
    assert values_of(context.published["cam/right/parameter_updates"][-1]) == {
        "imager_rate": 20.0}
    context.advance(0.1)
    assert [len(context.published[f"cam/{side}/image_raw"]) for side in ("left", "right")] == [2, 2]


def test_gains_of_a_running_loop_change_without_a_jump_of_its_target():
    arm = Arm(EFFORT, go={"type": "effort_controllers/JointPositionController", "joint": "one",
                          "pid": {"p": 100.0, "d": 20.0}})
    arm.run("go")
    arm.deliver("go/command", data=0.5)
    ask(arm.context, "robot/go/pid", doubles=[("p", 50.0)])
    arm.context.advance(0.001)
    assert arm.context.joints["one"].effort == pytest.approx(25.0)
    arm.deliver("go/command", data=1.0)
    arm.context.advance(0.001)
    assert arm.context.joints["one"].servo.gains.p == 50.0


def test_gains_of_a_trajectory_change_while_it_is_followed():
    arm = Arm(EFFORT, arm={"type": "effort_controllers/JointTrajectoryController",
                           "joints": ["one"], "gains": {"one": {"p": 100.0, "d": 20.0}}})
    arm.run("arm")
    client = Client(arm, "arm")
    client.send(trajectory(["one"], (1.0, [0.5])))
    arm.context.advance(0.3)
    spline = arm.context.joints["one"].servo.spline
    ask(arm.context, "robot/arm/gains/one", doubles=[("d", 40.0)])
    servo = arm.context.joints["one"].servo
    assert servo.spline is spline and servo.gains.d == 40.0
    arm.context.advance(3.0)
    assert arm.at() == pytest.approx(0.5, abs=1e-3)


def test_gains_below_an_interface_change_and_stay():
    arm = Arm(POSITION, parameters={"gazebo_ros_control": {"pid_gains": {"one": {"p": 100.0}}}},
              go={"type": "position_controllers/JointPositionController", "joint": "one"})
    arm.run("go")
    arm.deliver("go/command", data=0.5)
    ask(arm.context, "robot/gazebo_ros_control/pid_gains/one", doubles=[("p", 30.0)])
    servo = arm.context.joints["one"].servo
    assert (servo.drive_gains.p, servo.target) == (30.0, 0.5)
    arm.deliver("go/command", data=0.2)
    assert arm.context.joints["one"].servo.drive_gains.p == 30.0


def test_gains_of_an_unloaded_controller_are_offered_no_more():
    arm = Arm(EFFORT, go={"type": "effort_controllers/JointPositionController", "joint": "one",
                          "pid": {"p": 100.0}})
    arm.load("go")
    assert "robot/go/pid/set_parameters" in arm.context.services
    arm.ask("unload_controller", name="go")
    assert "robot/go/pid/set_parameters" not in arm.context.services


def test_wheels_slip_as_was_set_and_again_on_their_own():
    context = FakeContext('<plugin><wheel link_name="rear"><slip_compliance_lateral>1'
                          "</slip_compliance_lateral><wheel_normal_force>10</wheel_normal_force>"
                          "<wheel_radius>0.2</wheel_radius></wheel></plugin>", joints=("axle",))
    context.description.links.append(Link("rear", collisions=[Collision("c", Sphere(0.3))]))
    context.description.joints.append(Joint("axle", "revolute", "base", "rear", axis=JointAxis()))
    plugin = context.load(RosWheelSlip)
    service, name = "robot/wheel_slip", "slip_compliance_unitless_lateral"
    assert context.slips["rear"][3:] == (1.0, 0.0)
    ask(context, service, doubles=[(name, 5.0)])
    assert context.slips["rear"][3:] == (5.0, 0.0)
    context.slips.clear()
    plugin.reset()
    assert context.slips["rear"][3:] == (5.0, 0.0)
    ask(context, service, doubles=[(name, -1.0)])
    assert context.slips["rear"][3:] == (1.0, 0.0)


def test_a_diff_drive_changes_its_lengths_and_its_odometry_while_it_drives():
    arm = Arm(VELOCITY, axis=JointAxis((0.0, 1.0, 0.0)),
              drive={"type": "diff_drive_controller/DiffDriveController", "left_wheel": "one",
                     "right_wheel": "two", "wheel_separation": 0.5, "wheel_radius": 0.1,
                     "enable_odom_tf": False, "left_wheel_radius_multiplier": 1.1})
    name = f"{NS}/drive"
    arm.run("drive")
    assert ask(arm.context, name) == {
        "left_wheel_radius_multiplier": 1.1, "right_wheel_radius_multiplier": 1.0,
        "wheel_separation_multiplier": 1.0, "publish_rate": 50.0, "enable_odom_tf": False}

    def go_on(seconds):
        for _ in range(round(seconds / 0.1)):
            arm.deliver("drive/cmd_vel", linear={"x": 0.33}, angular={"z": 0.4})
            arm.context.advance(0.1)

    go_on(0.5)
    assert arm.context.transforms == []
    before = arm.published("drive/odom")[-1].pose.pose.position.x
    ask(arm.context, name, bools=[("enable_odom_tf", True)], doubles=[
        ("left_wheel_radius_multiplier", 0.75), ("right_wheel_radius_multiplier", 1.5),
        ("wheel_separation_multiplier", 0.8), ("publish_rate", 100.0)])
    count = len(arm.published("drive/odom"))
    go_on(0.5)
    left, right = (arm.context.joints[wheel].velocity for wheel in ("one", "two"))
    assert (left, right) == pytest.approx(((0.33 - 0.08) / 0.075, (0.33 + 0.08) / 0.15))
    after = arm.published("drive/odom")
    assert len(after) - count == pytest.approx(50, abs=2)
    assert after[-1].twist.twist.angular.z == pytest.approx(0.4)
    assert 0.0 <= after[count].pose.pose.position.x - before < 0.02   # no jump
    assert arm.context.transforms
