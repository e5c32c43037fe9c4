"""Robots of an open world: their plugins and sensors run in Python, without ROS."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from waiting import until

import my_simulations
from my_simulations.errors import CommandError, EngineLostError
from my_simulations.geometry import Pose
from my_simulations.messages import geometry_msgs, pixels
from my_simulations.python_api import WorldChoice

ROOT = Path(__file__).resolve().parents[2]
WORLD = f"""<sdf version="1.6"><world name="w">
<include><uri>model://ground_plane</uri></include><include><uri>model://sun</uri></include>
<include><uri>file://{ROOT}/urdf/robo.urdf</uri><name>robo</name></include>
<model name="wall"><static>true</static><pose>2 0 0.5 0 0 0</pose><link name="link">
<collision name="c"><geometry><box><size>0.2 40 1</size></box></geometry></collision>
<visual name="v"><geometry><box><size>0.2 40 1</size></box></geometry></visual>
</link></model></world></sdf>"""
TOPICS = {"/tf": 50, "/odom": 50, "/scan": 10, "/imu": 50, "/joint_states": 50,
          "/camera/image_raw": 15}
"""Hz of each topic."""

RUN = """
import hashlib, pickle, sys
import my_simulations
from my_simulations.messages import to_ros
world = my_simulations.open_world(sys.argv[1])
topics = [world.topics[name] for name in sys.argv[2:]]
world.publish("cmd_vel", {"linear": {"x": 0.3}, "angular": {"z": 0.4}})
world.step(1000)
print(hashlib.sha256(repr([[one for one in topic.take()] for topic in topics]).encode()
                     + topics[-1].latest.data.tobytes()).hexdigest())
world.close()
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("live") / "live.world"
    path.write_text(WORLD)
    return str(path)


@pytest.fixture
def world(file):
    with my_simulations.open_world(file) as opened:
        yield opened


def test_the_first_sample_comes_for_who_subscribes_before_it_only(world):
    topic = world.topics["/imu"]
    world.step(60)
    assert [one.header.stamp.to_nsec() for one in topic.take()] == [
        20_000_000, 40_000_000, 60_000_000]
    topic.close()
    world.step(20)
    topic = world.topics["/imu"]
    world.step(40)
    assert [one.header.stamp.to_nsec() for one in topic.take()] == [120_000_000]
    world.reset()
    world.step(20)
    assert [one.header.stamp.to_nsec() for one in topic.take()] == [20_000_000]


def test_a_robot_drives_and_its_odometry_follows(world):
    odometry = world.topics["odom"]
    world.publish("/cmd_vel", geometry_msgs.Twist(linear=geometry_msgs.Vector3(x=0.3)))
    world.step(2000)
    x, y = world.states().pose["robo"][:2]
    at = odometry.latest.pose.pose.position
    assert 0.5 < x < 0.6 and at.x == pytest.approx(x, rel=0.01)
    assert at.y == pytest.approx(y, abs=0.005)
    assert world.issues == []


def test_a_scan_measures_the_distance_of_a_wall(world):
    scan = world.topics["/scan"].wait()
    assert scan.ranges.dtype == np.float32 and scan.header.frame_id == "laser_link"
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    laser = world.states().pose["robo"][0] + 0.08   # as the robot's file says
    hit = np.abs(angles) < 1.0
    expected = (1.9 - laser) / np.cos(angles[hit])
    seen = scan.ranges[hit]
    assert np.median(np.abs(seen - expected)[expected < scan.range_max]) < 0.03


def test_after_a_step_all_that_was_due_has_arrived(world):
    topics = {name: world.topics[name] for name in TOPICS}
    for _ in range(3):
        world.step(1000)
        for name, topic in topics.items():
            if name == "/tf":
                continue
            last = topic.latest.header.stamp.to_nsec()
            due = world.time * 1e9
            assert due - last < 1e9 / TOPICS[name] + 1e6, name
    transforms = topics.pop("/tf")
    assert transforms.count >= 3 * TOPICS["/tf"] - 2
    for name, topic in topics.items():
        assert abs(topic.count - 3 * TOPICS[name]) <= 2, name
        stamps = [one.header.stamp.to_nsec() for one in topic.take()]
        assert len(stamps) == topic.count and stamps == sorted(stamps)
    picture = pixels(topics["/camera/image_raw"].latest)
    assert picture.ndim == 3 and picture.std() > 0.0


