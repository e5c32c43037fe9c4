#!/usr/bin/env python3
"""The lab robot drives by cmd_vel; odometry, tf and joint states report its motion."""
import math
import os
import signal
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState
from support import Collected, Gazebo, box, pose, run, wait_for
from tf2_msgs.msg import TFMessage

ROBOT = "robo"


def stamped(message):
    """What a message says, each with a header."""
    return message.transforms if isinstance(message, TFMessage) else [message]


def since_reset(topic):
    """What has come on a topic after the last time that the clock went back."""
    found = [one for message in topic.all() for one in stamped(message)]
    begins = [n for n, (one, two) in enumerate(zip(found, found[1:]), 1)
              if two.header.stamp < one.header.stamp]
    return found[begins[-1] if begins else 0:]


class Robot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()
        cls.log = Collected("/rosout", Log)
        cls.odom = Collected("/odom", Odometry)
        cls.tf = Collected("/tf", TFMessage)
        cls.joints = Collected("/joint_states", JointState)
        cls.command = rospy.Publisher("/cmd_vel", Twist, queue_size=1, latch=True)
        wait_for(lambda: ROBOT in cls.gazebo.names(), "the robot")
        wait_for(lambda: cls.command.get_num_connections() > 0, "a subscriber of cmd_vel")
        wait_for(cls.odom.all, "odometry")

    def setUp(self):
        self.stop()
        topics = (self.odom, self.tf, self.joints)
        for topic in topics:
            topic.clear()
        for topic in topics:  # they know the time before the reset
            wait_for(topic.all, "a message")
        self.gazebo.reset_simulation()
        for topic in topics:
            wait_for(lambda topic=topic: len(since_reset(topic)) < sum(
                len(stamped(message)) for message in topic.all()), "the first message of the reset")

    def drive(self, forward, turn=0.0):
        self.command.publish(Twist(Vector3(forward, 0, 0), Vector3(0, 0, turn)))

    def stop(self):
        self.drive(0.0)
        wait_for(self.stands, "the robot standing")

    def stands(self):
        twist = self.last().twist.twist
        return abs(twist.linear.x) < 1e-3 and abs(twist.angular.z) < 1e-3

    def last(self):
        return self.odom.all()[-1]

    def truth(self):
        return self.gazebo.get_model_state(ROBOT, "").pose

    def test_one_metre(self):
        self.drive(0.25)
        wait_for(lambda: self.last().pose.pose.position.x > 1.0, "a metre")
        self.stop()
        odom, truth = self.last().pose.pose.position, self.truth().position
        self.assertAlmostEqual(odom.x, truth.x, delta=0.01 * odom.x)
        self.assertAlmostEqual(truth.y, 0.0, delta=0.01)

    def test_tf_says_what_odometry_says(self):
        self.drive(0.2, 0.5)
        wait_for(lambda: self.last().pose.pose.position.x > 0.2, "some way")
        self.stop()
        odoms = {one.header.stamp.to_nsec(): one.pose.pose.position
                 for one in since_reset(self.odom)}
        found = [(one.header.stamp.to_nsec(), one.transform.translation)
                 for one in since_reset(self.tf)
                 if (one.header.frame_id, one.child_frame_id) == ("odom", "base_footprint")]
        both = [(at, odoms[stamp]) for stamp, at in found if stamp in odoms]
        self.assertGreater(len(both), 10)
        for at, odom in both[-10:]:
            self.assertEqual((at.x, at.y), (odom.x, odom.y))

    def test_joint_states_come_at_their_rate(self):
        wait_for(lambda: len(since_reset(self.joints)) > 20, "joint states")
        states = since_reset(self.joints)
        self.assertEqual(states[0].name, ["left_wheel_joint", "right_wheel_joint"])
        stamps = [one.header.stamp.to_nsec() for one in states]
        self.assertEqual({b - a for a, b in zip(stamps, stamps[1:])}, {20_000_000})

    def test_a_turn_on_the_spot(self):
        self.drive(0.0, 1.0)
        wait_for(lambda: self.last().pose.pose.orientation.z > math.sin(0.5), "a turn")
        self.stop()
        odom, truth = self.last().pose.pose, self.truth()
        angle = 2.0 * math.atan2(odom.orientation.z, odom.orientation.w)
        true = 2.0 * math.atan2(truth.orientation.z, truth.orientation.w)
        self.assertAlmostEqual(angle, true, delta=0.05 * angle)

    def test_a_new_engine_drives_on(self):
        self.drive(0.2)
        wait_for(lambda: self.last().pose.pose.position.x > 0.1, "some way")
        os.kill(rospy.get_param("/gazebo/my_simulations/engine_pid"), signal.SIGKILL)
        before = self.last().pose.pose.position.x
        wait_for(lambda: self.last().pose.pose.position.x > before + 0.1, "some more way")
        told = [one for one in self.odom.all() if one.pose.pose.position.x > 0.0]
        for one, two in zip(told, told[1:]):
            # The new engine may continue some steps back.
            late = max(0.0, (two.header.stamp - one.header.stamp).to_sec() - 0.02)
            self.assertLess(two.pose.pose.position.x - one.pose.pose.position.x, 0.02 + 0.2 * late)

    def test_what_nobody_knows_is_told_once(self):
        extra = '<gazebo><plugin name="mystery" filename="libmystery.so"/></gazebo>'
        for name in ("one", "two"):
            self.assertTrue(self.gazebo.spawn(name, box(extra=extra), pose(3.0, 0.0, 1.0)).success)
            self.gazebo.delete_model(name)
        wait_for(lambda: self.warnings("libmystery.so"), "a warning")
        self.assertEqual(len(self.warnings("libmystery.so")), 1)

    def warnings(self, text):
        return [one for one in self.log.all() if text in one.msg and one.level == Log.WARN]


if __name__ == "__main__":
    run("robot")
