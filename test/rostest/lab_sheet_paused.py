#!/usr/bin/env python3
"""The launch file with pause:=true and the room."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import object_flow_support as flow
import support

ROOM = ["ground_plane", "room", "table", "box", "sphere", "cylinder"]


class PausedRoom(support.GazeboCase):
    def test_1_the_room_and_the_robot_are_there_while_time_stands_still(self):
        support.wait_for(lambda: "robo" in self.gazebo.names(), "the robot")
        self.assertEqual(sorted(self.gazebo.names()), sorted([*ROOM, "robo"]))
        self.assertTrue(self.gazebo.is_paused())
        self.assertEqual(self.gazebo.sim_time(), 0.0)
        self.assertAlmostEqual(self.gazebo.z("sphere"), 1.0)

    def test_2_objects_are_spawned_and_removed_while_paused(self):
        with flow.tool("spawn_object.py", "MY_OBJECT") as program:
            self.assertEqual(program.ended(), 0, program.text)
        self.assertIn("MY_OBJECT", self.gazebo.names())
        self.assertAlmostEqual(self.gazebo.z("MY_OBJECT"), 0.75)
        with flow.tool("remove_object.py", "MY_OBJECT") as program:
            self.assertEqual(program.ended(), 0, program.text)
        self.assertNotIn("MY_OBJECT", self.gazebo.names())

    def test_3_released_the_sphere_falls_and_what_is_static_stays(self):
        fixed = {name: support.numbers(self.gazebo.get_model_state(name, "").pose)
                 for name in ("room", "table")}
        self.gazebo.unpause_physics()
        support.wait_for(lambda: self.gazebo.sim_time() > 3.0, "three seconds of the world")
        self.assertAlmostEqual(self.gazebo.z("sphere"), 0.15, delta=0.01)
        self.assertAlmostEqual(self.gazebo.z("box"), 0.2, delta=0.01)
        self.assertAlmostEqual(self.gazebo.z("cylinder"), 0.85, delta=0.01)
        for name, pose in fixed.items():
            self.assertEqual(support.numbers(self.gazebo.get_model_state(name, "").pose), pose)


if __name__ == "__main__":
    support.run("lab_sheet_paused")
