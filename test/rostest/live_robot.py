#!/usr/bin/env python3
"""A robot in a Python program publishes what the node publishes, bit for bit."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, LaserScan
from support import Collected, run, wait_for

import my_simulations
from my_simulations.messages import from_ros

WORLD = os.path.join(os.path.dirname(os.path.abspath(__file__)), "live_robot.world")
TOPICS = {"/scan": LaserScan, "/odom": Odometry, "/imu": Imu}


class LiveRobot(unittest.TestCase):
    def test_messages_are_those_of_the_node(self):
        heard = {name: Collected(name, kind) for name, kind in TOPICS.items()}
        for name, topic in heard.items():
            wait_for(lambda topic=topic: len(topic.all()) > 3, f"messages on {name}")
        expected = {name: topic.all() for name, topic in heard.items()}
        end = max(one[-1].header.stamp.to_sec() for one in expected.values())
        with my_simulations.open_world(WORLD) as world:
            topics = {name: world.topics[name] for name in TOPICS}
            found = {name: {} for name in TOPICS}
            while world.time < end + world.step_size:
                world.step(100)
                for name, topic in topics.items():
                    found[name].update((one.header.stamp.to_nsec(), one) for one in topic.take())
        self.assertEqual(world.issues, [])
        for name, messages in expected.items():
            for one in messages:
                ours, theirs = found[name][one.header.stamp.to_nsec()], from_ros(one)
                ours.header.seq = theirs.header.seq = 0   # counts from the first subscriber on
                self.assertEqual(ours, theirs, name)


if __name__ == "__main__":
    run("live_robot")
