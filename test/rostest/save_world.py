"""The running world is saved to a file below the allowed folders, and nowhere else."""
import os
import tempfile
import unittest
from xml.etree import ElementTree

import rospy
import support
from my_simulations_msgs.srv import SaveWorld


class Saving(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        rospy.wait_for_service("/gazebo/save_world", support.SECONDS)
        cls.save = rospy.ServiceProxy("/gazebo/save_world", SaveWorld)

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        rospy.set_param("/gazebo/save_roots", [self.folder.name])
        self.addCleanup(rospy.delete_param, "/gazebo/save_roots")

    def test_a_saved_world_holds_the_present_models(self):
        self.assertTrue(self.gazebo.spawn("crate", where=support.pose(1.0, 2.0, 3.0)).success)
        self.addCleanup(self.gazebo.delete_model, "crate")
        self.gazebo.pause_physics()
        self.addCleanup(self.gazebo.unpause_physics)
        there = self.gazebo.get_model_state("crate", "").pose.position
        answer = self.save(path="w.world", overwrite=False, inline=True)
        self.assertTrue(answer.success, answer.status_message)
        self.assertEqual(answer.path, os.path.realpath(os.path.join(self.folder.name, "w.world")))
        world = ElementTree.parse(answer.path).getroot().find("world")
        self.assertEqual([m.get("name") for m in world.findall("model")],
                         ["ground_plane", "crate"])
        numbers = [float(n) for n in world.find("model[@name='crate']/pose").text.split()]
        for found, wanted in zip(numbers, (there.x, there.y, there.z)):
            self.assertAlmostEqual(found, wanted, 9)
        self.assertIsNone(world.find("state"))
        first = open(answer.path, "rb").read()
        again = self.save(path="again.world", overwrite=False, inline=True)
        self.assertEqual(open(again.path, "rb").read(), first)

    def test_with_state_sim_time_is_saved_too(self):
        support.wait_for(lambda: self.gazebo.sim_time() > 0.0, "a step")
        answer = self.save(path="s.world", inline=True, state=True)
        self.assertTrue(answer.success, answer.status_message)
        world = ElementTree.parse(answer.path).getroot().find("world")
        self.assertNotEqual(world.findtext("state/sim_time"), "0 0")

    def test_a_file_is_not_replaced_unasked(self):
        self.assertTrue(self.save(path="w.world", overwrite=False, inline=True).success)
        refused = self.save(path="w.world", overwrite=False, inline=True)
        self.assertFalse(refused.success)
        self.assertIn("already exists", refused.status_message)
        self.assertTrue(self.save(path="w.world", overwrite=True, inline=True).success)

    def test_other_places_are_refused(self):
        for path in ("/etc/w.world", "../w.world", "w.txt"):
            refused = self.save(path=path, overwrite=True, inline=True)
            self.assertFalse(refused.success, path)
            self.assertTrue(refused.status_message.startswith("SaveWorld: "))

    def test_includes_stay_includes_when_asked(self):
        answer = self.save(path="i.world", overwrite=False, inline=False)
        world = ElementTree.parse(answer.path).getroot().find("world")
        self.assertEqual([uri.text for uri in world.findall("include/uri")],
                         ["model://ground_plane"])