def run(world):
    topics = [world.topics[name] for name in TOPICS]
    world.publish("cmd_vel", {"linear": {"x": 0.3}, "angular": {"z": 0.4}})
    world.step(1000)
    return [topic.take() for topic in topics], world.links().pose.array


def test_steps_end_with_their_last_scan_and_not_with_the_next_look(world, monkeypatch):
    monkeypatch.setattr("my_simulations.plugins.host._LOOK_S", 600.0)
    scan = world.topics["scan"]
    for _ in range(20):  # a step that waits for a look exceeds the limit of the barrier
        world.step(100)
    assert scan.count == 20


def test_messages_repeat_bit_for_bit_after_a_reset(world):
    first, poses = run(world)
    for _ in range(2):
        world.reset()
        again, others = run(world)
        assert np.array_equal(poses, others)
        for name, one, other in zip(TOPICS, first, again):
            assert one == other, name


def test_messages_repeat_bit_for_bit_in_another_process(file):
    runs = [subprocess.run([sys.executable, "-c", RUN, file, *TOPICS], check=True, text=True,
                           stdout=subprocess.PIPE).stdout for _ in range(2)]
    assert len(runs[0].strip()) == 64 and runs[0] == runs[1]


def test_a_restored_world_goes_on(world):
    odometry = world.topics["odom"]
    world.publish("cmd_vel", {"linear": {"x": 0.3}})
    world.step(500)
    saved, count = world.save(), odometry.count
    runs = []
    for _ in range(2):
        world.restore(saved)
        world.step(500)
        runs.append(world.states().pose["robo"][0])
    assert runs[0] == runs[1] > 0.2
    assert odometry.count >= count + 50 and world.issues == []


def test_listening_changes_nothing_in_the_world(file):
    poses = []
    for names in ((), ("/odom", "/scan", "/camera/image_raw")):
        with my_simulations.open_world(file) as world:
            topics = [world.topics[name] for name in names]
            world.publish("cmd_vel", {"linear": {"x": 0.3}})
            world.step(500)
            poses.append(world.links().pose.array)
            assert all(topic.count for topic in topics)
    assert np.array_equal(*poses)


def test_a_model_that_is_spawned_brings_its_plugins_and_takes_them_away():
    with my_simulations.open_world() as world:
        assert dict(world.topics) == {} and world.services == {}
        world.spawn(ROOT / "urdf/robo.urdf")
        assert "/scan" in world.topics
        odometry = world.topics["odom"]
        world.step(100)
        assert odometry.count == 5
        world.remove("robo")
        world.step(100)
        assert odometry.count == 5 and "odom" not in world.topics


def test_plugins_without_a_namespace_get_that_of_the_spawn():
    text = (ROOT / "urdf" / "robo.urdf").read_text().replace(
        "<robotNamespace>/</robotNamespace>", "")
    with my_simulations.open_world() as world:
        world.spawn(text, "one")
        world.spawn(text, "two", namespace="/lab")
        assert {"/one/cmd_vel", "/one/odom", "/lab/cmd_vel", "/lab/odom", "/lab/scan"} <= set(
            world.topics)
        assert not any(name.startswith("/two/") for name in world.topics)
        world.open(WorldChoice(models=(("robot", text, Pose()),), namespace="/"))
        assert {"/cmd_vel", "/odom", "/scan"} <= set(world.topics)


def test_services_are_calls(world):
    assert world.services["/camera/set_parameters"] == "dynamic_reconfigure/Reconfigure"
    rate = {"config": {"doubles": [{"name": "imager_rate", "value": 5.0}]}}
    response = world.call("/camera/set_parameters", rate)
    assert {one.name: one.value for one in response.config.doubles}["imager_rate"] == 5.0
    pictures = world.topics["/camera/image_raw"]
    world.step(1000)
    assert 4 <= pictures.count <= 6
    with pytest.raises(CommandError, match="services are"):
        world.call("/camera/lost")


