#!/usr/bin/env python3
"""The modules of tests that need a node with an empty world."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import support
from gazebo_msgs.srv import SetPhysicsPropertiesRequest

MODULES = ("api_surface", "models", "properties", "bad_requests", "save_world", "topics",
           "gz_program", "object_flow_package", "object_flow_many", "parallel_clients",
           "perception", "bad_input")


class EmptyAgain:
    """The world is empty, runs, and has the physics that it began with."""

    def __init__(self):
        self._physics = None

    def __call__(self):
        gazebo = support.Gazebo()
        if self._physics is None:
            self._physics = gazebo.get_physics_properties()
        gazebo.clear()
        request = SetPhysicsPropertiesRequest()
        for name in request.__slots__:
            setattr(request, name, getattr(self._physics, name))
        assert gazebo.set_physics_properties(request).success
        assert gazebo.unpause_physics() is not None


load_tests = support.at_one_node(MODULES, EmptyAgain())

if __name__ == "__main__":
    support.run("empty_world")
