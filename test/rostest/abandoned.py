#!/usr/bin/env python3
"""A simulator whose master, or whose roslaunch, was killed ends by itself."""
import os
import signal
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph
import support
from free_ports import free_port
from support import Launched, Program, executable, is_alive, wait_for

from my_simulations.ros.lifecycle import master_api

LAUNCH = """<launch>
  <param name="gazebo/master_timeout" value="1"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="gui" value="false"/>
  </include>
</launch>
"""

ENGINE = "/gazebo/my_simulations/engine_pid"
STARTED = "all offered"
"""Last phase of a start, as the profile names it."""


class Abandoned(unittest.TestCase):
    def test_the_simulator_ends_some_time_after_its_roslaunch_was_killed(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        file = os.path.join(folder.name, "abandoned.launch")
        with open(file, "w", encoding="utf-8") as stream:
            stream.write(LAUNCH)
        with Launched(folder.name, folder.name, file) as launched:
            launched.names()
            node = master_api.running_node(launched.uri, "/gazebo")[1]
            master = rosgraph.Master("/abandoned", launched.uri)
            # The node offers its services before it publishes the engine's process id.
            wait_for(lambda: master.hasParam(ENGINE), "the engine's process id")
            engine = master.getParam(ENGINE)
            core = master_api.call(launched.uri, "getPid", "/abandoned")
            launched.program.process.kill()
            try:
                wait_for(lambda: not is_alive(node) and not is_alive(engine), "the end of both")
            finally:
                self.end_orphans(launched.uri, core)

    def test_the_simulator_ends_some_time_after_its_master_has_gone(self):
        port = free_port()
        uri = f"http://127.0.0.1:{port}"
        with Program(["rosmaster", "--core", "-p", str(port)], ROS_MASTER_URI=uri) as core:
            wait_for(lambda: not master_api.fault_of(uri, "/abandoned"), "the master")
            with Program([executable("gazebo_ros", "gzserver"), "_master_timeout:=1"],
                         ROS_MASTER_URI=uri, MY_SIMULATIONS_PROFILE="1") as server:
                # Before that, the loss of the master is a failed start.
                wait_for(lambda: STARTED in server.text, "the server")
                core.process.kill()
                self.assertEqual(server.ended(), 1)
                self.assertIn("has been gone for 1 s; shutting down", server.text)

    def end_orphans(self, uri, core):
        """What a killed roslaunch leaves besides the simulator: rosout and the master."""
        found = master_api.running_node(uri, "/rosout")
        for pid in (found[1] if found else 0, core):
            if pid:
                os.kill(pid, signal.SIGTERM)
        wait_for(lambda: not is_alive(core), "the end of the master")


if __name__ == "__main__":
    support.run("abandoned")
