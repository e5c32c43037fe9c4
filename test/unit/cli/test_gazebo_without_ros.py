"""`gazebo` decides whether it is a ROS node."""
from __future__ import annotations

import importlib.util

import pytest

from my_simulations.cli import gazebo_command, gzserver_command, standalone
from my_simulations.ros.lifecycle import master_api


@pytest.mark.parametrize("has_rospy, fault, started", [
    (True, "", "node"),
    (True, "connection refused", "no ROS master found"),
    (False, "", "this Python has no rospy"),
    (False, "connection refused", "this Python has no rospy"),
])
def test_a_world_is_a_node_if_rospy_and_a_master_exist(monkeypatch, has_rospy, fault, started):
    monkeypatch.setattr(importlib.util, "find_spec",
                        lambda name: object() if has_rospy or name != "rospy" else None)
    monkeypatch.setattr(master_api, "fault_of", lambda uri, caller: fault)
    monkeypatch.setattr(gazebo_command, "exit_on_signals", lambda: None)
    monkeypatch.setattr(gazebo_command, "ignore_signals", lambda: None)
    monkeypatch.setattr(gazebo_command, "_show", lambda words: None)
    found = []
    monkeypatch.setattr(standalone, "main", lambda words, program, no_ros: found.append(no_ros))
    monkeypatch.setattr(gzserver_command, "main", lambda words, program, gui: found.append("node"))
    gazebo_command.main(["gazebo", "lab_room.world"])
    assert found == [started]
