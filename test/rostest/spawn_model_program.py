#!/usr/bin/env python3
"""The program spawn_model and the Python functions beside it."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import support
from free_ports import silent_uri
from gazebo_ros import gazebo_interface
from support import Program, box, executable, pose, wait_for


class SpawnModelProgram(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        cls.program = executable("gazebo_ros", "spawn_model")

    def setUp(self):
        self.gazebo.unpause_physics()
        self.gazebo.clear()
        rospy.set_param("/a_box", box())
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = os.path.join(folder.name, "a box.urdf")
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(box())

    def run_it(self, *words, status=0):
        with Program([self.program, *words, "__log:=x.log"]) as program:
            self.assertEqual(program.ended(), status, program.text)
            return program.text

    def where(self, name):
        return self.gazebo.get_model_state(name, "").pose.position

    def test_a_urdf_parameter_at_a_pose(self):
        text = self.run_it("-urdf", "-param", "a_box", "-model", "one", "-x", "-1.5", "-y", "2.",
                           "-z", "1e-1", "-Y", "-1e-5")
        self.assertIn("Successfully spawned", text)
        self.assertAlmostEqual(self.where("one").x, -1.5, 3)
        self.assertAlmostEqual(self.where("one").y, 2.0, 3)

    def test_a_file_with_blanks_in_its_name(self):
        self.run_it("-urdf", "-file", self.file, "-model", "one")
        self.assertIn("one", self.gazebo.names())

    def test_a_model_of_the_database(self):
        self.gazebo.delete_model("ground_plane")
        self.run_it("-sdf", "-database", "ground_plane", "-model", "ground_plane")
        self.assertEqual(self.gazebo.names(), ["ground_plane"])

    def test_a_reference_frame(self):
        self.gazebo.spawn("one", where=pose(5.0, 0.0, 0.1))
        self.run_it("-urdf", "-param", "a_box", "-model", "two", "-reference_frame", "one",
                    "-y", "1")
        self.assertAlmostEqual(self.where("two").x, 5.0, 2)
        self.assertAlmostEqual(self.where("two").y, 1.0, 2)

    def test_a_joint_that_the_model_lacks_is_a_warning_that_names_a_similar_one(self):
        other = '<link name="tip"/><joint name="hinge" type="continuous"><parent link="body"/>' \
                '<child link="tip"/><axis xyz="0 0 1"/></joint>'
        rospy.set_param("/an_arm", box(extra=other.replace(
            '<link name="tip"/>', box(link="tip").partition(">")[2].replace("</robot>", ""))))
        self.run_it("-urdf", "-param", "an_arm", "-model", "one", "-J", "hinge", "0.5")
        text = self.run_it("-urdf", "-param", "an_arm", "-model", "two", "-x", "3", "-J", "hnige",
                           "0.5")
        self.assertIn("has no joint 'hnige'; did you mean hinge?", text)
        self.assertIn("two", self.gazebo.names())

    def test_messages_name_the_model_and_its_file(self):
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(box(extra="\n<jiont/>"))
        heard = support.heard_on_rosout(f"model 'one', {self.file}:2")
        self.run_it("-urdf", "-file", self.file, "-model", "one")
        heard()
        heard = support.heard_on_rosout("model 'two', model_xml:2")
        self.gazebo.spawn("two", box(extra="\n<jiont/>"), where=pose(3.0))
        heard()

    def test_unpause(self):
        self.gazebo.pause_physics()
        self.run_it("-urdf", "-param", "a_box", "-model", "one", "-unpause")
        self.assertFalse(self.gazebo.is_paused())

    def test_waiting_for_another_model_also_while_paused(self):
        self.gazebo.pause_physics()
        words = ["-urdf", "-param", "a_box", "-model", "two", "-wait", "one"]
        with Program([self.program, *words]) as program:
            self.gazebo.spawn("one", where=pose(1.0))
            self.assertEqual(program.ended(), 0, program.text)
        self.assertEqual(self.gazebo.names(), ["ground_plane", "one", "two"])

    def test_a_wait_has_a_deadline_that_it_names(self):
        text = self.run_it("-urdf", "-param", "a_box", "-model", "two", "-wait", "never",
                           "-timeout", "4", status=1)  # enough to find the service
        self.assertIn("'never'", text)
        self.assertIn("4 s", text)

    def test_a_bond_deletes_the_model_at_the_end(self):
        words = ["-urdf", "-param", "a_box", "-model", "one", "-b"]
        with Program([self.program, *words]) as program:
            wait_for(lambda: "one" in self.gazebo.names(), "the spawn")
            wait_for(lambda: "Successfully" in program.text, "the answer")
            program.interrupt()
            self.assertEqual(program.ended(), 0, program.text)
        self.assertNotIn("one", self.gazebo.names())

    def test_faults_are_status_1_with_their_reason(self):
        for words, reason in (
                (("-urdf", "-param", "none", "-model", "one"), "/none"),
                (("-urdf", "-file", "/no/such/file", "-model", "one"), "/no/such/file"),
                (("-urdf", "-param", "a_box", "-model", "ground_plane"), "already exists"),
                (("-urdf", "-param", "a_box", "-model", "one", "-reference_frame", "nowhere"),
                 "nowhere"),
                (("-sdf", "-database", "no_such_model", "-model", "one"), "no_such_model"),
                (("-urdf", "-param", "a_box", "-model", "one", "-gazebo_namespace", "/none",
                  "-timeout", "0.5"), "/none/spawn_urdf_model")):
            self.assertIn(reason, self.run_it(*words, status=1))
        self.assertEqual(self.gazebo.names(), ["ground_plane"])

    def test_a_wrong_command_line_is_status_2(self):
        self.assertIn("usage", self.run_it("-urdf", "-model", "one", status=2))

    def test_without_a_master_it_gives_up_and_says_so(self):
        uri = silent_uri()
        words = ["-urdf", "-param", "a_box", "-model", "one"]
        with Program([self.program, *words], ROS_MASTER_URI=uri) as program:
            self.assertEqual(program.ended(), 1)
            self.assertIn(uri, program.text)

    def test_the_python_functions_spawn(self):
        self.assertTrue(gazebo_interface.spawn_urdf_model_client(
            "one", box(), "/", pose(2.0, 0.0, 0.1), "", "/gazebo"))
        self.assertTrue(gazebo_interface.spawn_sdf_model_client(
            "two", support.static_box_sdf(), "/", pose(4.0), "world", "/gazebo"))
        self.assertFalse(gazebo_interface.spawn_urdf_model_client(
            "one", box(), "/", pose(), "", "/gazebo"))
        self.assertEqual(self.gazebo.names(), ["ground_plane", "one", "two"])


if __name__ == "__main__":
    support.run("spawn_model_program")
