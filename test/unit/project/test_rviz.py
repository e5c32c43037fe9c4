"""The configuration of rviz shows what the lab robot publishes."""
from __future__ import annotations

import pathlib
import xml.etree.ElementTree as ElementTree

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
CONFIG = ROOT / "config" / "lab_robot.rviz"
TOPIC_KEYS = {"rviz/LaserScan": "Topic", "rviz/Odometry": "Topic", "rviz/Image": "Image Topic"}


def manager():
    return yaml.safe_load(CONFIG.read_text(encoding="utf-8"))["Visualization Manager"]


def test_each_display_shows_a_topic_of_the_robot():
    plugins = {one.get("filename"): one for one in
               ElementTree.parse(ROOT / "urdf" / "robo.urdf").iter("plugin")}

    def said(library, name):
        return plugins[f"libgazebo_ros_{library}.so"].findtext(name).strip()

    published = {
        "rviz/LaserScan": "/" + said("laser", "topicName"),
        "rviz/Odometry": "/" + said("diff_drive", "odometryTopic"),
        "rviz/Image": f"/{said('camera', 'cameraName')}/image_raw"}
    shown = {one["Class"]: one[TOPIC_KEYS[one["Class"]]] for one in manager()["Displays"]
             if one["Class"] in TOPIC_KEYS}
    assert shown == published
    assert manager()["Global Options"]["Fixed Frame"] == said("diff_drive", "odometryFrame")
    assert manager()["Views"]["Current"]["Target Frame"] == said("diff_drive", "robotBaseFrame")


def test_the_robot_shown_is_the_one_of_the_launch_files():
    (model,) = (one for one in manager()["Displays"] if one["Class"] == "rviz/RobotModel")
    world = ElementTree.parse(ROOT / "launch" / "my_world.launch").getroot()
    assert model["Robot Description"] in {one.get("name") for one in world.iter("param")}
    nodes = {one.get("pkg"): one for one in ElementTree.parse(
        ROOT / "launch" / "view_robot.launch").getroot().iter("node")}
    assert set(nodes) == {"robot_state_publisher", "rviz"}
    assert f"config/{CONFIG.name}" in nodes["rviz"].get("args")
