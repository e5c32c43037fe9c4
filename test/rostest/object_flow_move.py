"""Moving objects: to a pose, along a polygon and a circle, and past things in the way."""
import math
import unittest

import object_flow_support as flow
import support
from gazebo_msgs.msg import ModelStates


class Moving(flow.ToolCase, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        support.wait_for(lambda: "robo" in cls.gazebo.names(), "the robot")

    def setUp(self):
        self.gazebo.unpause_physics()
        self.gazebo.clear()
        self.gazebo.spawn_sdf_model("block", support.static_box_sdf(), "", support.pose(z=0.5), "")

    def path(self, states):
        """Every place of `block` in what was collected."""
        found = []
        for message in states.all():
            if "block" in message.name:
                at = message.pose[message.name.index("block")].position
                found.append((at.x, at.y))
        return found

    def test_a_static_model_is_put_at_its_pose_and_the_tool_ends(self):
        self.run_tool("move_object.py", "-m", "initialpose", "-n", "block",
                      "-i", "[2, -3, 0.7, 0, 0, 1.5707963267948966]")
        self.assert_at("block", 2.0, -3.0, 0.7, delta=1e-6)
        turned = self.gazebo.get_model_state("block", "").pose.orientation
        self.assertAlmostEqual(turned.z, math.sqrt(0.5), places=6)

    def test_a_model_is_put_at_its_pose_while_the_world_is_paused(self):
        self.gazebo.pause_physics()
        self.run_tool("move_object.py", "-m", "initialpose", "-n", "block", "-i", "[1,1,1,0,0,0]")
        self.assert_at("block", 1.0, 1.0, 1.0, delta=1e-6)

    def test_a_polygon_is_gone_round_and_ends_where_it_began(self):
        corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]
        states = support.Collected("/gazebo/model_states", ModelStates)
        self.run_tool("move_object.py", "-m", "polygon", "-n", "block", "-v", "2",
                      "-p", str(corners), "--laps", "1")
        self.assert_at("block", 0.0, 0.0, 0.0, delta=1e-6)
        states.close()
        edges = list(zip(corners, [*corners[1:], corners[0]]))
        places = [place for place in self.path(states) if place not in corners]
        on_edge = [[i for i, (a, b) in enumerate(edges)
                    if math.dist(a, p) + math.dist(p, b) < math.dist(a, b) + 1e-6]
                   for p in places]
        self.assertTrue(all(on_edge), "a place off the edges")
        self.assertEqual({i for found in on_edge for i in found}, {0, 1, 2})

    def test_a_circle_keeps_its_distance_from_the_centre(self):
        states = support.Collected("/gazebo/model_states", ModelStates)
        self.run_tool("move_object.py", "-m", "circle", "-n", "block", "-v", "5", "-r", "1",
                      "-c", "[4, 4]", "-z", "0.5", "--laps", "1")
        self.assert_at("block", 4.0, 5.0, 0.5, delta=1e-6)
        states.close()
        moved = [place for place in self.path(states) if place != (0.0, 0.0)]
        self.assertGreater(len(moved), 20)
        self.assertTrue(all(abs(math.dist(p, (4, 4)) - 1.0) < 1e-6 for p in moved))

    def test_something_near_the_way_stops_it_until_it_is_gone(self):
        self.gazebo.spawn_sdf_model("post", support.static_box_sdf(), "",
                                    support.pose(x=3.0, z=0.5), "")
        with flow.tool("move_object.py", "-m", "polygon", "-n", "block", "-v", "3", "-d", "1",
                       "-p", "[[0,0],[4,0]]", "--laps", "1", "-o", "post") as program:
            def x():
                return self.gazebo.get_model_state("block", "").pose.position.x

            support.wait_for(lambda: x() > 1.9, "the block near the post")
            start = self.gazebo.sim_time()
            support.wait_for(lambda: self.gazebo.sim_time() > start + 0.5, "half a second")
            self.assertLessEqual(x(), 2.0 + 1e-6)
            self.gazebo.place("post", support.pose(y=20.0))
            self.assertEqual(program.ended(), 0, program.text)
        self.assert_at("block", 0.0, 0.0, 0.0, delta=1e-6)

    def test_interrupted_on_its_way_it_ends_well(self):
        with flow.tool("move_object.py", "-m", "circle", "-n", "block", "-r", "1",
                       "-c", "[0,0]") as program:
            support.wait_for(
                lambda: self.gazebo.get_model_state("block", "").pose.position.y > 0.9, "a start")
            program.interrupt()
            self.assertEqual(program.ended(), 0, program.text)

    def test_a_paused_world_ends_it_with_the_deadline_in_the_message(self):
        self.gazebo.pause_physics()
        text = self.run_tool("move_object.py", "-m", "circle", "-n", "block", "-r", "1",
                             "-c", "[0,0]", "--timeout", "3", status=1)
        self.assertIn("did not advance for 3 s", text)

    def test_an_unknown_model_is_named_with_the_closest_known_one(self):
        text = self.run_tool("move_object.py", "-m", "circle", "-n", "blok", "-r", "1",
                             "-c", "[0,0]", "--timeout", "3", status=1)
        self.assertIn("model 'blok' does not exist", text)
        self.assertIn("did you mean block?", text)
