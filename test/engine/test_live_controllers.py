"""Controllers of ros_control in an open world, without ROS."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import my_simulations
from my_simulations.errors import CommandError
from my_simulations.python_api.controllers import read_parameters

ARM = Path(__file__).resolve().parents[1] / "rostest/two_joint_arm"
LOOP = {"type": "effort_controllers/JointPositionController", "joint": "elbow",
        "pid": {"p": 100, "i": 100, "d": 6, "i_clamp": 10}}


@pytest.fixture
def world():
    parameters = {"arm": read_parameters(ARM / "controllers.yaml")}
    with my_simulations.open_world(parameters=parameters) as opened:
        opened.spawn(ARM / "arm.urdf", "arm")
        yield opened


def test_a_trajectory_is_followed_as_the_parameters_say(world):
    world.controllers.load("trajectory")
    world.controllers.load("joint_state_controller")
    world.controllers.start("trajectory", "joint_state_controller")
    states = world.controllers.states()
    assert states["trajectory"].state == "running"
    assert set(states["trajectory"].joints) == {"shoulder", "elbow"}
    result = world.topics["/arm/trajectory/follow_joint_trajectory/result"]
    joints = world.topics["/arm/joint_states"]
    world.publish("/arm/trajectory/follow_joint_trajectory/goal", {
        "goal_id": {"id": "one"}, "goal": {"trajectory": {
            "joint_names": ["shoulder", "elbow"],
            "points": [{"positions": [0.5, -0.4], "time_from_start": 1.0}]}}})
    assert result.wait(5.0).result.error_code == 0
    world.step(20)
    reached = dict(zip(joints.latest.name, joints.latest.position))
    assert reached["shoulder"] == pytest.approx(0.5, abs=0.02)
    assert reached["elbow"] == pytest.approx(-0.4, abs=0.02)
    assert world.joints().position["arm::elbow"] == pytest.approx(reached["elbow"], abs=1e-3)


def test_a_robot_without_transmissions_keeps_its_controller_manager(tmp_path):
    path = tmp_path / "box.urdf"
    path.write_text("""<robot name="box"><link name="base"><inertial><mass value="1"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
        <gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo></robot>""")
    kind = "joint_state_controller/JointStateController"
    with my_simulations.open_world() as world:
        world.spawn(path, "box")
        world.controllers.load("states", {"type": kind, "publish_rate": 50})
        world.controllers.start("states")
        found = world.topics["/box/joint_states"]
        world.step(200)
        assert found.latest.name == []
        assert world.controllers.states()["states"].state == "running"


def test_a_controller_is_loaded_with_parameters_of_the_call(world):
    controllers = world.controllers
    controllers.load("loop", LOOP, robot="arm")
    controllers.start("loop")
    world.publish("/arm/loop/command", {"data": 0.3})
    world.step(2000)
    assert world.joints().position["arm::elbow"] == pytest.approx(0.3, abs=0.02)
    controllers.stop("loop")
    assert controllers.states()["loop"].state != "running"
    controllers.unload("loop")
    assert controllers.states() == {}


def test_refusals_have_their_reasons(world):
    controllers = world.controllers
    with pytest.raises(CommandError, match="lost/type is missing"):
        controllers.load("lost")
    with pytest.raises(CommandError, match="not loaded"):
        controllers.start("loop")
    with pytest.raises(CommandError, match="no robot 'other' has a controller manager"):
        controllers.load("loop", LOOP, robot="other")
    controllers.load("loop", LOOP)
    controllers.load("trajectory")
    controllers.start("loop")
    with pytest.raises(CommandError, match="both drive joint 'elbow'"):
        controllers.start("trajectory")


def test_a_run_repeats_after_a_reset(world):
    def run():
        world.spawn(ARM / "arm.urdf", "arm") if "arm" not in world.names else None
        world.controllers.load("loop", LOOP)
        world.controllers.start("loop")
        world.publish("/arm/loop/command", {"data": 0.3})
        world.step(500)
        return world.joints().position.array

    first = run()
    world.reset()
    assert np.array_equal(first, run())


def test_parameters_come_from_a_file(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text("arm: {loop: {type: x}}")
    with my_simulations.open_world(parameters=path) as world:
        assert world.parameters.get("/arm/loop/type") == "x"
        with pytest.raises(CommandError, match="no robot has a controller manager"):
            world.controllers.load("loop")
    for text in ("[1, 2]", "a: ["):
        path.write_text(text)
        with pytest.raises(CommandError):
            read_parameters(path)
    with pytest.raises(CommandError):
        read_parameters(tmp_path / "lost.yaml")
