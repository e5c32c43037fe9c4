"""The list of topics: what the master says, with what plugins know."""
from __future__ import annotations

from my_simulations.geometry import IDENTITY, Pose, rotate
from my_simulations.plugins.graph import TopicUse
from my_simulations.ros.plugins.topic_graph import list_topics

SCAN, CLOUD, TWIST = "sensor_msgs/LaserScan", "sensor_msgs/PointCloud2", "geometry_msgs/Twist"


def resolve(name):
    return "/" + name.lstrip("/")


def of(name, kind, *uses, publishers=("/gazebo",), subscribers=()):
    state = ([[name, list(publishers)]] if publishers else [],
             [[name, list(subscribers)]] if subscribers else [], [])
    found, = list_topics(state, {name: kind}, uses, resolve)
    return found


def use(name, kind, heard=False, model="robo", link="", sensor="", pose=IDENTITY):
    return TopicUse(name, kind, heard, model, link, sensor, pose)


def test_a_topic_that_no_plugin_has_is_nobodys():
    found = of("/chatter", "std_msgs/String", publishers=("/a", "/b"), subscribers=("/c",))
    assert (found.kind, found.publishers, found.subscribers) == ("std_msgs/String", 2, 1)
    assert (found.model, found.link, found.driven) == ("", "", False)


def test_a_sensor_s_topic_is_where_the_sensor_is():
    found = of("/scan", SCAN, use("scan", SCAN, link="base", sensor="ray", pose=Pose((0, 0, 1))))
    assert (found.model, found.link, found.pose) == ("robo", "base", Pose((0, 0, 1)))


def test_points_of_a_camera_are_in_optical_axes_those_of_a_laser_are_not():
    camera = of("/points", CLOUD, use("points", CLOUD, link="head", sensor="depth"))
    forward = rotate(camera.pose.orientation, (0.0, 0.0, 1.0))
    assert [round(part, 9) for part in forward] == [1.0, 0.0, 0.0]
    right = rotate(camera.pose.orientation, (1.0, 0.0, 0.0))
    assert [round(part, 9) for part in right] == [0.0, -1.0, 0.0]
    laser = of("/points", CLOUD, use("points", CLOUD, link="head", sensor="gpu_ray"))
    assert laser.pose == IDENTITY


def test_what_is_driven_is_heard_by_a_plugin():
    assert of("/cmd_vel", TWIST, use("cmd_vel", TWIST, heard=True), publishers=(),
              subscribers=("/gazebo",)).driven


def test_a_topic_of_several_robots_belongs_to_none():
    assert of("/cmd_vel", TWIST, use("cmd_vel", TWIST, True), use("cmd_vel", TWIST, True, "b"),
              publishers=(), subscribers=("/gazebo",)).model == ""


def test_a_type_that_only_the_plugin_knows():
    assert of("/scan", "*", use("scan", SCAN)).kind == SCAN
    assert of("/other", "*").kind == ""
