#!/usr/bin/env python3
"""A robot that is spawned and driven in a Python program measures what it measures under ROS."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, LaserScan
from support import Collected, Gazebo, pose, run, wait_for

import my_simulations
from my_simulations.messages import from_ros

HERE = os.path.dirname(os.path.abspath(__file__))
WORLD = os.path.join(HERE, "driven_robot.world")
ROBOT = os.path.join(HERE, os.pardir, "data", "robots", "burger.urdf")
TOPICS = {"/scan": LaserScan, "/odom": Odometry, "/imu": Imu}
COMMAND = Twist(Vector3(0.2, 0.0, 0.0), Vector3(0.0, 0.0, 0.3))
STEPS = 3000


class DrivenRobot(unittest.TestCase):
    def setUp(self):
        self.gazebo = Gazebo()

    def test_a_spawned_robot_drives_and_measures_the_same(self):
        with open(ROBOT, encoding="utf-8") as stream:
            self.assertTrue(self.gazebo.spawn("burger", stream.read(), pose(z=0.01),
                                              namespace="/").success)
        heard = {name: Collected(name, kind) for name, kind in TOPICS.items()}
        before = self.steps_until_it_moves()
        answer = self.gazebo.step_world(STEPS)
        end = int(round(answer.sim_time.to_sec() * 1000))
        found = self.driven_in_python(before, end)
        for name, topic in heard.items():
            last = max(found[name])
            wait_for(lambda topic=topic, last=last: topic.all() and
                     topic.all()[-1].header.stamp.to_nsec() >= last, f"the last message on {name}")
            messages = topic.all()
            self.assertGreater(len(messages), 10, name)
            for one in messages:
                ours, theirs = found[name][one.header.stamp.to_nsec()], from_ros(one)
                ours.header.seq = theirs.header.seq = 0   # counts from the first subscriber on
                self.assertEqual(ours, theirs, name)
        moved = heard["/odom"].all()[-1].pose.pose.position
        self.assertGreater(moved.x, 0.2)

    def steps_until_it_moves(self):
        """Send a command; returns the step before the one in which the wheels obeyed it."""
        wait_for(lambda: self.connected("/cmd_vel"), "a subscriber of /cmd_vel")
        self.gazebo.step_world(200)   # at rest
        still = abs(self.rate())
        self.drive.publish(COMMAND)
        step = [self.step()]

        def moves():
            step.append(self.step())
            self.gazebo.step_world(1)
            return abs(self.rate()) > still + 0.1

        wait_for(moves, "a turn of the wheels")
        return step[-1]

    def connected(self, topic):
        if not hasattr(self, "drive"):
            self.drive = rospy.Publisher(topic, Twist, queue_size=1)
        return self.drive.get_num_connections()

    def rate(self):
        return self.gazebo.get_joint_properties("wheel_left_joint").rate[0]

    def step(self):
        return int(round(self.gazebo.sim_time() * 1000))

    def driven_in_python(self, before, end):
        """The messages of the same run without ROS, by topic and time stamp, ns."""
        found = {name: {} for name in TOPICS}
        with my_simulations.open_world(WORLD) as world:
            world.spawn(ROBOT, "burger", [0, 0, 0.01], namespace="/")
            topics = {name: world.topics[name] for name in TOPICS}
            world.step(before - 1)   # the controller acts at the end of a step
            world.publish("/cmd_vel", COMMAND)
            while world.time < end * 1e-3 - 1e-9:
                world.step(min(100, end - int(round(world.time * 1000))))
                for name, topic in topics.items():
                    found[name].update((one.header.stamp.to_nsec(), one) for one in topic.take())
            self.assertEqual(world.issues, [])
        return found


if __name__ == "__main__":
    run("driven_robot")
