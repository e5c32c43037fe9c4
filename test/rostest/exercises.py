#!/usr/bin/env python3
"""The exercises of the course do with the lab robot what they say."""
import math
import os
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from support import Gazebo, run, wait_for

ROBOT = "robo"


class Exercises(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()
        wait_for(lambda: ROBOT in cls.gazebo.names(), "the robot")

    def setUp(self):
        self.gazebo.reset_simulation()

    def exercise(self, name, *parameters):
        done = subprocess.run(["rosrun", "my_simulations", name, *parameters], timeout=300,
                              stdout=subprocess.PIPE, text=True, check=True)
        return done.stdout

    def pose(self, model=ROBOT):
        pose = self.gazebo.get_model_state(model, "").pose
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        return pose.position.x, pose.position.y, yaw

    def test_a_square_ends_where_it_began(self):
        said = self.exercise("drive_square.py", "_side:=0.5", "_speed:=0.4")
        self.assertIn("back at the start", said)
        x, y, yaw = self.pose()
        # On a busy machine the program reacts late; in lockstep the square is an assignment.
        self.assertLess(math.hypot(x, y), 0.25)
        self.assertAlmostEqual(math.remainder(yaw, 2.0 * math.pi), 0.0, delta=0.25)

    def test_it_follows_the_walls_around_a_corner(self):
        said = self.exercise("follow_wall.py", "_distance:=0.5", "_way:=4", "_speed:=0.4")
        self.assertIn("followed the wall for 4.0 m", said)
        x, y, _ = self.pose()
        self.assertLess(abs(min(2.5 - abs(x), 2.0 - abs(y)) - 0.5), 0.2)
        self.assertLess(x, 1.0)  # along the east wall, and the north wall then

    def test_it_pushes_the_box(self):
        before = self.pose("box")
        self.exercise("push_box.py", "_way:=0.4")
        after = self.pose("box")
        self.assertAlmostEqual(math.hypot(after[0] - before[0], after[1] - before[1]), 0.4,
                               delta=0.12)


if __name__ == "__main__":
    run("exercises")
