#!/usr/bin/env python3
"""The modules of tests that need the lab sheet's world, with its robot and its list of objects."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import support

MODULES = ("object_flow", "object_flow_faults", "building", "object_flow_move")


def with_its_robot_only():
    """The world has what it began with, and runs."""
    gazebo = support.Gazebo()
    support.wait_for(lambda: "robo" in gazebo.names(), "the robot")
    gazebo.clear(keep=("ground_plane", "robo"))
    gazebo.unpause_physics()


load_tests = support.at_one_node(MODULES, with_its_robot_only)

if __name__ == "__main__":
    support.run("lab_world")
