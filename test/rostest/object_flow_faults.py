"""What the object tools answer to faulty lists, names and files, and without a simulator."""
import unittest

import object_flow_support as flow
import rospy
from object_flow_support import entry

FILES = "my_simulations/test/data/invalid/objects_files"
NOBODY = "http://127.0.0.1:1"


class Faults(flow.RobotWorldCase, unittest.TestCase):
    def refused(self, objects, *parts):
        """Spawning `bad` fails with every text of `parts`; what else is asked for is spawned."""
        rospy.set_param("/objects", {**objects, "good": entry()})
        text = self.run_tool("spawn_object.py", "bad", "good", status=1)
        for part in parts:
            self.assertIn(part, text)
        self.assertEqual(self.gazebo.names(), ["ground_plane", "robo", "good"])

    def test_a_missing_key_is_named_with_its_parameter(self):
        self.refused({"bad": {"model": "p/o.urdf", "position": [0, 0, 0]}},
                     "'bad' has no orientation", "/objects/bad/orientation")

    def test_a_missing_file_is_named(self):
        self.refused({"bad": entry("my_simulations/objects/nothing.urdf")}, "objects/nothing.urdf")

    def test_what_xacro_says_is_shown(self):
        self.refused({"bad": entry(f"{FILES}/unknown_macro.urdf.xacro")}, "xacro",
                     "no_such_property")

    def test_a_document_the_simulator_refuses_is_named(self):
        self.refused({"bad": entry(f"{FILES}/not_a_robot.urdf")}, "cannot spawn bad",
                     "<house>")

    def test_an_unknown_name_comes_with_the_closest_known_ones(self):
        text = self.run_tool("spawn_object.py", "MY_OBJEKT", "barrel", status=1)
        self.assertIn("no object 'MY_OBJEKT'", text)
        self.assertIn("did you mean MY_OBJECT?", text)
        self.assertIn("barrel", self.gazebo.names())
        text = self.run_tool("remove_object.py", "barel", status=1)
        self.assertIn("did you mean barrel?", text)
        self.assertIn("barrel", self.gazebo.names())

    def test_an_unknown_member_of_a_group_fails_and_the_others_are_spawned(self):
        rospy.set_param("/object_groups", {"mine": ["barrel", "ghost"]})
        text = self.run_tool("spawn_object.py", "mine", status=1)
        self.assertIn("'ghost'", text)
        self.assertIn("barrel", self.gazebo.names())

    def test_a_replacement_that_is_refused_leaves_the_object_in_place(self):
        rospy.set_param("/objects", {"bad": entry(position=(2, 0, 0))})
        self.run_tool("spawn_object.py", "bad")
        rospy.set_param("/objects", {"bad": entry(f"{FILES}/not_a_robot.urdf")})
        self.run_tool("spawn_object.py", "bad", status=1)
        self.assert_at("bad", 2.0, 0.0, 0.0)

    def test_a_world_without_a_list_is_one_warning(self):
        text = self.run_tool("upload_objects.py", "--world", "no_such_world")
        self.assertEqual(text.count("warning"), 1, text)
        self.assertEqual(len(text.strip().splitlines()), 1, text)
        self.assertIsNone(rospy.get_param("/objects", None))
        text = self.run_tool("spawn_object.py", "MY_OBJECT", status=1)
        self.assertIn("world 'no_such_world' has no object list", text)

    def test_a_list_of_another_world_is_dropped_by_the_upload(self):
        rospy.set_param("/objects", {"stale": entry()})
        rospy.set_param("/object_groups", {"stale": ["stale"]})
        self.run_tool("upload_objects.py", "--world", "shapes")
        self.assertNotIn("stale", rospy.get_param("/objects"))
        self.assertNotIn("stale", rospy.get_param("/object_groups"))

    def test_wrong_usage_is_exit_status_2(self):
        for words in (["spawn_object.py"], ["remove_object.py"], ["spawn_object.py", "--no"],
                      ["spawn_object.py", "--timeout", "-1", "a"], ["move_object.py", "-n", "a"]):
            self.assertIn("usage:", self.run_tool(*words, status=2))

    def test_help_is_exit_status_0(self):
        for name in ("spawn_object.py", "remove_object.py", "move_object.py", "upload_objects.py"):
            self.assertIn("Exit code:", self.run_tool(name, "--help"))

    def test_without_a_roscore_every_tool_says_so(self):
        for words in (["spawn_object.py", "a"], ["remove_object.py", "a"], ["upload_objects.py"],
                      ["move_object.py", "-m", "polygon", "-p", "[[0,0],[1,0]]", "-n", "a"]):
            text = self.run_tool(*words, status=1, ROS_MASTER_URI=NOBODY)
            self.assertIn("roscore", text)
            self.assertIn(NOBODY, text)

    def test_without_a_simulator_the_message_names_the_deadline(self):
        for words in (["spawn_object.py", "a"], ["remove_object.py", "a"], ["upload_objects.py"]):
            text = self.run_tool(*words, "--gazebo-namespace", "/nobody", "--timeout", "2",
                                 status=1)
            self.assertIn("/nobody", text)
            self.assertIn("timed out after 2 s", text)
