#!/usr/bin/env python3
"""Two simulators on one master, one under another name in a namespace, with names remapped."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph
import rospy
import support
from gazebo_msgs.msg import ModelState, ModelStates
from rosgraph_msgs.msg import Clock
from support import Collected, pose

from my_simulations.ros import interface

OTHER = "/lab/world_b"
MOVED = {"/clock": "/lab/clock", "/lab/world_b/model_states": "/lab/states",
         "/lab/world_b/delete_model": "/lab/remove"}
"""What the launch file remaps."""


class TwoSimulators(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.one = support.Gazebo()
        for name in ("/lab/remove", f"{OTHER}/open_editor"):
            rospy.wait_for_service(name, timeout=support.SECONDS)
        cls.spawn = rospy.ServiceProxy(f"{OTHER}/spawn_urdf_model", support.srv.SpawnModel)
        cls.world = rospy.ServiceProxy(f"{OTHER}/get_world_properties",
                                       support.srv.GetWorldProperties)
        cls.remove = rospy.ServiceProxy("/lab/remove", support.srv.DeleteModel)

    def test_the_whole_interface_moves_with_the_node_and_remappings_are_kept(self):
        master = rosgraph.Master("/two_simulators")
        wanted = {MOVED.get(row.under(OTHER), row.under(OTHER)) for row in interface.TABLE}

        def offered():
            return {name for part in master.getSystemState() for name, nodes in part
                    if OTHER in nodes}

        support.wait_for(lambda: offered() == wanted, "all names of the other simulator")

    def test_each_has_its_own_models(self):
        self.assertTrue(self.one.spawn("mine", where=pose(0.0, 0.0, 1.0)).success)
        self.assertTrue(self.spawn("yours", support.box(), "", pose(0.0, 0.0, 2.0), "").success)
        self.assertIn("mine", self.one.names())
        self.assertNotIn("yours", self.one.names())
        self.assertIn("yours", self.world().model_names)
        self.assertNotIn("mine", self.world().model_names)
        self.assertFalse(self.remove("mine").success)
        self.assertTrue(self.remove("yours").success)
        self.assertTrue(self.one.delete_model("mine").success)

    def test_each_has_its_own_clock_and_topics(self):
        clock, states = Collected("/lab/clock", Clock), Collected("/lab/states", ModelStates)
        support.wait_for(lambda: clock.all() and states.all(), "both topics")
        self.assertEqual(clock.sources(), [OTHER])
        self.one.pause_physics()
        heard = len(clock.all())
        support.wait_for(lambda: len(clock.all()) > heard + 10, "time going on there")
        self.assertTrue(self.spawn("moved", support.box(), "", pose(0.0, 0.0, 2.0), "").success)
        topic = rospy.Publisher(f"{OTHER}/set_model_state", ModelState, queue_size=10)
        support.wait_for(topic.get_num_connections, "a connection")
        topic.publish(ModelState("moved", pose(7.0, 0.0, 2.0), support.twist(), ""))
        support.wait_for(lambda: [one for one in states.all()[-1].pose if one.position.x == 7.0],
                         "the move")
        self.remove("moved")
        self.one.unpause_physics()
        clock.close()
        states.close()


if __name__ == "__main__":
    support.run("two_simulators")
