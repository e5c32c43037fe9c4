#!/usr/bin/env python3
"""The graph of a server without a display is that of gazebo_ros: names, types and counts."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph
import rospy
import rosservice
import support
from support import Program, executable, wait_for

TOPICS = {
    "/clock": ("rosgraph_msgs/Clock", 1, None),
    "/gazebo/link_states": ("gazebo_msgs/LinkStates", 1, 0),
    "/gazebo/model_states": ("gazebo_msgs/ModelStates", 1, 0),
    "/gazebo/parameter_descriptions": ("dynamic_reconfigure/ConfigDescription", 1, 0),
    "/gazebo/parameter_updates": ("dynamic_reconfigure/Config", 1, 0),
    "/gazebo/set_link_state": ("gazebo_msgs/LinkState", 0, 1),
    "/gazebo/set_model_state": ("gazebo_msgs/ModelState", 0, 1),
    "/rosout": ("rosgraph_msgs/Log", None, None),
}
"""Type, number of publishers and of subscribers; None for any. Source: gazebo_ros 2.9."""

SERVICES = {
    **{f"/gazebo/{name}": f"gazebo_msgs/{kind}" for name, kind in (
        ("apply_body_wrench", "ApplyBodyWrench"), ("apply_joint_effort", "ApplyJointEffort"),
        ("clear_body_wrenches", "BodyRequest"), ("clear_joint_forces", "JointRequest"),
        ("delete_light", "DeleteLight"), ("delete_model", "DeleteModel"),
        ("get_joint_properties", "GetJointProperties"),
        ("get_light_properties", "GetLightProperties"),
        ("get_link_properties", "GetLinkProperties"), ("get_link_state", "GetLinkState"),
        ("get_model_properties", "GetModelProperties"), ("get_model_state", "GetModelState"),
        ("get_physics_properties", "GetPhysicsProperties"),
        ("get_world_properties", "GetWorldProperties"),
        ("set_joint_properties", "SetJointProperties"),
        ("set_light_properties", "SetLightProperties"),
        ("set_link_properties", "SetLinkProperties"), ("set_link_state", "SetLinkState"),
        ("set_model_configuration", "SetModelConfiguration"),
        ("set_model_state", "SetModelState"),
        ("set_physics_properties", "SetPhysicsProperties"),
        ("spawn_sdf_model", "SpawnModel"), ("spawn_urdf_model", "SpawnModel"))},
    **{f"/gazebo/{name}": "std_srvs/Empty" for name in (
        "pause_physics", "reset_simulation", "reset_world", "unpause_physics")},
    "/gazebo/get_loggers": "roscpp/GetLoggers",
    "/gazebo/set_logger_level": "roscpp/SetLoggerLevel",
    "/gazebo/set_parameters": "dynamic_reconfigure/Reconfigure",
}
"""Types. Source: gazebo_ros 2.9."""


class GazeboNetwork(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.master = rosgraph.Master("/gazebo_network")
        support.Gazebo()
        # It is offered last.
        rospy.wait_for_service("/gazebo/set_parameters", timeout=support.SECONDS)

    def counts(self):
        """Publishers and subscribers of each topic, without those of this program."""
        published, subscribed, _ = self.master.getSystemState()
        me = rospy.get_name()
        return [{name: len(set(nodes) - {me}) for name, nodes in part}
                for part in (published, subscribed)]

    def test_topics_have_gazebos_types_and_numbers_of_nodes(self):
        kinds = dict(self.master.getTopicTypes())
        published, subscribed = self.counts()
        for name, (kind, publishers, subscribers) in TOPICS.items():
            self.assertEqual(kinds[name], kind, name)
            if publishers is not None:
                self.assertEqual(published.get(name, 0), publishers, name)
            if subscribers is not None:
                self.assertEqual(subscribed.get(name, 0), subscribers, name)

    def test_services_have_gazebos_types(self):
        for name, kind in SERVICES.items():
            self.assertEqual(rosservice.get_service_type(name), kind, name)

    def test_nothing_else_is_offered(self):
        published, subscribed = self.counts()
        topics = {name for part in (published, subscribed) for name, nodes in part.items() if nodes}
        self.assertLessEqual(topics, {*TOPICS, "/rosout_agg"})
        services = {name for name, nodes in self.master.getSystemState()[2]
                    if "/gazebo" in nodes}
        self.assertEqual(services, set(SERVICES))

    def test_zz_gzclient_opens_the_editor_all_the_same(self):
        with Program([executable("gazebo_ros", "gzclient"), "__name:=gazebo_gui"]) as program:
            wait_for(lambda: "http://127.0.0.1:" in program.text, "the address of the editor")
            program.interrupt()
            self.assertEqual(program.ended(), 0, program.text)


if __name__ == "__main__":
    support.run("gazebo_network")
