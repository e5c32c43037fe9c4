#!/usr/bin/env python3
"""The node offers exactly Gazebo's names, with Gazebo's types, and save_world."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph
import rospy
import rosservice
import support
from my_simulations_msgs.srv import SaveWorld

PUBLISHED = {
    "/clock": "rosgraph_msgs/Clock",
    "/gazebo/model_states": "gazebo_msgs/ModelStates",
    "/gazebo/link_states": "gazebo_msgs/LinkStates",
}
SUBSCRIBED = {
    "/gazebo/set_model_state": "gazebo_msgs/ModelState",
    "/gazebo/set_link_state": "gazebo_msgs/LinkState",
}
OURS = {"save_world": SaveWorld}
LOGGERS = {"/gazebo/get_loggers", "/gazebo/set_logger_level"}


class ApiSurface(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        cls.master = rosgraph.Master("/api_surface")

    def of_gazebo(self, index):
        return {name for name, nodes in self.master.getSystemState()[index] if "/gazebo" in nodes}

    def test_it_publishes_exactly_these_topics(self):
        self.assertEqual(self.of_gazebo(0), set(PUBLISHED) | {"/rosout"})

    def test_it_subscribes_to_exactly_these_topics(self):
        self.assertEqual(self.of_gazebo(1), set(SUBSCRIBED))

    def test_it_offers_exactly_these_services(self):
        offered = {f"/gazebo/{name}" for name in (*support.TYPES, *OURS)}
        self.assertEqual(self.of_gazebo(2), offered | LOGGERS)

    def test_topic_types_are_gazebos(self):
        types = dict(self.master.getTopicTypes())
        for topic, wanted in {**PUBLISHED, **SUBSCRIBED}.items():
            self.assertEqual(types[topic], wanted, topic)

    def test_service_types_are_gazebos(self):
        for name, service_class in {**support.TYPES, **OURS}.items():
            self.assertEqual(rosservice.get_service_type(f"/gazebo/{name}"), service_class._type)

    def test_use_sim_time_is_set(self):
        self.assertIs(rospy.get_param("/use_sim_time"), True)

    def test_the_world_says_which_it_is(self):
        self.assertEqual(rospy.get_param("/gazebo/world_base_name"), "empty")

    def test_the_empty_world_has_a_ground_and_runs(self):
        self.assertEqual(self.gazebo.names(), ["ground_plane"])
        self.assertFalse(self.gazebo.is_paused())
        started = self.gazebo.sim_time()
        support.wait_for(lambda: self.gazebo.sim_time() > started + 0.01, "a step")

    def test_gravity_and_step_are_gazebos(self):
        physics = self.gazebo.get_physics_properties()
        self.assertTrue(physics.success)
        self.assertEqual(physics.time_step, 0.001)
        self.assertEqual(physics.max_update_rate, 1000.0)
        self.assertEqual(physics.gravity.z, -9.8)
        self.assertEqual(physics.ode_config.sor_pgs_iters, 50)


if __name__ == "__main__":
    support.run("api_surface")
