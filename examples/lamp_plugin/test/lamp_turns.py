#!/usr/bin/env python3
"""The lamp turns to both sides, in the running simulator."""
import unittest

import rospy
import rostest
from std_msgs.msg import Float64


class LampTurns(unittest.TestCase):
    def test_it_turns_to_both_sides(self):
        seen = []
        while not seen or min(seen) > -0.5 or max(seen) < 0.5:
            seen.append(rospy.wait_for_message("lamp", Float64, 60.0).data)
        self.assertLess(max(map(abs, seen)), 0.6)


if __name__ == "__main__":
    rospy.init_node("lamp_turns")
    rostest.rosrun("lamp_plugin", "lamp", LampTurns)
