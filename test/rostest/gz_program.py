"""The command gz against a running node."""
import os
import re
import tempfile
import unittest

import support
from support import Program, box, executable, pose, wait_for


class Gz(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        cls.program = executable("gazebo_ros", "gz")

    def setUp(self):
        self.gazebo.pause_physics()
        self.gazebo.clear()
        self.gazebo.spawn("one", where=pose(1.0, 2.0, 3.0))

    def gz(self, *words, status=0):
        with Program([self.program, *words]) as program:
            self.assertEqual(program.ended(), status, program.text)
            return program.text

    def where(self, name):
        return self.gazebo.get_model_state(name, "").pose.position

    def test_models_are_listed_and_shown(self):
        self.assertIn("one", self.gz("model", "-l").split())
        text = self.gz("model", "-m", "one", "-i")
        self.assertIn("is_static: false", text)
        self.assertIn("links: [", text)

    def test_pose_of_a_model_is_six_numbers(self):
        numbers = self.gz("model", "-m", "one", "-p").split()
        self.assertEqual(numbers, ["1", "2", "3", "0", "0", "0"])

    def test_model_is_moved_along_the_axes_that_are_given(self):
        self.gz("model", "-m", "one", "-x", "-4.5", "-Y", "0.5")
        self.assertEqual((self.where("one").x, self.where("one").y), (-4.5, 2.0))
        self.assertEqual(self.gz("model", "-m", "one", "-p").split()[5], "0.5")

    def test_models_are_added_from_files_and_deleted(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "a box.urdf")
            with open(file, "w", encoding="utf-8") as stream:
                stream.write(box())
            self.gz("model", "-m", "two", "-f", file, "-z", "5")
        self.assertEqual(self.where("two").z, 5.0)
        self.gz("model", "-m", "two", "-d")
        self.assertNotIn("two", self.gazebo.names())

    def test_unknown_model_gets_a_suggestion(self):
        self.assertIn("did you mean one", self.gz("model", "-m", "onne", "-i", status=1))

    def test_world_goes_on_stands_still_and_steps(self):
        self.gz("world", "-p", "0")
        self.assertFalse(self.gazebo.get_physics_properties().pause)
        self.gz("world", "-p", "1")
        self.assertTrue(self.gazebo.get_physics_properties().pause)
        before = self.gazebo.get_world_properties().sim_time
        self.gz("world", "-m", "100")
        self.assertAlmostEqual(self.gazebo.get_world_properties().sim_time - before, 0.1, 6)

    def test_models_and_time_are_reset(self):
        self.gz("world", "-m", "50")
        self.gz("world", "-o")
        self.assertGreater(self.gazebo.get_world_properties().sim_time, 0.0)
        self.gz("world", "-r")
        self.assertEqual(self.gazebo.get_world_properties().sim_time, 0.0)

    def test_physics_settings_are_shown_and_changed(self):
        self.gz("physics", "-g", "0,0,-1.62", "-i", "77")
        text = self.gz("physics")
        self.assertIn("gravity: 0,0,-1.62 m/s^2", text)
        self.assertIn("iterations: 77", text)
        self.gz("physics", "-g", "0,0,-9.8", "-i", "50")
        self.assertIn("three numbers", self.gz("physics", "-g", "down", status=1))

    def test_stats_tell_whether_time_stands_still(self):
        self.assertRegex(self.gz("stats", "-d", "0.3"),
                         r"Factor\[0\.00\] SimTime\[[\d.]+\] RealTime\[[\d.]+\] Paused\[T\]")
        self.gazebo.unpause_physics()
        self.assertTrue(wait_for(lambda: re.search(
            r"Factor\[(?!0\.00)", self.gz("stats", "-d", "0.5")), "a factor above 0"))

    def test_topics_of_the_node_are_listed(self):
        topics = self.gz("topic", "-l").split()
        self.assertIn("/clock", topics)
        self.assertIn("/gazebo/set_model_state", topics)

    def test_what_is_not_offered_says_what_to_use(self):
        self.assertIn("apply_joint_effort", self.gz("joint", "-m", "one", status=2))
