"""What studies do with ROS: the tests of a package as cases, rosbags of cases."""
from __future__ import annotations

import csv
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from lxml import etree

from my_simulations.editor.logs.state_log import LogReader

REPOSITORY = Path(__file__).resolve().parents[2]
STUDY = [sys.executable, str(REPOSITORY / "scripts" / "study")]
SECONDS = 300.0

TEST = """#!{python}
import unittest

import rospy
import rostest
from gazebo_msgs.msg import ModelStates


class Falls(unittest.TestCase):
    def test_height(self):
        last = rospy.get_param("/below")
        while True:
            states = rospy.wait_for_message("/gazebo/model_states", ModelStates, 60.0)
            if "ball" in states.name:
                break
        height = states.pose[states.name.index("ball")].position.z
        self.assertLess(height, last, "the ball is too high")


if __name__ == "__main__":
    rospy.init_node("falls", disable_rostime=True)
    rostest.rosrun("my_lab", "falls", Falls)
"""
FALLS = """<launch>
  <arg name="below" default="5"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="gui" value="false"/>
  </include>
  <param name="/below" value="$(arg below)"/>
  <node name="spawn" pkg="gazebo_ros" type="spawn_model"
        args="-urdf -file $(find my_simulations)/objects/ball.urdf -model ball -z 1"/>
  <test test-name="falls" pkg="my_lab" type="falls.py" time-limit="120"/>
</launch>
"""
SLEEP = """#!{python}
import time
time.sleep(1000)
"""


@pytest.fixture
def package(tmp_path):
    """A package with tests; returns its folder."""
    folder = tmp_path / "my_lab"
    (folder / "test").mkdir(parents=True)
    (folder / "package.xml").write_text(
        '<package format="2"><name>my_lab</name><version>0.1.0</version><description/>'
        '<maintainer email="a@b.c">a</maintainer><license>BSD</license></package>')
    for name, text in (("falls.py", TEST), ("sleep.py", SLEEP)):
        (folder / "test" / name).write_text(text.format(python=sys.executable))
        (folder / "test" / name).chmod(0o755)
    return folder


def environment(package):
    return {**os.environ, "ROS_PACKAGE_PATH": f"{package}:{os.environ['ROS_PACKAGE_PATH']}"}


def study(package, text, *more, env=None):
    (package / "tests.yaml").write_text(text)
    return subprocess.run([*STUDY, "run", "tests.yaml", *more], cwd=package, text=True,
                          env=env or environment(package), timeout=SECONDS, capture_output=True)


def table(package):
    with open(package / "tests" / "results.csv", newline="") as stream:
        return list(csv.DictReader(stream))


def processes_of(package):
    """Command lines of processes that know the folder."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if str(package).encode() in (folder / "environ").read_bytes():
                found.append((folder / "cmdline").read_text())
        except OSError:
            continue
    return found


def test_each_test_of_a_folder_is_a_row_with_its_results(package):
    (package / "test" / "falls.test").write_text(FALLS)
    (package / "test" / "missing.test").write_text(
        '<launch><test test-name="t" pkg="my_lab" type="nobody.py"/></launch>')
    (package / "test" / "nothing.test").write_text("<launch/>")
    (package / "test" / "broken.test").write_text("<launch>\n<arg>\n</launch>")
    done = study(package, "scenarios: test/*.test\n", "--slots", "2")
    assert done.returncode == 1, done.stderr
    found = {row["scenario"]: row for row in table(package)}
    assert list(found) == [f"test/{n}.test" for n in ("broken", "falls", "missing", "nothing")]
    assert {name: row["status"] for name, row in found.items()} == {
        "test/broken.test": "refused", "test/falls.test": "ok", "test/missing.test": "failed",
        "test/nothing.test": "refused"}, done.stderr
    assert "broken.test:3" in found["test/broken.test"]["issue"]
    assert "nobody.py" in found["test/missing.test"]["issue"]
    assert "no <test>" in found["test/nothing.test"]["issue"]
    falls = found["test/falls.test"]
    assert (falls["tests"], falls["failures"]) == ("1", "0")
    kept = package / "tests" / "scenarios" / falls["case"]
    assert etree.parse(str(kept / "junit.xml")).getroot().find(".//testcase").get(
        "name") == "test_height"
    assert not (kept / "state.log").exists()


def test_a_failed_scenario_keeps_a_replay(package):
    (package / "test" / "falls.test").write_text(FALLS)
    done = study(package, "scenarios: test/*.test\nvary:\n"
                          "  below: {set: arg.below, values: [-1, 5]}\n", "--slots", "1")
    assert done.returncode == 1, done.stderr
    assert [row["status"] for row in table(package)] == ["failed", "ok"], done.stderr
    case = table(package)[0]["case"]
    log = LogReader(str(package / "tests" / "scenarios" / case / "state.log"))
    assert '"ball"' in log.text(log.seek(log.end)[0]).decode()
    assert os.listdir(package / "tests" / "replays") == [f"{case}.html"]
    assert f"replays/{case}.html" in (package / "tests" / "report.html").read_text()
    assert processes_of(package) == []


def test_launch_arguments_are_varied_and_seeds_repeat(package):
    (package / "test" / "falls.test").write_text(FALLS)
    done = study(package, "scenarios: test/falls.test\nseeds: 2\nvary:\n"
                          "  below: {set: arg.below, values: [5, -5]}\n", "--slots", "2")
    assert done.returncode == 1, done.stderr
    found = table(package)
    assert [(row["below"], row["seed"], row["status"]) for row in found] == [
        ("5", "0", "ok"), ("5", "1", "ok"), ("-5", "0", "failed"), ("-5", "1", "failed")]
    assert "the ball is too high" in found[2]["issue"]
    shown = subprocess.run([*STUDY, "show", found[2]["case"], "--in", "tests", "--write", "x"],
                           cwd=package, env=environment(package), text=True, capture_output=True)
    assert shown.stderr.strip().endswith("test/falls.test below:=-5")
    unknown = study(package, "scenarios: test/falls.test\nvary:\n"
                             "  x: {set: arg.nobody, values: [1]}\n", "--out", "unknown")
    assert unknown.returncode == 1
    assert 'declares no <arg name=""nobody""/>' in (package / "unknown" / "results.csv").read_text()


SLEEPS = """<launch>
  <node name="asleep" pkg="my_lab" type="sleep.py"/>
  <test test-name="t" pkg="my_lab" type="sleep.py" time-limit="1000"/>