def test_topics_that_do_not_exist_are_refused_with_those_that_do(world):
    with pytest.raises(CommandError, match="/cmd_vel.*/scan"):
        world.topics["/lidar"]
    with pytest.raises(CommandError, match="no plugin subscribes to /scan"):
        world.publish("/scan", {})
    with pytest.raises(CommandError, match="no field"):
        world.publish("/cmd_vel", {"speed": 1.0})
    with pytest.raises(CommandError, match="wait"):
        _ = world.topics["/scan"].latest
    camera = world.topics["/camera/image_raw/compressed"]
    camera.close()
    with pytest.raises(CommandError, match=r"0\.1 s of sim time"):
        camera.wait(0.1)


def test_sensors_and_plugins_can_be_left_out(file):
    with my_simulations.open_world(file, sensors=False) as world:
        assert set(world.topics) == {"/cmd_vel", "/odom", "/joint_states", "/tf"}
    with my_simulations.open_world(file, plugins=False) as world:
        world.step(10)
        assert len(world.topics) == 0
        with pytest.raises(CommandError, match="plugins=False"):
            world.publish("/cmd_vel", {})
        with pytest.raises(CommandError, match="there is no topic /scan.*plugins=False"):
            world.topics["/scan"]


def test_a_topic_of_a_plugin_that_is_switched_off_is_refused_with_the_reason(tmp_path):
    path = tmp_path / "one.sdf"
    path.write_text("""<sdf version="1.6"><model name="m"><link name="l"/>
<plugin name="lost" filename="liblost.so"/></model></sdf>""")
    with my_simulations.open_world(plugins={"liblost.so": "no_such_module:Lost"}) as world:
        world.spawn(str(path))
        with pytest.raises(CommandError, match="there is no topic /found.*reported: .*one.sdf:2:.*"
                                               "'lost'.*No module named 'no_such_module'"):
            world.topics["/found"]
        world.reset()
        with pytest.raises(CommandError, match="topics are none$"):
            world.topics["/found"]


def test_a_plugin_whose_messages_are_not_installed_is_an_issue(tmp_path):
    path = tmp_path / "one.world"
    path.write_text("""<sdf version="1.6"><world name="w"><model name="m"><link name="l"/>
<plugin name="lost" filename="liblost.so"/></model></world></sdf>""")
    (tmp_path / "lost_plugin.py").write_text("""
from my_simulations.plugins.base import Plugin
class Lost(Plugin):
    def load(self):
        self.context.publish("lost", "lost_msgs/Lost")
class Bad(Plugin):
    def load(self):
        topic = self.context.publish("bad", "std_msgs/UInt8")
        self.context.every(100.0, lambda: topic.publish(self._made()))
    def _made(self):
        message = self.context.message("std_msgs/UInt8")
        message.data = 300
        return message
""")
    sys.path.insert(0, str(tmp_path))
    try:
        with my_simulations.open_world(str(path), plugins={
                "liblost.so": "lost_plugin:Lost"}) as world:
            (issue,) = world.issues
            assert issue.code == "plugin-failed" and "lost_msgs/Lost" in issue.message
            assert issue.file == str(path) and issue.line == 2
            world.step(10)
        with my_simulations.open_world(str(path), plugins={
                "liblost.so": "lost_plugin:Bad"}) as world:
            topic = world.topics["bad"]
            world.step(100)
            assert topic.count == 0
            (issue,) = world.issues
            assert issue.code == "plugin-failed" and "std_msgs/UInt8.data" in issue.message
    finally:
        sys.path.remove(str(tmp_path))


def test_robots_run_again_after_the_engine_has_died(world):
    odometry, scan = world.topics["odom"], world.topics["scan"]
    world.step(100)
    os.kill(world.simulator.engine_pid, signal.SIGKILL)
    with pytest.raises(EngineLostError):
        for _ in range(1000):
            world.step(10)
    world.reset()
    world.publish("cmd_vel", {"linear": {"x": 0.3}})
    world.step(1000)
    assert odometry.count == 50 and 9 <= scan.count <= 11
    assert world.states().pose["robo"][0] > 0.1


