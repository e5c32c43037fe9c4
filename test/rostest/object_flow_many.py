"""The object tools with many objects, and the launch file that spawns one without a list."""
import signal
import unittest

import object_flow_support as flow
import rospy
import support
from gazebo_msgs.msg import ModelStates
from object_flow_support import entry

COUNT = 40
NAMES = [f"thing_{n}" for n in range(COUNT)]


def listed(model="my_simulations/objects/ball.urdf", z=0.0):
    return {name: entry(model, (n % 8 + 2.0, n // 8 - 2.0, z)) for n, name in enumerate(NAMES)}


class ManyObjects(flow.ToolCase, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()

    def setUp(self):
        self.gazebo.unpause_physics()
        self.gazebo.clear()
        rospy.set_param("/objects", listed())

    def test_many_objects_appear_at_one_moment_and_go_again(self):
        rospy.set_param("/objects", listed(z=10000.0))
        text = self.run_tool("spawn_object.py", "all")
        self.assertEqual(self.gazebo.names(), ["ground_plane", *NAMES])
        self.assertEqual(text.count("spawned at"), COUNT)
        self.assertFalse(self.gazebo.is_paused())
        states = support.Collected("/gazebo/model_states", ModelStates)
        found = support.wait_for(
            lambda: [one for one in states.all() if one.twist[-1].linear.z < -0.1], "a fall")[0]
        states.close()
        self.assertEqual(found.name[1:], NAMES)
        # What fell for longer would be faster.
        speeds = [twist.linear.z for twist in found.twist[1:]]
        self.assertLess(max(speeds) - min(speeds), 1e-9, "time went on between the objects")
        self.run_tool("remove_object.py", "all")
        self.assertEqual(self.gazebo.names(), ["ground_plane"])
        self.assertFalse(self.gazebo.is_paused())

    def test_a_paused_world_stays_paused(self):
        self.gazebo.pause_physics()
        self.run_tool("spawn_object.py", "all")
        self.assertTrue(self.gazebo.is_paused())
        self.run_tool("remove_object.py", "all")
        self.assertTrue(self.gazebo.is_paused())

    def test_a_tool_that_is_told_to_end_lets_the_world_go_on(self):
        for request in (signal.SIGINT, signal.SIGTERM):
            self.gazebo.clear()
            with flow.tool("spawn_object.py", "all") as program:
                support.wait_for(lambda: "thing_0" in self.gazebo.names(), "the first object")
                program.process.send_signal(request)
                program.ended()
            start = self.gazebo.sim_time()
            support.wait_for(lambda at=start: self.gazebo.sim_time() > at, "time to go on")

    def test_every_object_of_one_xacro_file_is_spawned(self):
        rospy.set_param("/objects", listed("my_simulations/objects/crate.urdf.xacro"))
        text = self.run_tool("spawn_object.py", "all")
        self.assertEqual(text.count("spawned at"), COUNT)

    def test_a_launch_file_spawns_one_object_of_no_list(self):
        words = ["roslaunch", "my_simulations", "spawn_object_urdf.launch", "object:=ball",
                 "object_origin:=-x 1.5 -y -2 -z 0.3"]
        with support.Program(words) as program:
            self.assertEqual(program.ended(), 0, program.text)
        self.assertIn("ball", self.gazebo.names())
        at = self.gazebo.get_model_state("ball", "").pose.position
        self.assertAlmostEqual(at.x, 1.5, 2)
        self.assertAlmostEqual(at.y, -2.0, 2)
