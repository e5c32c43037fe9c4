#!/usr/bin/env python3
"""pub_clock_frequency and model_states_rate are rates of sim time."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import support
from gazebo_msgs.msg import ModelStates
from rosgraph_msgs.msg import Clock


class ThrottledTopics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()

    def test_the_clock_ticks_at_its_frequency_also_after_a_reset(self):
        clock = support.Collected("/clock", Clock)
        for prepare in (lambda: None, self.gazebo.reset_simulation):
            prepare()
            clock.clear()
            support.wait_for(lambda: len(clock.all()) > 50, "50 ticks")
            heard = [message.clock.to_nsec() for message in clock.all()]
            gaps = {b - a for a, b in zip(heard[2:], heard[3:])}
            self.assertEqual(gaps, {10000000})
        clock.close()

    def test_states_come_at_their_rate(self):
        clock = support.Collected("/clock", Clock)
        states = support.Collected("/gazebo/model_states", ModelStates)
        support.wait_for(lambda: clock.all() and states.all(), "both topics")
        # On a busy machine the count may be read late; a wrong rate is wrong every time.
        spans = []
        while not any(abs(span - 1.0) < 0.1 for span in spans) and len(spans) < 5:
            states.clear()
            first = clock.all()[-1].clock.to_sec()
            support.wait_for(lambda: len(states.all()) >= 50, "50 states")
            spans.append(clock.all()[-1].clock.to_sec() - first)
        self.assertAlmostEqual(spans[-1], 1.0, delta=0.1)
        clock.close()
        states.close()


if __name__ == "__main__":
    support.run("throttled_topics")
