#!/usr/bin/env python3
"""The live graph and the interface table say the same, both ways."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph
import rospy
import rosservice
import support

from my_simulations.ros import interface
from my_simulations.ros.interface import PUBLISHES, SERVES, SUBSCRIBES

NODE = "/gazebo"
INDEX = {PUBLISHES: 0, SUBSCRIBES: 1, SERVES: 2}
"""Where the master's system state lists what."""


class ApiSurface(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.master = rosgraph.Master("/api_surface")
        cls.extensions = rospy.get_param("/gazebo/extensions", True)
        cls.gazebo = support.Gazebo()
        if cls.extensions:
            rospy.wait_for_service("/gazebo/open_editor", timeout=support.SECONDS)

    def rows(self, direction):
        return [row for row in interface.offered_rows(extensions=self.extensions)
                if row.direction is direction]

    def of_gazebo(self, direction):
        return {name for name, nodes in self.master.getSystemState()[INDEX[direction]]
                if NODE in nodes}

    def test_everything_in_the_table_is_offered_and_nothing_else(self):
        for direction in INDEX:
            wanted = {row.under(NODE) for row in self.rows(direction)}
            support.wait_for(lambda d=direction, w=wanted: w <= self.of_gazebo(d),
                             f"the {direction.value} names")
            self.assertEqual(self.of_gazebo(direction), wanted)

    def test_topic_types_are_the_tables(self):
        types = dict(self.master.getTopicTypes())
        for direction in (PUBLISHES, SUBSCRIBES):
            for row in self.rows(direction):
                self.assertEqual(types[row.under(NODE)], row.type, row.name)

    def test_service_types_are_the_tables(self):
        for row in self.rows(SERVES):
            self.assertEqual(rosservice.get_service_type(row.under(NODE)), row.type)

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
