#!/usr/bin/env python3
"""gzserver's options in a running node, and spawn_model's joint positions."""
import contextlib
import os
import shutil
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import support
from support import Program, executable, wait_for

from my_simulations.editor.logs.state_log import LogReader
from my_simulations.errors import CommandError

STEPS = 300
ARM = """<robot name="arm"><link name="world"/>
<link name="bar"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="hinge" type="revolute"><parent link="world"/><child link="bar"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="9" velocity="9"/></joint></robot>"""


class ServerOptions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        cls.logs = rospy.get_param("~logs")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.logs)

    def run_spawn_model(self, *words):
        with Program([executable("gazebo_ros", "spawn_model"), *words]) as program:
            self.assertEqual(program.ended(), 0, program.text)
            return program.text

    def test_time_stands_still_after_the_number_of_steps(self):
        wait_for(lambda: self.gazebo.sim_time() * 1000 > STEPS - 0.5, "the last step")
        self.assertAlmostEqual(self.gazebo.sim_time(), STEPS / 1000.0, 9)
        # Requests are answered by a world that stands.
        self.assertTrue(self.gazebo.spawn("late", where=support.pose(z=5.0)).success)
        self.assertAlmostEqual(self.gazebo.z("late"), 5.0, 9)
        self.assertAlmostEqual(self.gazebo.sim_time(), STEPS / 1000.0, 9)

    def test_the_launch_argument_recording_writes_a_log_from_the_first_step_to_the_last(self):
        wait_for(lambda: self.gazebo.sim_time() * 1000 > STEPS - 0.5, "the last step")

        def whole():
            with contextlib.suppress(CommandError):  # its first states are still being written
                log = LogReader(os.path.join(self.logs, "state.log"))
                log.close()
                return log.begin == 0.0 and abs(log.end - STEPS / 1000.0) < 1e-9

        wait_for(whole, "a whole log")

    def test_joints_start_where_spawn_model_is_told(self):
        rospy.set_param("/arm", ARM)
        self.run_spawn_model("-urdf", "-param", "arm", "-model", "arm", "-J", "hinge", "-0.5")
        state = self.gazebo.get_link_state("arm::bar", "").link_state.pose.orientation
        self.assertAlmostEqual(2.0 * state.z / state.w, -0.5107, 3)

    def test_the_names_of_joints_that_are_not_there_are_said(self):
        rospy.set_param("/arm", ARM)
        text = self.run_spawn_model("-urdf", "-param", "arm", "-model", "arm_2",
                                    "-J", "no_such_joint", "1")
        self.assertIn("skipped unknown or non-settable joints: no_such_joint; "
                      "settable joints: hinge", text)
        self.assertIn("has no joint 'no_such_joint'; its joints are hinge", text)


if __name__ == "__main__":
    support.run("server_options")
