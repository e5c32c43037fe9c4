"""Object lists of another package, as the tutorial's cob_gazebo_objects is one."""
import os
import tempfile
import unittest

import object_flow_support as flow
import support

PACKAGE = "my_gazebo_objects"
LIST = """
MY_OBJECT: {model: MY_OBJECT, model_type: urdf, position: [1, 0, 0], orientation: [0, 0, 0]}
ball: {model: ball, model_type: urdf, position: [2, 0, 0], orientation: [0, 0, 0]}
typo: {model: typo, model_type: urdf, position: [3, 0, 0], orientation: [0, 0, 0]}
"""


class OtherPackage(flow.ToolCase, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()

    def setUp(self):
        self.gazebo.clear()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.package = os.path.join(folder.name, PACKAGE)
        self.write("package.xml", f"<package format='2'><name>{PACKAGE}</name></package>")
        self.write("config/theirs/object_locations.yaml", LIST)
        self.theirs = self.write("objects/MY_OBJECT.urdf", support.box(link="theirs"))
        self.write("objects/typo.urdf", support.box(extra="\n<jiont name='j'/>"))
        self.path = f"{folder.name}:{os.environ['ROS_PACKAGE_PATH']}"

    def write(self, name, text):
        path = os.path.join(self.package, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def run_here(self, *words, status=0):
        return self.run_tool(*words, status=status, ROS_PACKAGE_PATH=self.path)

    def upload(self):
        self.run_here("upload_objects.py", "--world", "theirs", "--package", PACKAGE)

    def test_the_list_remembers_its_package_and_both_files_of_the_name_are_said(self):
        self.upload()
        text = self.run_here("spawn_object.py", "MY_OBJECT")
        self.assertIn(f"MY_OBJECT spawned at 1 0 0 from {self.theirs}", text)
        self.assertIn(f"(not {flow.package_file('objects/MY_OBJECT.urdf')})", text)
        self.assertTrue(self.gazebo.get_link_state("MY_OBJECT::theirs", "").success)

    def test_what_that_package_lacks_is_taken_from_this_one(self):
        self.upload()
        text = self.run_here("spawn_object.py", "ball")
        self.assertIn(f"from {flow.package_file('objects/ball.urdf')}\n", text)

    def test_a_package_that_is_given_counts_more(self):
        self.upload()
        text = self.run_here("spawn_object.py", "MY_OBJECT", "--package", "my_simulations")
        self.assertIn(f"from {flow.package_file('objects/MY_OBJECT.urdf')}\n", text)

    def test_a_world_without_a_list_is_answered_with_how_to_name_the_package(self):
        text = self.run_here("upload_objects.py", "--world", "theirs")
        self.assertIn("package:=PACKAGE", text)
        self.assertIn("--package PACKAGE", text)
        text = self.run_here("spawn_object.py", "MY_OBJECT", status=1)
        self.assertIn("has no object list in package 'my_simulations'", text)
        self.assertIn("package:=PACKAGE", text)

    def test_messages_about_a_spawned_file_name_model_file_and_line(self):
        self.upload()
        heard = support.heard_on_rosout(
            f"model 'typo', {os.path.join(self.package, 'objects/typo.urdf')}:2")
        self.run_here("spawn_object.py", "typo")
        self.assertIn("<jiont>", heard()[0].msg)
