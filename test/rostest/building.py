"""A saved building is an object like others: it is spawned from a list."""
import os
import tempfile
import unittest

import object_flow_support as flow
import rospy
import support
from object_flow_support import entry

from my_simulations.building.building_operations import building_save
from my_simulations.building.building_plan import Level, Opening, Plan, Wall
from my_simulations.building.plan_json import plan_to_json

PACKAGE = "<package format='2'><name>my_house</name><version>0.0.1</version>" \
          "<description>d</description><maintainer email='a@b.c'>a</maintainer>" \
          "<license>none</license></package>"


def hut():
    """Two walls in a corner, a door in one."""
    return Plan("hut", [Level("Level 1", walls=[
        Wall(0, (0.0, 0.0), (4.0, 0.0)), Wall(1, (4.0, 0.0), (4.0, 3.0))],
        doors=[Opening(0, 0.9, 2.0, wall=0, along=2.0)])])


class Building(flow.ToolCase, unittest.TestCase):
    def setUp(self):
        self.gazebo = support.Gazebo()
        flow.wait_for_list()
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        package = os.path.join(self.folder.name, "my_house")
        os.makedirs(package)
        with open(os.path.join(package, "package.xml"), "w", encoding="utf-8") as stream:
            stream.write(PACKAGE)
        saved = building_save(plan_to_json(hut()), "My hut",
                              {"folder": os.path.join(package, "objects")}, [self.folder.name])
        self.assertEqual(saved["name"], "My_hut")

    def test_a_building_in_a_package_is_spawned_by_the_object_tools(self):
        rospy.set_param("/objects", {
            "house": entry("my_house/objects/My_hut/model.sdf", (10, 5, 0))})
        found = os.environ.get("ROS_PACKAGE_PATH", "")
        text = self.run_tool("spawn_object.py", "house",
                             ROS_PACKAGE_PATH=f"{found}{os.pathsep}{self.folder.name}")
        self.assertIn("house spawned", text)
        # The place is that of the plan's origin; the model's own pose is the plan's middle.
        self.assert_at("house", 12.0, 6.5, 0.0)
        bodies = self.gazebo.get_model_properties("house").body_names
        self.assertEqual(sorted(bodies), ["Wall_0", "Wall_1"])
        self.assertTrue(self.gazebo.get_model_properties("house").is_static)