</launch>
"""


def test_a_scenario_that_hangs_is_ended_with_all_its_nodes(package):
    (package / "test" / "sleeps.test").write_text(SLEEPS)
    done = study(package, "scenarios: test/sleeps.test\nlimits: {seconds: 6}\n")
    assert done.returncode == 1, done.stderr
    (row,) = table(package)
    assert row["status"] == "timed out" and "6 s" in row["issue"]
    assert processes_of(package) == []


def test_a_killed_driver_leaves_no_process(package):
    (package / "test" / "sleeps.test").write_text(SLEEPS)
    (package / "tests.yaml").write_text("scenarios: test/sleeps.test\n")
    driver = subprocess.Popen([*STUDY, "run", "tests.yaml"], cwd=package, env=environment(package),
                              stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + SECONDS
    while sum("sleep.py" in line for line in processes_of(package)) < 2:
        assert time.monotonic() < deadline and driver.poll() is None
        time.sleep(0.1)
    driver.send_signal(signal.SIGKILL)
    driver.wait()
    while processes_of(package):
        assert time.monotonic() < deadline
        time.sleep(0.1)


def test_without_ros_it_says_what_is_missing(package):
    (package / "test" / "falls.test").write_text(FALLS)
    bare = {name: value for name, value in os.environ.items() if name != "ROS_PACKAGE_PATH"}
    done = study(package, "scenarios: test/falls.test\n", env=bare)
    assert done.returncode == 2
    assert "source the setup.bash of your workspace" in done.stderr


def test_a_case_of_a_world_is_recorded_as_a_rosbag(tmp_path):
    import rosbag
    from gazebo_msgs.msg import ModelStates

    ball = REPOSITORY / "objects" / "ball.urdf"
    (tmp_path / "s.yaml").write_text(
        f"models:\n  ball: {{file: {ball}, pose: [0, 0, 1]}}\nduration: 0.2\n"
        "measure:\n  z: final(pose.ball.z)\n")

    def command(*words):
        return subprocess.run([*STUDY, *words], cwd=tmp_path, check=True, text=True,
                              capture_output=True, timeout=SECONDS)

    command("run", "s.yaml")
    with open(tmp_path / "s" / "results.csv", newline="") as stream:
        (row,) = csv.DictReader(stream)
    command("export", row["case"], "--in", "s", "--bag", "case.bag", "--every", "0.05")
    info = subprocess.run(["rosbag", "info", "case.bag"], cwd=tmp_path, check=True, text=True,
                          capture_output=True).stdout
    for topic in ("/clock", "/gazebo/model_states", "/gazebo/link_states"):
        assert topic in info
    with rosbag.Bag(str(tmp_path / "case.bag")) as bag:
        clock = [message.clock.to_nsec() for _, message, _ in bag.read_messages("/clock")]
        states = [(message, stamp.to_sec()) for _, message, stamp
                  in bag.read_messages("/gazebo/model_states")]
    assert clock == [0, 50_000_000, 100_000_000, 150_000_000, 200_000_000]
    last, stamp = states[-1]
    assert stamp == pytest.approx(0.2) and last._md5sum == ModelStates._md5sum
    assert last.pose[last.name.index("ball")].position.z == float(row["z"])
