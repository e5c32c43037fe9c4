"""A user's own package beside ours: what it commonly asks for, and its tests."""
from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
PREFIX = Path(os.environ["CMAKE_PREFIX_PATH"].split(":")[0])

COMPONENTS = ["roscpp", "rospy", "std_msgs", "sensor_msgs", "nav_msgs", "visualization_msgs",
              "geometry_msgs", "tf", "tf2_ros", "actionlib", "message_generation", "gazebo_msgs",
              "xacro"]

CMAKE = """cmake_minimum_required(VERSION 3.0.2)
project(my_lab)
find_package(catkin REQUIRED COMPONENTS {components})
catkin_package()
if(CATKIN_ENABLE_TESTING)
  find_package(rostest REQUIRED)
  add_rostest(test/falls.test)
endif()
"""

LAUNCH = """<launch>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="gui" value="false"/>
  </include>
  <node name="spawn" pkg="gazebo_ros" type="spawn_model"
        args="-urdf -file $(find my_simulations)/objects/ball.urdf -model ball -z 1"/>
  <test test-name="falls" pkg="my_lab" type="falls.py" time-limit="60"/>
</launch>
"""

TEST = """#!/usr/bin/env python3
import unittest

import rospy
import rostest
from gazebo_msgs.msg import ModelStates


class Falls(unittest.TestCase):
    def test_ball_is_there(self):
        names = []
        while "ball" not in names:
            names = rospy.wait_for_message("/gazebo/model_states", ModelStates, 30.0).name


if __name__ == "__main__":
    rospy.init_node("falls")
    rostest.rosrun("my_lab", "falls", Falls)
"""


def run(folder, *words, seconds=300):
    # The system's Python is the one that ROS is installed for.
    environment = {**os.environ, "PATH": f"/usr/bin:{os.environ['PATH']}"}
    return subprocess.run(words, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=seconds)


@pytest.fixture
def workspace(tmp_path):
    """A workspace on top of the one under test, with a package that has a test."""
    package = tmp_path / "src" / "my_lab"
    (package / "test").mkdir(parents=True)
    (package / "CMakeLists.txt").write_text(CMAKE.format(components=" ".join(COMPONENTS)))
    depends = "".join(f"<depend>{name}</depend>" for name in COMPONENTS)
    (package / "package.xml").write_text(
        "<package format='2'><name>my_lab</name><version>0.0.0</version>"
        "<description>a</description>"
        "<maintainer email='a@example.com'>a</maintainer><license>a</license>"
        f"<buildtool_depend>catkin</buildtool_depend>{depends}</package>")
    (package / "test" / "falls.test").write_text(LAUNCH)
    (package / "test" / "falls.py").write_text(TEST)
    (package / "test" / "falls.py").chmod(0o755)
    return tmp_path


def test_tests_of_a_users_package_run_with_catkin_make_run_tests(workspace):
    done = run(workspace, "catkin_make", "-C", str(workspace), "run_tests")
    assert done.returncode == 0, done.stdout[-4000:]
    results = run(workspace, "catkin_test_results", "build/test_results")
    assert "0 errors, 0 failures" in results.stdout, done.stdout[-4000:]
    assert results.stdout.split()[1] != "0", results.stdout


def test_the_example_package_of_a_plugin_builds_and_runs_under_ros_and_in_python(tmp_path):
    package = tmp_path / "src" / "lamp_plugin"
    shutil.copytree(REPOSITORY / "examples" / "lamp_plugin", package)
    done = run(tmp_path, "catkin_make", "-C", str(tmp_path), "run_tests")
    assert done.returncode == 0, done.stdout[-4000:]
    results = run(tmp_path, "catkin_test_results", "build/test_results")
    assert "0 errors, 0 failures" in results.stdout, done.stdout[-4000:]
    assert results.stdout.split()[1] != "0", results.stdout
    done = run(package, "bash", "-c", f". {tmp_path}/devel/setup.bash && rosrun my_simulations"
               " python -m unittest discover -s test -p test_lamp.py")
    assert done.returncode == 0 and "Ran 2 tests" in done.stdout, done.stdout[-4000:]


@pytest.mark.parametrize("words", [["dynamic_reconfigure", "dynparam", "-h"], ["tf", "tf_echo"],
                                   ["tf", "static_transform_publisher"]])
def test_usual_tool_is_there(words):
    done = run("/", "rosrun", *words)
    assert "Couldn't find" not in done.stdout and "not found" not in done.stdout, done.stdout


def test_roswtf_is_there():
    assert shutil.which("roswtf")


def test_rosrun_offers_no_test_programs_and_none_is_installed():
    tests = {path.name for path in (REPOSITORY / "test").rglob("*.py")}
    programs = {path.name for path in (PREFIX / "lib" / "my_simulations").iterdir()}
    assert "spawn_object.py" in programs
    assert not programs & tests
    installed = (PREFIX.parent / "build" / "my_simulations" / "cmake_install.cmake").read_text()
    assert "rostest" not in installed