def test_worlds_side_by_side_have_their_own_robots(file, world):
    with my_simulations.open_world(file) as other:
        mine, theirs = world.topics["odom"], other.topics["odom"]
        world.publish("cmd_vel", {"linear": {"x": 0.3}})
        world.step(500)
        other.step(500)
        assert mine.latest.pose.pose.position.x > 0.05 > theirs.latest.pose.pose.position.x


def test_another_world_in_the_same_engine_has_its_own_topics(file, world):
    odometry = world.topics["odom"]
    world.step(100)
    world.open(WorldChoice("worlds/empty.world"))
    assert len(world.topics) == 0 and odometry.count == 0
    world.step(10)
    world.open(WorldChoice(file))
    world.step(100)
    assert odometry.count == 5


@pytest.mark.parametrize("fault, told", [
    ("import os; os._exit(3)", "ended with exit status 3"),
    ("import os, time; os.fork() or time.sleep(1000); os._exit(4)", "ended with exit status 4"),
    ("while True: pass", "5 s")])
def test_an_isolated_plugin_that_ends_forks_or_hangs_ends_alone(tmp_path, monkeypatch, fault, told):
    (tmp_path / "faulty_plugin.py").write_text(f"""
from my_simulations.plugins.base import Plugin

class Faulty(Plugin):
    def load(self):
        self.context.every(10.0, self.fail)

    def fail(self):
        {fault}
""")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}")
    model = ('<sdf version="1.6"><model name="m"><link name="l"/><plugin name="p"'
             ' filename="libfaulty.so"/></model></sdf>')
    with my_simulations.open_world(plugins={"libfaulty.so": "faulty_plugin:Faulty"},
                                   isolate=True) as world:
        world.spawn(model)
        world.step(500)
        assert world.time == pytest.approx(0.5)
        assert any(told in issue.message for issue in world.issues), world.issues


@pytest.mark.parametrize("then", ["", "raise ValueError"])
def test_a_process_that_a_plugin_forks_ends_with_the_call(tmp_path, monkeypatch, then):
    (tmp_path / "forking_plugin.py").write_text(f"""
import os
from my_simulations.plugins.base import Plugin

class Forking(Plugin):
    forked = []

    def load(self):
        self.context.every(10.0, self.fork)

    def fork(self):
        if not self.forked:
            self.forked.append(os.fork())
            if not self.forked[0]:
                {then or "return"}
""")
    monkeypatch.syspath_prepend(str(tmp_path))
    model = ('<sdf version="1.6"><model name="m"><link name="l"/><plugin name="p"'
             ' filename="libforking.so"/></model></sdf>')
    with my_simulations.open_world(plugins={"libforking.so": "forking_plugin:Forking"}) as world:
        world.spawn(model)
        world.step(500)
        (child,) = sys.modules["forking_plugin"].Forking.forked
        try:
            until(lambda: os.waitpid(child, os.WNOHANG)[0] == child)
        except BaseException:
            os.kill(child, signal.SIGKILL)
            raise
        assert world.time == pytest.approx(0.5) and not world.issues
    sys.modules.pop("forking_plugin")


def test_an_isolated_plugin_publishes_and_hears(tmp_path, monkeypatch):
    (tmp_path / "echo_plugin.py").write_text("""
from my_simulations.plugins.base import Plugin

class Echo(Plugin):
    def load(self):
        self.topic = self.context.publish("echo", "geometry_msgs/Twist")
        self.context.subscribe("cmd_vel", "geometry_msgs/Twist", self.topic.publish)
""")
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}")
    monkeypatch.syspath_prepend(str(tmp_path))
    model = ('<sdf version="1.6"><model name="m"><link name="l"/><plugin name="p"'
             ' filename="libecho.so"/></model></sdf>')
    with my_simulations.open_world(plugins={"libecho.so": "echo_plugin:Echo"},
                                   isolate=True) as world:
        world.spawn(model)
        echo = world.topics["/echo"]
        world.publish("/cmd_vel", {"linear": {"x": 0.5}})
        world.step(10)
        assert [issue.message for issue in world.issues] == [] and echo.latest.linear.x == 0.5
