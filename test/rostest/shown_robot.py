#!/usr/bin/env python3
"""The modules of tests that need what view_robot.launch shows of the lab sheet's robot."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import support

MODULES = ("rviz_config", "robot_frames")

load_tests = support.at_one_node(MODULES, lambda: support.Gazebo().unpause_physics())

if __name__ == "__main__":
    support.run("shown_robot")
