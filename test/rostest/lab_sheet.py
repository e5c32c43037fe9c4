#!/usr/bin/env python3
"""The lab sheet as printed: its launch file with its defaults, but for the place of the robot."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import object_flow_support as flow
import rospy
import support
from rosgraph_msgs.msg import Clock


class LabSheet(support.GazeboCase):
    def test_the_clock_ticks(self):
        self.assertIs(rospy.get_param("/use_sim_time"), True)
        clock = support.Collected("/clock", Clock)
        ticks = support.wait_for(lambda: len(clock.all()) > 100 and clock.all(), "100 ticks")
        times = [tick.clock.to_sec() for tick in ticks]
        self.assertEqual(times, sorted(times))
        self.assertGreater(times[-1], times[0])

    def test_the_robot_is_there_once_and_stands_where_the_arguments_say(self):
        support.wait_for(lambda: "robo" in self.gazebo.names(), "the robot")
        self.assertEqual(self.gazebo.names().count("robo"), 1)
        self.assertEqual(sorted(self.gazebo.names()), ["ground_plane", "robo"])
        start = self.gazebo.sim_time()
        support.wait_for(lambda: self.gazebo.sim_time() > start + 1.0, "a second of the world")
        state = self.gazebo.get_model_state("robo", "")
        self.assertAlmostEqual(state.pose.position.x, 1.5, delta=0.01)
        self.assertAlmostEqual(state.pose.position.y, -0.5, delta=0.01)
        self.assertAlmostEqual(state.pose.position.z, 0.0, delta=0.01)
        self.assertGreater(state.pose.orientation.w, 0.999)

    def test_the_parameters_hold_what_the_sheets_line_reads(self):
        with open(flow.package_file("urdf/robo.urdf"), encoding="utf-8") as stream:
            self.assertEqual(rospy.get_param("/robot_description").strip(), stream.read().strip())

    def test_the_worlds_object_list_is_loaded(self):
        support.wait_for(lambda: rospy.get_param("/objects/MY_OBJECT", None), "the list")
        self.assertEqual(rospy.get_param("/objects/MY_OBJECT/model_type"), "urdf")
        support.wait_for(lambda: rospy.get_param("/object_groups", None), "the groups")


if __name__ == "__main__":
    support.run("lab_sheet")
