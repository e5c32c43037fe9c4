#!/usr/bin/env python3
"""A student's own worlds: found where the command is typed, saved beside, launched again."""
import os
import sys
import tempfile
import unittest
from xml.etree import ElementTree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import support
from gazebo_msgs.srv import DeleteModel, GetModelState, GetWorldProperties, SpawnModel
from my_simulations_msgs.srv import SaveWorld
from support import Launched, Program, executable, wait_for

STUDENTS = ('<sdf version="1.5"><world name="default">'
            '<include><uri>model://ground_plane</uri></include>'
            '<include><uri>model://crate</uri><name>students</name></include></world></sdf>')
SPAWNERS = """<launch>
  <param name="robot_description" textfile="{robot}"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="gui" value="false"/><arg name="extensions" value="true"/>
    <arg name="paused" value="true"/>
    <arg name="world_name" value="{world}"/>
  </include>
  <node name="spawner" pkg="gazebo_ros" type="spawn_model" output="screen"
        args="-urdf -param robot_description -model my_robot -z 0.1"/>
</launch>
"""


class OwnWorlds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.home = os.path.join(os.path.realpath(folder.name), "home")
        self.typed = os.path.join(self.home, "a course", "world")
        os.makedirs(self.typed)
        self.worlds = os.path.join(self.home, "my_simulations", "worlds")

    def write(self, name, text=STUDENTS):
        path = os.path.join(self.typed, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def my_world(self, *words):
        return Launched(self.typed, self.home, "my_simulations", "my_world.launch", "gui:=false",
                        "pause:=true", *words)

    def test_a_world_beside_the_command_comes_before_one_that_ships_and_the_log_says_which(self):
        path = self.write("lab_room.world")
        with self.my_world("world:=lab_room.world") as launched:
            launched.says(f"the world file is {path}")
            self.assertIn("students", launched.names())

    def test_gzserver_finds_it_there_too(self):
        path = self.write("lab_room.world")
        with Program([executable("gazebo_ros", "gzserver"), "lab_room.world", "__name:=typed"],
                     folder=self.typed) as program:
            wait_for(lambda: f"the world file is {path}" in program.text, "the words about it")
            rospy.wait_for_service("/typed/save_world", support.SECONDS)
        rospy.delete_param("/typed")

    def test_gazebo_without_a_master_finds_it_there_too(self):
        path = self.write("lab_room.world")
        with Program([executable("gazebo_ros", "gazebo"), "lab_room.world"], folder=self.typed,
                     HOME=self.home, ROS_MASTER_URI="http://127.0.0.1:1",
                     MY_SIMULATIONS_NO_BROWSER="1") as program:
            wait_for(lambda: f"the world file is {path}" in program.text, "the words about it")

    def test_the_world_that_ships_is_said_as_well(self):
        with self.my_world() as launched:
            launched.says("the world file is ")
            launched.says(os.path.join("world", "empty_world.world"))

    def test_a_misspelt_world_is_answered_with_the_one_that_was_meant(self):
        self.write("my_wrold_2.world")
        with self.my_world("world:=my_world_2.world") as launched:
            launched.says("did you mean my_wrold_2.world?")

    def test_the_lab_sheets_round_trip(self):
        with self.my_world("x:=1.0") as launched:
            launched.says("robot_description: Successfully spawned")
            self.assertIn("robo", launched.names())
            launched.ask("spawn_sdf_model", SpawnModel, model_name="mine",
                         model_xml=support.static_box_sdf())
            refused = launched.ask("save_world", SaveWorld, overwrite=True, path=os.path.join(
                support_folder(), "world", "lab_course.world"))
            self.assertIn("ships with my_simulations", refused.status_message)
            saved = launched.ask("save_world", SaveWorld, path="test.world", inline=True)
            self.assertTrue(saved.success, saved.status_message)
            self.assertEqual(saved.path, os.path.join(self.worlds, "test.world"))
            self.assertIn("without models spawned by the launch file: robo", saved.status_message)
        with self.my_world("world:=test.world") as launched:
            launched.says(f"the world file is {saved.path}")
            launched.says("robot_description: Successfully spawned")
            self.assertEqual(sorted(launched.names()), ["ground_plane", "mine", "robo"])
            self.assertEqual(
                launched.ask("get_world_properties", GetWorldProperties).sim_time, 0.0)

    def test_a_world_that_holds_the_very_robot_keeps_it_where_it_is(self):
        with self.my_world("x:=1.0") as launched:
            launched.says("robot_description: Successfully spawned")
            saved = launched.ask("save_world", SaveWorld, inline=True, launched=True,
                                 path=os.path.join(self.typed, "test.world"))
            self.assertTrue(saved.success, saved.status_message)
        with self.my_world("world:=test.world") as launched:
            launched.says("already contains an identical model 'robo'")
            state = launched.ask("get_model_state", GetModelState, model_name="robo")
            self.assertAlmostEqual(state.pose.position.x, 1.0, 3)
            # It belongs to the world now, which is saved beside itself.
            again = launched.ask("save_world", SaveWorld, path="again.world", inline=True)
            self.assertEqual(again.path, os.path.join(self.typed, "again.world"))
            world = ElementTree.parse(again.path).getroot().find("world")
            self.assertIn("robo", [model.get("name") for model in world.findall("model")])
        with open(saved.path, encoding="utf-8") as file:
            other = file.read().replace("<mass>", "<mass>1", 1)
        self.write("test.world", other)
        with self.my_world("world:=test.world") as launched:
            launched.says("cannot spawn robot_description")
            launched.says("that differs in")

    def spawners(self, world):
        return self.write("spawners.launch", SPAWNERS.format(
            robot=os.path.join(support_folder(), "objects", "ball.urdf"), world=world))

    def test_what_a_launch_files_spawn_model_spawns_is_left_out_and_by_hand_is_not(self):
        path = self.write("mine.world")
        with Launched(self.typed, self.home, self.spawners(path)) as launched:
            launched.says("spawn_model: SpawnModel: Successfully spawned")
            with Program([executable("gazebo_ros", "spawn_model"), "-urdf", "-model",
                          "by_hand", "-param", "robot_description", "-x", "2"],
                         ROS_MASTER_URI=launched.uri) as program:
                self.assertEqual(program.ended(), 0, program.text)
            launched.ask("delete_model", DeleteModel, model_name="students")
            saved = launched.ask("save_world", SaveWorld, path="out.world", inline=True)
        self.assertEqual(saved.path, os.path.join(self.typed, "out.world"))
        world = ElementTree.parse(saved.path).getroot().find("world")
        self.assertEqual([model.get("name") for model in world.findall("model")],
                         ["ground_plane", "by_hand"])


def support_folder():
    import rospkg

    return rospkg.RosPack().get_path(support.PACKAGE)


if __name__ == "__main__":
    support.run("own_worlds")
