"""Object lists of another package, as the tutorial's cob_gazebo_objects is one."""
import os
import tempfile
import unittest

import object_flow_support as flow
import rospy
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

    def test_a_world_outside_of_all_packages_needs_no_list(self):
        with tempfile.TemporaryDirectory() as folder:
            text = self.run_here("upload_objects.py", "--world", f"{folder}/a_house.world")
        self.assertEqual(text.strip(), "upload_objects.py: world 'a_house' has no object list")

    def edit_list(self, old, new):
        """Change the list, and wait until its time shows it."""
        path = os.path.join(self.package, "config/theirs/object_locations.yaml")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        self.assertIn(old, text)
        self.write("config/theirs/object_locations.yaml", text.replace(old, new))
        return path

    def test_a_package_that_does_not_exist_is_an_error(self):
        self.upload()
        text = self.run_here("spawn_object.py", "--package", "my_gazebo_objekts", "ball", status=1)
        self.assertIn("'my_gazebo_objekts' was not found (did you mean my_gazebo_objects?)", text)
        self.assertEqual(self.gazebo.names(), ["ground_plane"])

    def test_a_list_that_has_changed_is_loaded_again(self):
        self.upload()
        self.run_here("spawn_object.py", "ball")
        path = self.edit_list("position: [2, 0, 0]", "position: [-2.5, 0, 0]")
        text = self.run_here("spawn_object.py", "ball")
        self.assertIn(f"{path} has changed and was loaded again", text)
        self.assertIn("ball replaced at -2.5 0 0", text)
        self.assertNotIn("has changed", self.run_here("spawn_object.py", "ball"))

    def test_a_list_that_did_not_exist_is_loaded_once_it_does(self):
        self.run_here("upload_objects.py", "--world", "new", "--package", PACKAGE)
        text = self.run_here("spawn_object.py", "ball", status=1)
        self.assertIn("upload_param.launch", text)
        self.write("config/new/object_locations.yaml", LIST)
        self.run_here("spawn_object.py", "ball")
        self.assert_at("ball", 2.0, 0.0, 0.0, delta=0.5)

    def test_objects_that_others_have_set_are_not_replaced_by_a_changed_file(self):
        self.upload()
        rospy.set_param("/objects", {"ball": flow.entry("my_simulations/objects/ball.urdf")})
        self.edit_list("position: [2, 0, 0]", "position: [-2.50, 0, 0]")
        self.assertIn("ball spawned at 0 0 0", self.run_here("spawn_object.py", "ball"))

    def test_a_mistake_in_a_changed_list_is_one_line_until_it_is_corrected(self):
        self.upload()
        path = self.edit_list("position: [2, 0, 0]", "position: [2, 0, 0")
        for _ in range(2):
            text = self.run_here("spawn_object.py", "ball", status=1).strip()
            self.assertIn(f"{path}:3:", text)
            self.assertEqual(len(text.splitlines()), 1, text)
        self.edit_list("position: [2, 0, 0", "position: [2, 0, 0]")
        self.run_here("spawn_object.py", "ball")

    def test_wrong_indentation_is_one_error_with_its_line(self):
        path = self.write("config/theirs/object_locations.yaml",
                          "ball:\nmodel: ball\nmodel_type: urdf\nposition: [2, 0, 0]\n"
                          "orientation: [0, 0, 0]\n")
        place = f"{path}:2: error: 'model' is not indented"
        text = self.run_here("upload_objects.py", "--world", "theirs", "--package", PACKAGE,
                             status=1)
        self.assertEqual(text.count("error"), 1, text)
        self.assertIn(place, text)
        text = self.run_here("spawn_object.py", "ball", status=1).strip()
        self.assertIn(place, text)
        self.assertEqual(len(text.splitlines()), 1, text)

    def test_without_a_package_the_list_of_the_worlds_package_is_loaded(self):
        self.write("config/empty_world/object_locations.yaml", LIST)
        world = self.write("world/empty_world.world", "<sdf/>")
        text = self.run_here("upload_objects.py", "--world", world)
        self.assertIn(os.path.join(self.package, "config/empty_world"), text)
        other = self.write("world/mud.world", "<sdf/>")  # its package has no list for it
        text = self.run_here("upload_objects.py", "--world", other)
        self.assertIn(flow.package_file("config/mud"), text)

    def test_without_a_world_the_running_worlds_package_is_used(self):
        running = rospy.get_param("/gazebo/my_simulations/world_file")
        self.addCleanup(rospy.set_param, "/gazebo/my_simulations/world_file", running)
        self.assertTrue(os.path.samefile(running, flow.package_file("world/worlds/empty.world")))
        self.assertIn(flow.package_file("config/empty"), self.run_here("upload_objects.py"))
        world = self.write("world/empty.world", "<sdf/>")
        self.write("config/empty/object_locations.yaml", LIST)
        rospy.set_param("/gazebo/my_simulations/world_file", world)
        text = self.run_here("upload_objects.py")
        self.assertIn(os.path.join(self.package, "config/empty"), text)

    def test_warnings_of_a_spawn_are_printed(self):
        self.upload()
        text = self.run_here("spawn_object.py", "typo")
        self.assertIn(f" (1 warning: model 'typo', {self.package}/objects/typo.urdf:2: element"
                      " <jiont>", text)

    def test_messages_about_a_spawned_file_name_model_file_and_line(self):
        self.upload()
        heard = support.heard_on_rosout(
            f"model 'typo', {os.path.join(self.package, 'objects/typo.urdf')}:2")
        self.run_here("spawn_object.py", "typo")
        self.assertIn("<jiont>", heard()[0].msg)
