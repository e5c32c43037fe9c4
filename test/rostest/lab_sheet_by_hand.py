#!/usr/bin/env python3
"""A launch file typed from the lab sheet by hand, with nothing of ours in it."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import support


class TypedByHand(support.GazeboCase):
    def test_1_the_world_runs_without_a_robot(self):
        support.wait_for(lambda: self.gazebo.sim_time() > 0.5, "the world to run")
        self.assertEqual(self.gazebo.names(), ["ground_plane"])
        self.assertIn("<robot", rospy.get_param("/robot_description"))

    def test_2_spawn_model_puts_one_robot_in(self):
        command = [support.executable("gazebo_ros", "spawn_model"), "-urdf", "-param",
                   "robot_description", "-model", "robo", "-x", "1", "-z", "0.01"]
        with support.Program(command) as program:
            self.assertEqual(program.ended(), 0, program.text)
        self.assertEqual(self.gazebo.names(), ["ground_plane", "robo"])
        self.assertAlmostEqual(
            self.gazebo.get_model_state("robo", "").pose.position.x, 1.0, delta=0.02)

    def test_3_the_running_worlds_list_is_loaded_on_request(self):
        self.assertIsNone(rospy.get_param("/objects", None))
        launch = ["roslaunch", "my_simulations", "upload_param.launch"]
        with support.Program(launch) as program:
            self.assertEqual(program.ended(), 0, program.text)
        self.assertIn("MY_OBJECT", rospy.get_param("/objects"))
        self.assertEqual(rospy.get_param("/my_simulations/object_list/world"), "empty_world")


if __name__ == "__main__":
    support.run("lab_sheet_by_hand")
