#!/usr/bin/env python3
"""Every shipped world by world.launch, with the robot and all objects of its list."""
import glob
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import object_flow_support as flow
import support
from free_ports import free_port


class Worlds(unittest.TestCase):
    """One test for each world file, added below."""

    def check(self, world):
        port = free_port()
        master = f"http://127.0.0.1:{port}"
        launch = ["roslaunch", "-p", str(port), "my_simulations", "world.launch", "gui:=false",
                  "robot:=true", f"world:={world}", f"x:={ROBOT_X.get(world, 0.0)}"]
        with support.Program(launch, ROS_MASTER_URI=master) as server:
            try:
                self.check_running(server, world, master)
            finally:
                # Killed without this, roslaunch would leave its nodes behind.
                server.interrupt()
                status = server.ended()
        self.assertEqual(status, 0, server.text)
        self.assertNotIn("error", server.text.lower())
        # The log warns of missing plugins once per library; these warnings are expected.
        warned = [line for line in server.text.splitlines()
                  if "[WARN]" in line and "there is no plugin for" not in line]
        self.assertEqual(warned, [])

    def check_running(self, server, world, master):
        spawned = "robot_description: Successfully spawned"
        support.wait_for(lambda: spawned in server.text or server.process.poll() is not None,
                         f"{world} with its robot")
        self.assertIn(spawned, server.text)
        with flow.tool("spawn_object.py", "all", ROS_MASTER_URI=master) as program:
            self.assertEqual(program.ended(), 0, program.text)
        self.assertIn("MY_OBJECT spawned", program.text)


FOLDER = flow.package_file("world")
ROBOT_X = {"worlds/shapes.world": -1.5}
"""Where the robot does not start at the origin: its x in metres."""

for file in glob.glob(os.path.join(FOLDER, "**", "*.world"), recursive=True):
    setattr(Worlds, f"test_{os.path.basename(file)[:-len('.world')]}_starts_and_takes_its_objects",
            lambda self, name=os.path.relpath(file, FOLDER): self.check(name))


if __name__ == "__main__":
    support.run("lab_sheet_worlds")
