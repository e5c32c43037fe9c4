"""The object flow: spawn, replace and remove objects of the list in a running world."""
import unittest

import object_flow_support as flow
import rospy
import support
from gazebo_msgs.msg import ModelStates
from object_flow_support import entry

PRINTED = "my_simulations/test/data/tutorial/my_object_as_printed.urdf"
ALL = ["MY_OBJECT", "table", "table_carton", "table_ball", "shelf", "crate_1", "crate_2", "barrel"]


class ObjectFlow(flow.RobotWorldCase, unittest.TestCase):
    def test_an_object_of_the_list_stands_at_its_place_and_is_removed_again(self):
        text = self.run_tool("spawn_object.py", "MY_OBJECT")
        self.assertIn("MY_OBJECT spawned at 1 0 0", text)
        self.assert_at("MY_OBJECT", 1.0, 0.0, 0.0)
        start = self.gazebo.sim_time()
        support.wait_for(lambda: self.gazebo.sim_time() > start + 1.0, "a second of the world")
        self.assert_at("MY_OBJECT", 1.0, 0.0, 0.0)
        self.assertGreater(self.gazebo.get_model_state("MY_OBJECT", "").pose.orientation.w, 0.999)
        self.assertIn("MY_OBJECT removed", self.run_tool("remove_object.py", "MY_OBJECT"))
        self.assertNotIn("MY_OBJECT", self.gazebo.names())

    def test_all_spawns_and_removes_every_object_and_nothing_else(self):
        self.run_tool("spawn_object.py", "all")
        self.assertEqual(self.gazebo.names(), ["ground_plane", "robo", *ALL])
        self.assert_at("table_carton", 2.4, 1.4, 0.75)
        self.run_tool("remove_object.py", "all")
        self.assertEqual(self.gazebo.names(), ["ground_plane", "robo"])

    def test_groups_and_names_are_spawned_together_and_each_once(self):
        self.run_tool("spawn_object.py", "crates", "barrel", "crate_1")
        self.assertEqual(self.gazebo.names()[2:], ["crate_1", "crate_2", "barrel"])
        self.run_tool("remove_object.py", "crates")
        self.assertEqual(self.gazebo.names()[2:], ["barrel"])

    def test_both_list_formats_are_spawned_with_children_on_their_parent(self):
        rospy.set_param("/objects", {
            "old": {"model": "ball", "model_type": "urdf", "position": [1, 2, 0],
                    "orientation": [0, 0, 0]},
            "new": entry("my_simulations/objects/lab_table.urdf", (2, -2, 0),
                         (0, 0, 1.5707963267948966),
                         children={"tin": entry(position=(0.5, 0.1, 0.75))})})
        self.run_tool("spawn_object.py", "old", "new", "new_tin")
        self.assert_at("old", 1.0, 2.0, 0.0)
        self.assert_at("new", 2.0, -2.0, 0.0)
        self.assert_at("new_tin", 1.9, -1.5, 0.75)

    def test_group_members_may_name_the_child_before_the_parent(self):
        tin = entry(position=(0, 0, 0.63))
        rospy.set_param("/objects", {
            "shelf": entry("my_simulations/objects/shelf.urdf", (3, 0, 0), children={"tin": tin})})
        rospy.set_param("/object_groups", {"tins": ["tin_shelf"]})
        self.run_tool("spawn_object.py", "tins")
        self.assertIn("shelf_tin", self.gazebo.names())

    def test_an_object_already_there_is_replaced_and_its_name_never_goes(self):
        self.run_tool("spawn_object.py", "crate_1")
        states = support.Collected("/gazebo/model_states", ModelStates)
        self.gazebo.place("crate_1", support.pose(x=5.0, z=0.5))
        support.wait_for(states.all, "the states")
        text = self.run_tool("spawn_object.py", "crate_1")
        self.assertIn("crate_1 replaced", text)
        self.assert_at("crate_1", -1.0, 1.0, 0.0)
        count = len(states.all())
        support.wait_for(lambda: len(states.all()) > count, "the states after the replacement")
        states.close()
        self.assertTrue(all(message.name.count("crate_1") == 1 for message in states.all()))
        self.assertEqual(self.gazebo.names().count("crate_1"), 1)

    def test_the_tutorials_template_is_spawned_as_printed(self):
        rospy.set_param("/objects", {"printed": entry(PRINTED, (1, 1, 0.5))})
        heard = support.heard_on_rosout("<mesh> is never closed")
        self.run_tool("spawn_object.py", "printed")
        self.assertIn("printed", self.gazebo.names())
        self.assertIn(":18:", heard()[0].msg)

    def test_remappings_of_ros_are_no_object_names(self):
        self.run_tool("spawn_object.py", "__name:=spawner", "MY_OBJECT", "_some:=1")
        self.assertIn("MY_OBJECT", self.gazebo.names())

    def test_any_model_of_the_world_is_removed_by_its_name(self):
        self.assertTrue(self.gazebo.spawn("stranger", where=support.pose(x=4.0, z=0.1)).success)
        self.run_tool("remove_object.py", "stranger")
        self.assertNotIn("stranger", self.gazebo.names())

    def test_removing_all_twice_is_no_failure(self):
        self.run_tool("remove_object.py", "all")
        self.assertIn("none of these objects", self.run_tool("remove_object.py", "all"))
