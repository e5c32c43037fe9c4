#!/usr/bin/env python3
"""The commands of Care-O-bot's tutorial as they are printed, without Care-O-bot's packages."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import support
from gazebo_msgs import srv
from object_flow_support import package_file
from support import Launched, Program

OBJECT = "test/data/tutorial/my_object_as_printed.urdf"


class CobCommands(unittest.TestCase):
    def launched(self, *words):
        home = tempfile.mkdtemp()
        return Launched(home, home, "cob_gazebo_worlds", *words, "gui:=false")

    def run_beside(self, launched, *words):
        """A command in another terminal; returns its output."""
        with Program(words, ROS_MASTER_URI=launched.uri) as program:
            self.assertEqual(program.ended(), 0, program.text)
        return program.text

    def test_the_three_commands_spawn_an_object_of_the_list(self):
        with self.launched("ipa-apartment.launch") as launched:
            self.assertIn("room", launched.names())
            text = self.run_beside(launched, "roslaunch", "cob_gazebo_objects",
                                   "upload_param.launch")
            self.assertIn("world 'ipa-apartment': ", text)
            self.assertIn(os.path.join("cob_gazebo_objects", "config", "ipa-apartment"), text)
            text = self.run_beside(launched, "rosrun", "cob_bringup_sim", "spawn_object.py",
                                   "MY_OBJECT")
            self.assertIn("MY_OBJECT spawned at ", text)
            self.assertIn("MY_OBJECT", launched.names())
            self.run_beside(launched, "rosrun", "cob_bringup_sim", "remove_object.py", "MY_OBJECT")
            self.assertNotIn("MY_OBJECT", launched.names())

    def test_the_meshes_of_the_package_are_found(self):
        """In the environment without objects, which the current launch file names by robot_env."""
        with open(package_file(OBJECT), encoding="utf-8") as stream:
            text = stream.read().replace("package://my_simulations/", "package://cob_gazebo_objects/")
        with self.launched("world.launch", "robot_env:=empty") as launched:
            self.assertEqual(launched.names(), ["ground_plane"])
            reply = launched.ask("spawn_urdf_model", srv.SpawnModel, model_name="thing",
                                 model_xml=text)
            self.assertTrue(reply.success, reply.status_message)
            self.assertNotIn("not found", reply.status_message)

    def test_our_own_programs_and_launch_files_keep_their_names(self):
        """roslaunch and rosrun look through the whole clone, with the packages in compat."""
        for package in (support.PACKAGE, "cob_bringup_sim"):
            with Program(["rosrun", package, "spawn_object.py", "--help"]) as program:
                self.assertEqual(program.ended(), 0, program.text)
        for words in ((support.PACKAGE, "upload_param.launch"), (support.PACKAGE, "world.launch"),
                      (support.PACKAGE, "lab_room.launch"),
                      ("cob_gazebo_objects", "upload_param.launch"),
                      ("cob_gazebo_worlds", "lab_room.launch")):
            with Program(["roslaunch", "--files", *words]) as program:
                self.assertEqual(program.ended(), 0, program.text)


if __name__ == "__main__":
    support.run("cob_commands")
