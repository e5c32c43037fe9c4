#!/usr/bin/env python3
"""pub_clock_frequency and model_states_rate are rates of sim time."""
import os
import statistics
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import support
from gazebo_msgs.msg import ModelStates
from rosgraph_msgs.msg import Clock


def runs(clock):
    """What has come on /clock, in nanoseconds, divided where time went back."""
    found = [[]]
    for message in clock.all():
        now = message.clock.to_nsec()
        if found[-1] and now < found[-1][-1]:
            found.append([])
        found[-1].append(now)
    return found


class ThrottledTopics(support.GazeboCase):
    def test_the_clock_ticks_at_its_frequency_also_after_a_reset(self):
        clock = support.Collected("/clock", Clock)
        for resets, prepare in enumerate((lambda: None, self.gazebo.reset_simulation)):
            prepare()
            support.wait_for(lambda resets=resets: len(runs(clock)) > resets
                             and len(runs(clock)[-1]) > 50, "50 ticks")
            heard = runs(clock)[-1]
            gaps = {b - a for a, b in zip(heard[2:], heard[3:])}
            self.assertEqual(gaps, {10000000})
        clock.close()

    def test_states_come_at_their_rate(self):
        # The speed of a falling body says which step a message shows; slowly, so that a message
        # that is a little late on a busy machine still shows the step that it is for.
        self.assertTrue(self.gazebo.spawn("one", where=support.pose(z=10000.0)).success)
        physics = self.gazebo.get_physics_properties()
        self.assertTrue(self.gazebo.set_physics_properties(
            physics.time_step, 200.0, physics.gravity, physics.ode_config).success)
        states = support.Collected("/gazebo/model_states", ModelStates)
        support.wait_for(lambda: len(states.all()) > 31, "states")
        states.close()
        gained = -physics.gravity.z * physics.time_step
        steps = [-message.twist[1].linear.z / gained for message in states.all()[1:]]
        gaps = [round(b - a) for a, b in zip(steps, steps[1:])]
        self.assertAlmostEqual(statistics.median(gaps), 20, delta=1, msg=gaps)


if __name__ == "__main__":
    support.run("throttled_topics")
