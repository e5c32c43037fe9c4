"""Environment variables that a student's processes get."""
from __future__ import annotations

import pytest

from my_simulations.grading.permitted_variables import permitted_variables


@pytest.mark.parametrize("name", [
    "PATH", "PYTHONPATH", "ROS_MASTER_URI", "ROS_PACKAGE_PATH", "LC_ALL", "GAZEBO_MODEL_PATH",
    "MY_SIMULATIONS_WS"])
def test_variables_of_python_and_ros_are_passed_on(name):
    assert permitted_variables({name: "a"}) == {name: "a"}


@pytest.mark.parametrize("name", [
    "AWS_SESSION", "ROS_REGISTRY_LOGIN", "ROSBAG_UPLOAD", "PYTHON_INDEX_PASSWORD", "PATHS",
    "GAZEBO_API_KEY", "MY_SIMULATIONS_EDITOR_TOKEN", "CATKIN_SECRET", "SSH_AUTH_SOCK", "DISPLAY",
    "MY_SIMULATIONS_PARENT", "MY_SIMULATIONS_RECORD"])
def test_variables_that_may_hold_secrets_are_not(name):
    assert permitted_variables({name: "a"}) == {}
