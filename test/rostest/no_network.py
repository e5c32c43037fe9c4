#!/usr/bin/env python3
"""With enable_ros_network false there is a clock and nothing else."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph
import rospy
import support
from rosgraph_msgs.msg import Clock


class NoNetwork(unittest.TestCase):
    def test_only_the_clock_and_the_loggers_are_offered(self):
        rospy.wait_for_message("/clock", Clock, timeout=support.SECONDS)
        offered = [sorted(name for name, nodes in part if "/gazebo" in nodes)
                   for part in rosgraph.Master("/no_network").getSystemState()]
        self.assertEqual(offered, [["/clock", "/rosout"], [],
                                   ["/gazebo/get_loggers", "/gazebo/set_logger_level"]])

    def test_a_use_sim_time_that_is_set_is_left_alone(self):
        rospy.wait_for_message("/clock", Clock, timeout=support.SECONDS)
        support.wait_for(lambda: rospy.has_param("/gazebo/my_simulations/engine_pid"), "the node")
        self.assertIs(rospy.get_param("/use_sim_time"), False)


if __name__ == "__main__":
    support.run("no_network")
