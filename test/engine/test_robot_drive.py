"""The lab robot driven by its plugin: odometry against the truth of the physics."""
from __future__ import annotations

import math
import pathlib
import time

import pytest
from conftest import ground
from inline_engine import InlineEngine
from planar_pose import planar_pose
from plugin_graph import Graph
from running_simulator import started

from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.engine.timed_forces import JointPid
from my_simulations.formats.reading import read_file
from my_simulations.geometry import rpy_from_quat
from my_simulations.plugins.host import PluginHost
from my_simulations.plugins.registry import PluginRegistry
from my_simulations.plugins.testing import Message
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.effort_operations import DriveJoint
from my_simulations.simulator.joint_gains import default_gains

ROBOT = pathlib.Path(__file__).resolve().parents[2] / "urdf" / "robo.urdf"


class Drive:
    def __init__(self):
        engine = InlineEngine(BulletBackend)
        robot, _ = read_file(str(ROBOT), Resolver())
        self.sim = started(World(models=[ground(mu=1.0), robot]), engine=lambda: engine)
        self.graph = Graph()
        self.graph.ignored |= {"/scan", "/camera/image_raw", "/camera/image_raw/compressed"}
        self.host = PluginHost(self.sim, self.graph, PluginRegistry(), lambda issue: None)
        self.host.start()
        self.sim.clock.advance(200)

    def go(self, forward, turn, seconds):
        """Command, and settle: it is heard between the step that time stands at and the next."""
        self.odometry()
        self.graph.heard["/cmd_vel"](Message(linear={"x": forward}, angular={"z": turn}))
        deadline = time.monotonic() + 60.0
        while self.host.has_pending_input:
            assert time.monotonic() < deadline
            time.sleep(0.001)
        self.sim.clock.advance(round(seconds * 1000))

    def odometry(self):
        wanted = (self.sim.clock.step // 20) * 20 * 10 ** 6
        deadline = time.monotonic() + 60.0
        while not self.graph.on("/odom") or self.graph.on("/odom")[-1].header.stamp < wanted:
            assert time.monotonic() < deadline
            time.sleep(0.001)
        return planar_pose(self.graph.on("/odom")[-1].pose.pose)

    def truth(self):
        pose, _ = self.sim.states.model_state("robo")
        return pose.position[0], pose.position[1], rpy_from_quat(pose.orientation)[2]

    def close(self):
        self.host.stop()
        self.sim.close()


@pytest.fixture
def drive():
    made = Drive()
    yield made
    made.close()


def apart(one, other):
    return math.hypot(one[0] - other[0], one[1] - other[1])


def test_a_straight_way(drive):
    drive.go(0.25, 0.0, 4.0)
    drive.go(0.0, 0.0, 1.0)
    assert drive.truth()[0] == pytest.approx(drive.odometry()[0], rel=0.01)
    assert abs(drive.truth()[1]) < 0.01


def test_a_circle_closes(drive):
    drive.go(0.2, 0.4, 2.0 * math.pi / 0.4)
    drive.go(0.0, 0.0, 1.0)
    way = 2.0 * math.pi * 0.5
    assert apart(drive.truth(), drive.odometry()) < 0.05 * way


def test_the_same_run_gives_the_same_messages():
    def run():
        drive = Drive()
        try:
            drive.go(0.2, 0.3, 1.0)
            drive.odometry()
            return [(one.header.stamp, one.pose.pose.position.x, one.pose.pose.position.y)
                    for one in drive.graph.on("/odom")]
        finally:
            drive.close()

    assert run() == run()


def test_wheels_that_follow_a_velocity_with_default_gains_drive_a_metre():
    """As the editor's Joints panel drives them: 5 rad/s on wheels of 0.05 m, for 4 s.

    The plugin's motors, which hold the wheels, are off meanwhile and hold them again at the end.
    """
    drive = Drive()
    try:
        model = drive.sim.models.get("robo")
        for name in ("left_wheel_joint", "right_wheel_joint"):
            joint = next(one for one in model.joints if one.name == name)
            gains = default_gains(model, joint, True, 0.001)
            DriveJoint(f"robo::{name}", (JointPid(5.0, True, **gains),)).apply(drive.sim)
        start = drive.truth()[0]
        rates = []
        for _ in range(40):
            drive.sim.clock.advance(100)
            rates.append(drive.sim.joints.states("robo::left_wheel_joint")[0][1])
        assert drive.truth()[0] - start == pytest.approx(1.0, abs=0.06)
        assert abs(drive.truth()[1]) < 0.02
        assert rates[-1] == pytest.approx(5.0, rel=0.02)
        for name in ("left_wheel_joint", "right_wheel_joint"):
            DriveJoint(f"robo::{name}", ()).apply(drive.sim)
        drive.sim.clock.advance(1000)
        before = drive.truth()[0]
        drive.sim.clock.advance(500)
        assert drive.truth()[0] == pytest.approx(before, abs=1e-3)
    finally:
        drive.close()
