"""What each display of our rviz configurations names is in the live graph, with the right type."""
import glob
import os
import unittest
import xml.etree.ElementTree as ElementTree

import rospy
import yaml
from roslib.message import get_message_class
from support import Gazebo, Transforms, wait_for

CONFIGURATIONS = sorted(glob.glob(os.path.join(
    os.path.dirname(os.path.abspath(__file__)), "..", "..", "config", "*.rviz")))
TYPES = {"rviz/LaserScan": "sensor_msgs/LaserScan", "rviz/Odometry": "nav_msgs/Odometry",
         "rviz/Image": "sensor_msgs/Image", "rviz/Camera": "sensor_msgs/Image",
         "rviz/PointCloud2": "sensor_msgs/PointCloud2", "rviz/Map": "nav_msgs/OccupancyGrid",
         "rviz/Path": "nav_msgs/Path", "rviz/Marker": "visualization_msgs/Marker"}
"""Displays that show a topic, and the type they subscribe to (rviz's default plugins)."""
WITHOUT_TOPIC = {"rviz/Grid", "rviz/RobotModel", "rviz/TF", "rviz/Axes"}


def topic_of(display):
    """The topic that a display shows; None for one that shows none."""
    return display.get("Topic") or display.get("Image Topic")


class RvizConfiguration(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()
        cls.transforms = Transforms()
        cls.files = {}
        for path in CONFIGURATIONS:
            with open(path, encoding="utf-8") as stream:
                cls.files[os.path.basename(path)] = yaml.safe_load(stream)["Visualization Manager"]
        wait_for(lambda: "robo" in cls.gazebo.names(), "the robot")

    def displays(self):
        for name, manager in self.files.items():
            for display in manager["Displays"]:
                yield name, manager, display

    def test_there_is_a_configuration(self):
        self.assertIn("lab_robot.rviz", self.files)

    def test_displays_are_of_kinds_that_this_test_knows(self):
        for name, _, display in self.displays():
            self.assertIn(display["Class"], {*TYPES, *WITHOUT_TOPIC}, name)
            self.assertEqual(topic_of(display) is None, display["Class"] in WITHOUT_TOPIC, name)

    def test_each_topic_is_published_with_the_type_of_its_display(self):
        for name, _, display in self.displays():
            if topic_of(display) is None:
                continue
            wanted = (topic_of(display), TYPES[display["Class"]])
            wait_for(lambda wanted=wanted: list(wanted) in rospy.get_published_topics(),
                     f"{wanted} of {name}")

    def test_each_message_can_be_shown_in_the_fixed_frame(self):
        for name, manager, display in self.displays():
            topic = topic_of(display)
            if topic is None:
                continue
            heard = []
            subscriber = rospy.Subscriber(topic, get_message_class(TYPES[display["Class"]]),
                                          heard.append)
            wait_for(lambda heard=heard: heard, f"a message on {topic} of {name}")
            subscriber.unregister()
            frame = heard[0].header.frame_id
            self.transforms.wait(manager["Global Options"]["Fixed Frame"], frame,
                                 f"a way from {frame} of {topic} to the fixed frame of {name}")

    def test_views_follow_a_frame_that_there_is(self):
        for name, manager in self.files.items():
            target = manager["Views"]["Current"]["Target Frame"]
            self.transforms.wait(manager["Global Options"]["Fixed Frame"], target,
                                 f"the frame {target} that {name} follows")

    def test_each_link_of_the_robot_that_is_shown_has_a_frame(self):
        for name, manager, display in self.displays():
            if display["Class"] != "rviz/RobotModel":
                continue
            robot = ElementTree.fromstring(rospy.get_param(display["Robot Description"]))
            for link in robot.findall("link"):
                frame = (display.get("TF Prefix") or "") + link.get("name")
                self.transforms.wait(manager["Global Options"]["Fixed Frame"], frame,
                                     f"the frame of link {frame} that {name} shows")
