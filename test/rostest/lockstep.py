#!/usr/bin/env python3
"""In lockstep time goes on by request, and the topics follow."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import support
from gazebo_msgs.msg import ModelStates
from rosgraph_msgs.msg import Clock
from support import Collected, pose


class Lockstep(support.GazeboCase):
    def setUp(self):
        self.gazebo.clear()

    def test_time_stands_still_between_requests_whether_paused_or_not(self):
        for prepare in (self.gazebo.pause_physics, self.gazebo.unpause_physics):
            prepare()
            before = self.gazebo.sim_time()
            self.assertTrue(self.gazebo.spawn("a", where=pose(0.0, 0.0, 2.0)).success)
            self.assertTrue(self.gazebo.delete_model("a").success)
            self.assertEqual(self.gazebo.sim_time(), before)
            answer = self.gazebo.step_world(25)
            self.assertTrue(answer.success)
            self.assertAlmostEqual(self.gazebo.sim_time(), before + 0.025, delta=1e-9)
            self.assertAlmostEqual(answer.sim_time.to_sec(), before + 0.025, delta=1e-9)

    def test_two_runs_are_the_same_bit_for_bit(self):
        ends = []
        for _ in range(2):
            self.gazebo.reset_simulation()
            for name, z in (("a", 0.5), ("b", 0.75), ("c", 1.5)):
                self.assertTrue(self.gazebo.spawn(name, where=pose(0.01, 0.0, z, 0.3)).success)
            self.gazebo.step_world(1500)
            ends.append([support.numbers(self.gazebo.get_model_state(name, "").pose)
                         for name in "abc"])
            self.gazebo.clear()
        self.assertEqual(ends[0], ends[1])

    def test_the_clock_and_the_states_end_where_the_steps_end(self):
        clock, states = Collected("/clock", Clock), Collected("/gazebo/model_states", ModelStates)
        self.assertTrue(self.gazebo.spawn("a", where=pose(0.0, 0.0, 2.0)).success)
        # The clock of a step that is made before the publisher knows the subscriber is lost.
        support.wait_for(lambda: self.gazebo.step_world(1).success and clock.all(), "the clock")
        support.wait_for(states.all, "the states")
        answer = self.gazebo.step_world(300)
        support.wait_for(lambda: clock.all() and clock.all()[-1].clock == answer.sim_time,
                         "the clock of the last step")
        where = self.gazebo.get_model_state("a", "").pose
        support.wait_for(lambda: states.all()[-1].pose[1] == where, "the last state")
        clock.close()
        states.close()

    def test_no_steps_is_an_answer_and_fewer_are_refused(self):
        before = self.gazebo.sim_time()
        self.assertTrue(self.gazebo.step_world(0).success)
        for steps in (-1, 10 ** 15):
            answer = self.gazebo.step_world(steps)
            self.assertFalse(answer.success)
            self.assertIn("StepWorld: steps must be", answer.status_message)
        self.assertEqual(self.gazebo.sim_time(), before)

    def test_reset_time_sets_the_clock_back_and_nothing_else(self):
        self.assertTrue(self.gazebo.spawn("a", where=pose(0.0, 0.0, 3.0)).success)
        self.gazebo.step_world(100)
        before = self.gazebo.get_model_state("a", "")
        self.gazebo.reset_time()
        self.assertEqual(self.gazebo.sim_time(), 0.0)
        after = self.gazebo.get_model_state("a", "")
        self.assertEqual((after.pose, after.twist), (before.pose, before.twist))

    def test_it_says_it_is_not_paused_when_it_was_unpaused(self):
        self.gazebo.unpause_physics()
        self.assertFalse(self.gazebo.is_paused())
        self.gazebo.pause_physics()
        self.assertTrue(self.gazebo.is_paused())


if __name__ == "__main__":
    support.run("lockstep")
